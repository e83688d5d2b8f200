#ifndef PHILOX_H
#define PHILOX_H
/* Random numbers by counting: Philox4x32-10 of Salmon, Moraes, Dror and Shaw, "Parallel random numbers: as easy as 1,
   2, 3", SC 2011. Four words are a function of a counter of four words and a key of two; there is no state to keep, and
   whoever knows the counter makes the same words again, on any processor. C and C++, on the host and on the GPU. */

#include <stdint.h>
#if defined __CUDACC__
#define PHILOX_INLINE static __host__ __device__ __forceinline__
#else
#define PHILOX_INLINE static inline
#endif

struct philox {
	uint32_t word[4];
};

PHILOX_INLINE struct philox philox4x32_10(struct philox counter, uint64_t key)
{
	uint32_t key0 = (uint32_t)key, key1 = (uint32_t)(key >> 32);

	for (int round = 0; round < 10; round++) {
		const uint64_t a = (uint64_t)0xD2511F53 * counter.word[0], b = (uint64_t)0xCD9E8D57 * counter.word[2];

		counter.word[0] = (uint32_t)(b >> 32) ^ counter.word[1] ^ key0;
		counter.word[1] = (uint32_t)b;
		counter.word[2] = (uint32_t)(a >> 32) ^ counter.word[3] ^ key1;
		counter.word[3] = (uint32_t)a;
		key0 += 0x9E3779B9;
		key1 += 0xBB67AE85;
	}
	return counter;
}

/* Nearly Gaussian, mean 0, variance 4 (256^2 - 1) / 12: the sum of a word's four bytes, less its mean (Irwin 1927, Hall
   1927). It is a whole number from -510 to 510, so every processor has the same; 3.45 deviations are the most. */
#define PHILOX_DEVIATION 147.80054
PHILOX_INLINE int philox_bell(uint32_t word)
{
#if defined __CUDA_ARCH__
	return (int)__dp4a(word, 0x01010101u, 0u) - 510;
#else
	const uint32_t pairs = (word & 0xFF00FF) + (word >> 8 & 0xFF00FF);

	return (int)((pairs & 0xFFFF) + (pairs >> 16)) - 510;
#endif
}

#endif
