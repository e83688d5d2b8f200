#ifndef TESTS_PTXAS_H
#define TESTS_PTXAS_H
/* What ptxas -v says about the kernels of a text. */

struct kernel_use {
	char name[256];
	int registers, stack, spill_stores, spill_loads, shared; /* bytes, but for the registers */
};

/* Read up to `limit` kernels from the log; returns how many there were. A function that a kernel calls counts for the
   kernel's stack and spills. */
int ptxas_read(const char *log, struct kernel_use *kernels, int limit);

#endif
