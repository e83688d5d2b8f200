/* A product has waves of the degrees of both factors together, of which the highest may cancel: moments at the base are
   of degree 2 in each angle, and their expressions of 3. By its values at n = 2 d + 1 knots of a row f is p + r, r = a
   cos d x + b sin d x. Where |a| + |b| is at most m at the knots of all other rows, it is at most m times the sums of
   their weights' magnitudes at any q. Those of an angle with n knots are at most the root of n: the squares of its
   weights add up to 1 (Parseval). So p serves in the place of f, and r is noise. */
#define _POSIX_C_SOURCE 200809L
#include "range/knots.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Of the largest coefficient: what r may be. */
#define SLIGHT 0x1p-24
enum { MOST_OUTPUTS = 64 };
#define OF_LENGTH 1.25 /* three knots' weights have no larger sum */

/* Values of one row's knots are `step` apart; `lines` of them begin one after the other, in `blocks`. */
struct lowering {
	struct knots *k;
	int dim, n;
	size_t step, blocks;
};

static struct lowering lowering_of(struct knots *k, int dim)
{
	struct lowering l = {k, dim, k->counts[dim], k->stride, 1};

	for (int i = 0; i < k->f->dim_count; i++)
		*(i < dim ? &l.step : &l.blocks) *= i == dim ? 1 : (size_t)k->counts[i];
	return l;
}

/* The largest |a| + |b| of an output's coefficients, or more than `floor`. */
static double wave_of(const struct lowering *l, int output, double floor)
{
	const double *from = l->k->values + (size_t)output * l->k->points * l->k->stride;
	double by[2][2 * FIELD_DEGREE + 1], most = 0;

	for (int i = 0; i < l->n; i++) {
		real at = grid_angle(i, l->n) * (real)(l->n / 2);

		by[0][i] = (double)(2 * cosl(at) / (real)l->n);
		by[1][i] = (double)(2 * sinl(at) / (real)l->n);
	}
	for (size_t b = 0; b < l->blocks && most <= floor; b++, from += (size_t)l->n * l->step)
		for (size_t at = 0; at < l->step; at++) {
			double sums[2] = {0};

			for (int i = 0; i < l->n; i++) {
				sums[0] += by[0][i] * from[(size_t)i * l->step + at];
				sums[1] += by[1][i] * from[(size_t)i * l->step + at];
			}
			most = fmax(most, fabs(sums[0]) + fabs(sums[1]));
		}
	return most;
}

/* Coefficients at knots are so far off, as is a sum over a row by 2^-45 of its largest (knots_off). */
static double off_of(const struct lowering *l, int output)
{
	return l->k->f->noise[output] + 0x1p-45 * l->k->size[output];
}

/* r is nowhere larger. */
static double rest_of(const struct lowering *l, int output, double wave)
{
	const struct field *f = l->k->f;
	double factor = 1;

	for (int i = 0; i < f->dim_count; i++)
		if (i != l->dim && !field_is_point(&f->dims[i]))
			factor *= f->dims[i].is_angle ? sqrt((double)l->k->counts[i]) : OF_LENGTH;
	return factor * (wave + 4 * off_of(l, output)) * (1 + 0x1p-40);
}

/* p at the knots of one degree less. */
static void project(const struct lowering *l, double *to)
{
	int less = l->n - 2;
	double by[2 * FIELD_DEGREE + 1];
	size_t blocks = l->blocks * (size_t)l->k->f->output_count;

	for (int j = 0; j < less; j++) {
		for (int i = 0; i < l->n; i++) {
			real sum = 1;

			for (int h = 1; h <= less / 2; h++)
				sum += 2 * cosl((real)h * (grid_angle(j, less) - grid_angle(i, l->n)));
			by[i] = (double)(sum / (real)l->n);
		}
		for (size_t b = 0; b < blocks; b++) {
			const double *from = l->k->values + b * (size_t)l->n * l->step;
			double *out = to + (b * (size_t)less + (size_t)j) * l->step;

			for (size_t at = 0; at < l->step; at++) {
				out[at] = 0;
				for (int i = 0; i < l->n; i++)
					out[at] += by[i] * from[(size_t)i * l->step + at];
			}
		}
	}
}

/* The noise of p at its knots, and what it takes from their sizes. */
static void take(const struct lowering *l, struct field *f, double *values, size_t points)
{
	struct knots *k = l->k;
	double root = sqrt((double)l->n);

	for (int o = 0; o < f->output_count; o++) {
		f->noise[o] = root * off_of(l, o) * (1 + 0x1p-40);
		k->size[o] *= root;
	}
	free(k->values);
	k->values = values;
	k->points = points;
	k->counts[l->dim] -= 2;
	f->dims[l->dim].degree--;
}

/* rest[] is how much all that has been left out is. Returns 1; 0 where r is too large; -1 when memory runs out. */
static int lower(struct knots *k, struct field *f, int dim, double *rest)
{
	struct lowering l = lowering_of(k, dim);
	size_t points = k->points / (size_t)l.n * (size_t)(l.n - 2);
	double *values, own[MOST_OUTPUTS];

	for (int o = 0; o < f->output_count; o++) {
		double most = SLIGHT * k->size[o];

		own[o] = rest[o] + rest_of(&l, o, wave_of(&l, o, most));
		if (!(own[o] <= most))
			return 0;
	}
	values = aligned_alloc(
		FIELD_VECTOR * sizeof(double), points * k->stride * (size_t)f->output_count * sizeof *values);
	if (!values)
		return -1;
	project(&l, values);
	take(&l, f, values, points);
	memcpy(rest, own, (size_t)f->output_count * sizeof *rest);
	return 1;
}

/* Thrice what is left out: where places are evaluated instead of knots, it is in their values, between them, and in
 * what is bounded. */
int knots_lower(struct knots *k, struct field *f)
{
	double rest[MOST_OUTPUTS] = {0};
	int now = 1;

	for (int dim = 0; dim < f->dim_count && now >= 0 && f->output_count <= MOST_OUTPUTS; dim++)
		for (now = 1; now == 1 && f->dims[dim].is_angle && k->counts[dim] > 3;)
			now = lower(k, f, dim, rest);
	for (int o = 0; o < f->output_count && o < MOST_OUTPUTS; o++)
		f->noise[o] += 3 * rest[o];
	grid_free(&k->grid);
	return now >= 0 && grid_make(&k->grid, f, k->counts, 1);
}
