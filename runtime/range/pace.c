/* g = d2f/dq_k^2 is a polynomial of the kind that f is. From its largest magnitude G on a grid that of all q follows in two ways,
   one for each dimension l:
   - M. Riesz (Eine trigonometrische Interpolationsformel, 1914): where |g| is largest, at q*, it is at least cos(d (q - q*))
     times that at q, d the degree. A place of n on a circle is within pi/n of q*: the largest is at most 1/cos(pi d/n) times that
     of places.
   - Interpolation along lines: g is at most h^2/2 |d2g/dq_l^2| above the larger neighbour, h half the distance of places. By
     Bernstein, |d2g/dq_l^2| <= d^2 |g|, and as well <= d^2 |d2f/dq_l^2|, which is small where q_l matters little. */
#include "range/curvature.h"
#include <math.h>

int pace_least(const struct field_dim *k)
{
	return 2 * k->degree + 2 > LEAST_PLACES ? 2 * k->degree + 2 : LEAST_PLACES;
}

struct pace pace_of(const struct field *f, int k, int count)
{
	const struct field_dim *dim = &f->dims[k];
	double d = dim->degree, half = 0.5 * (dim->upper - dim->lower), step;

	if (field_is_point(dim))
		return (struct pace){1, 0, 0};
	if (!dim->is_angle && count < LENGTH_PLACES)
		return (struct pace){(double)INFINITY, half * half / 2 * (1 + 0x1p-40), 4 / (half * half) * (1 + 0x1p-40)};
	if (!dim->is_angle) /* parabolas: Lebesgue's constant of three places, and Markov */
		return (struct pace){1.25 * (1 + 0x1p-40), half * half / 8 * (1 + 0x1p-40), 4 / (half * half) * (1 + 0x1p-40)};
	step = 3.14159265358979323847 / count;
	return (struct pace){count > 2 * d ? (1 + 0x1p-40) / cos(d * step) : (double)INFINITY, step * step / 2 * (1 + 0x1p-40), d * d};
}

/* What a set of dimensions for the first way gives for dimension k, the others being for the second. */
static double bound_by(const struct pace *p, int n, int k, double found, const double *most, const unsigned char *is_first)
{
	double factor = 1, sum = found;

	for (int l = 0; l < n; l++)
		if (is_first[l])
			factor *= p[l].factor;
		else
			sum += p[l].gap * fmin(p[l].bend * most[k], p[k].bend * most[l]);
	return factor * sum * (1 + 0x1p-40);
}

/* The best that is found by changing one dimension at a time. */
double pace_best(const struct pace *p, int n, int k, double found, const double *most)
{
	unsigned char is_first[FIELD_DIMS] = {0};
	double best;

	for (int l = 0; l < n; l++)
		is_first[l] = isfinite(p[l].factor) && !(p[l].gap * p[k].bend * most[l] < 0.1 * found);
	best = bound_by(p, n, k, found, most, is_first);
	for (int l = 0; l < n; l++) {
		double now;

		is_first[l] = !is_first[l];
		now = bound_by(p, n, k, found, most, is_first);
		if (now < best)
			best = now;
		else
			is_first[l] = !is_first[l];
	}
	return fmin(best, most[k]);
}

/* Along a dimension of which second derivatives are taken. */
int pace_own_count(const struct field *f, int k, const int *counts)
{
	if (!f->dims[k].is_angle)
		return LENGTH_PLACES;
	return counts[k] < pace_least(&f->dims[k]) ? pace_least(&f->dims[k]) : counts[k];
}
