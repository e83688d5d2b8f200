#include "steps/outward.h"

struct span span_mul(struct span a, struct span b)
{
	double least = (double)INFINITY, most = -(double)INFINITY;
	const double of_a[] = {a.lo, a.hi}, of_b[] = {b.lo, b.hi};

	if (span_is_zero(a) || span_is_zero(b))
		return span_point(0);
	for (int i = 0; i < 4; i++) {
		double product = of_a[i / 2] * of_b[i % 2];

		if (!isfinite(product))
			return (struct span){-(double)INFINITY, (double)INFINITY};
		least = product < least ? product : least;
		most = product > most ? product : most;
	}
	return (struct span){out_down(least), out_up(most)};
}

/* The C library's sine in extended precision is good to far less than this. */
#define WAVE_OFF 0x1p-50

/* sin(x + shift pi/2): its ends, and each quarter turn that may lie between them, where it is 0, 1, 0 and -1 in turn. */
static struct span wave(struct span a, int shift)
{
	static const real QUARTER = 1.570796326794896619231321691640L, MARGIN = 1e-9L;
	static const double AT[4] = {0, 1, 0, -1};
	struct span r = {1, -1};
	real first, last;

	if (!(a.lo <= a.hi) || !(fabs(a.lo) <= 1e6) || !(fabs(a.hi) <= 1e6))
		return (struct span){-1, 1};
	first = ceill((real)a.lo / QUARTER - MARGIN);
	last = floorl((real)a.hi / QUARTER + MARGIN);
	if (last - first >= 4)
		return (struct span){-1, 1};
	for (real k = first; k <= last; k++) {
		double at = AT[((int)k + shift) & 3];

		r.lo = fmin(r.lo, at);
		r.hi = fmax(r.hi, at);
	}
	for (int end = 0; end < 2; end++) {
		real x = (real)(end ? a.hi : a.lo);
		double at = (double)(shift ? cosl(x) : sinl(x));

		r.lo = fmin(r.lo, at - WAVE_OFF);
		r.hi = fmax(r.hi, at + WAVE_OFF);
	}
	return (struct span){fmax(r.lo, -1), fmin(r.hi, 1)};
}

struct span span_sin(struct span a)
{
	return wave(a, 0);
}

struct span span_cos(struct span a)
{
	return wave(a, 1);
}

struct span span_within(struct within c)
{
	double at = (double)c.x, off = within_error(c) + (double)fabsl(c.x - (real)at);

	if (off == 0)
		return span_point(at);
	off = out_up(out_up(off));
	return (struct span){out_down(at - off), out_up(at + off)};
}
