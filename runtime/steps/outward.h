#ifndef RUNTIME_STEPS_OUTWARD_H
#define RUNTIME_STEPS_OUTWARD_H
/* Spans of doubles, rounded outwards: the arithmetic of whoever checks a certificate. It shares no code with that of proofs. */

#include "base/within.h"
#include <float.h>
#include <math.h>

struct span {
	double lo, hi;
};

/* Above pi: half of every angle there is. */
#define OUT_PI 0x1.921fb54442d19p+1

/* Rounding to nearest is off by at most half of 2^-52 of a result, or of the smallest normal number. */
static inline double out_step(double x)
{
	return fabs(x) * DBL_EPSILON + DBL_MIN;
}

static inline double out_up(double x)
{
	return x + out_step(x);
}

static inline double out_down(double x)
{
	return x - out_step(x);
}

static inline struct span span_point(double x)
{
	return (struct span){x, x};
}

static inline int span_is_zero(struct span a)
{
	return a.lo == 0 && a.hi == 0;
}

static inline struct span span_neg(struct span a)
{
	return (struct span){-a.hi, -a.lo};
}

static inline struct span span_signed(struct span a, int is_minus)
{
	return is_minus ? span_neg(a) : a;
}

/* What is zero adds nothing, not even a rounding. */
static inline struct span span_add(struct span a, struct span b)
{
	if (span_is_zero(a) || span_is_zero(b))
		return span_is_zero(a) ? b : a;
	return (struct span){out_down(a.lo + b.lo), out_up(a.hi + b.hi)};
}

/* All numbers, where a bound is not finite or not a number. */
struct span span_mul(struct span a, struct span b);

static inline double span_size(struct span a)
{
	double size = -a.lo > a.hi ? -a.lo : a.hi;

	return size >= 0 ? size : (double)INFINITY; /* NaN */
}

/* Is a stated upper bound no less than the one that follows, and hardly more? Who writes it down adds far less. */
static inline int states(double stated, double follows)
{
	return stated >= follows && (stated <= follows + 0x1p-20 * fabs(follows) + DBL_MIN || follows == (double)INFINITY);
}

/* Of all angles in a span. */
struct span span_sin(struct span a);
struct span span_cos(struct span a);

/* A constant of the DAG: the number itself, or what its decimals may mean. */
struct span span_within(struct within c);

#endif
