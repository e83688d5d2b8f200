#ifndef TESTS_RNG_H
#define TESTS_RNG_H

#include <stdbool.h>
#include <stdint.h>

// xoshiro256** 1.0 (Blackman, Vigna 2018), seeded by splitmix64: the same numbers on every machine.
struct rng {
	uint64_t s[4];
};

static inline uint64_t rng_split(uint64_t *x)
{
	uint64_t z = *x += 0x9e3779b97f4a7c15u;

	z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
	z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
	return z ^ (z >> 31);
}

static inline struct rng rng_seed(uint64_t seed)
{
	struct rng r;

	for (int i = 0; i < 4; i++)
		r.s[i] = rng_split(&seed);
	return r;
}

static inline uint64_t rng_rotate(uint64_t x, int k)
{
	return x << k | x >> (64 - k);
}

// 64 random bits.
static inline uint64_t rng_next(struct rng *r)
{
	uint64_t *s = r->s, result = rng_rotate(s[1] * 5, 7) * 9, t = s[1] << 17;

	s[2] ^= s[0];
	s[3] ^= s[1];
	s[1] ^= s[2];
	s[0] ^= s[3];
	s[2] ^= t;
	s[3] = rng_rotate(s[3], 45);
	return result;
}

// Uniform in [low, high).
static inline double rng_uniform(struct rng *r, double low, double high)
{
	return low + (high - low) * ((double)(rng_next(r) >> 11) * 0x1p-53);
}

// Uniform in 0 .. n-1, n > 0 (the bias of the remainder is below n/2^64).
static inline int rng_below(struct rng *r, int n)
{
	return (int)(rng_next(r) % (uint64_t)n);
}

// True with probability p.
static inline bool rng_chance(struct rng *r, double p)
{
	return rng_uniform(r, 0, 1) < p;
}

#endif
