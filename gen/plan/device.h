#ifndef RNEAGEN_DEVICE_H
#define RNEAGEN_DEVICE_H
/* The device that kernels are planned for (CUDA C++ Programming Guide, Technical Specifications per Compute Capability). */

/* Of all from compute capability 8.0 on: threads of a warp, the smallest block, and of a block at most; bytes of shared memory
   that a block has without asking, and that it may ask for; registers of a multiprocessor; the bytes that memory moves at
   once. */
enum { WARP_THREADS = 32, BLOCK_THREADS = 1024, SHARED_BYTES = 48 << 10, ASKED_BYTES = 99 << 10, REGISTERS = 65536,
	SECTOR_BYTES = 32 };

/* Of an H100 and an H200: multiprocessors; of each, threads, and bytes of shared memory for its blocks. */
enum { MULTIPROCESSORS = 132, MULTIPROCESSOR_THREADS = 2048, MULTIPROCESSOR_BYTES = 227 << 10 };

#endif
