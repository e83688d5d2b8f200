#ifndef PROVE_SPANS_H
#define PROVE_SPANS_H
/* Drawn ranges of numbers, numbers in them, and whether MPFR's number is in one: for intervals, and for the spans
   of who checks. */

#include "steps/outward.h"
#include "support/rng.h"
#include <math.h>
#include <mpfr.h>

static inline double spans_magnitude(struct rng *r)
{
	return (rng_chance(r, 0.1) ? 0 : 1) * rng_uniform(r, -1, 1) * exp2(rng_uniform(r, -40, 40));
}

/* Between two numbers that `one` draws: now and then one number, or two that are hardly apart. */
static inline struct span spans_draw(struct rng *r, double (*one)(struct rng *r))
{
	double a = one(r), b = rng_chance(r, 0.2) ? a : rng_chance(r, 0.5) ? a * (1 + rng_uniform(r, 0, 1e-14)) : one(r);

	return (struct span){fmin(a, b), fmax(a, b)};
}

/* Its ends, and what lies between. */
static inline double spans_inside(struct rng *r, struct span a)
{
	double t = rng_chance(r, 0.5) ? rng_below(r, 2) : rng_uniform(r, 0, 1);

	return t == 0 ? a.lo : t == 1 ? a.hi : fmin(a.hi, fmax(a.lo, a.lo + t * (a.hi - a.lo)));
}

static inline int spans_contain(struct span a, mpfr_t x)
{
	return mpfr_cmp_d(x, a.lo) >= 0 && mpfr_cmp_d(x, a.hi) <= 0;
}

#endif
