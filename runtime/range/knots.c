/* A trigonometric polynomial of degree d is a sum of its values y_i at n = 2 d + 1 places x_i of a circle,
     f(x) = sum y_i (1 + 2 sum_{h <= d} cos h (x - x_i)) / n,
   a parabola one of its values at three places (Lagrange). Both are done for each row of q in turn. */
#define _POSIX_C_SOURCE 200809L
#include "range/knots.h"
#include "core/seconds.h"
#include <math.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>

enum { MOST_NUMBERS = 1 << 26, POINTS = 32, LENGTH_KNOTS = 3 };

/* ---- weights ---- */

/* cos h x for h = 0, 1, ... by cos(h + 1) x = 2 cos x cos h x - cos(h - 1) x */
static real kernel(real cosine, int degree, int is_second)
{
	real before = 1, now = cosine, sum = is_second ? 0 : 1;

	for (int h = 1; h <= degree; h++) {
		real next = 2 * cosine * now - before;

		sum += 2 * now * (is_second ? -(real)(h * h) : 1);
		before = now;
		now = next;
	}
	return sum;
}

static void weigh_angle(int n, const double x[2], int is_second, double *by)
{
	for (int i = 0; i < n; i++) {
		real at = grid_angle(i, n);

		by[i] = (double)(kernel((real)x[1] * cosl(at) + (real)x[0] * sinl(at), (n - 1) / 2, is_second) / (real)n);
	}
}

static void weigh_length(const struct field_dim *dim, double x, int is_second, double *by)
{
	double half = 0.5 * (dim->upper - dim->lower), t = (x - 0.5 * (dim->lower + dim->upper)) / half;

	by[0] = is_second ? 1 / (half * half) : 0.5 * t * (t - 1);
	by[1] = is_second ? -2 / (half * half) : 1 - t * t;
	by[2] = is_second ? 1 / (half * half) : 0.5 * t * (t + 1);
}

double knots_weigh(const struct knots *k, int dim, const double x[2], int is_second, double *by)
{
	double sum = 0;

	if (field_is_point(&k->f->dims[dim]))
		by[0] = !is_second;
	else if (k->f->dims[dim].is_angle)
		weigh_angle(k->counts[dim], x, is_second, by);
	else
		weigh_length(&k->f->dims[dim], x[0], is_second, by);
	for (int i = 0; i < k->counts[dim]; i++)
		sum += fabs(by[i]);
	return sum;
}

/* A weight is off by less than 2^-40 of their sum, or of 1: a cosine's harmonic by h^2 2^-52, a length's as is_short
   allows. So each row multiplies what is off by its spread, and adds less than 2^-35 of the largest; there are at most 12 rows.
   */
double knots_off(const struct knots *k, int output, const double *spread)
{
	double all = 1;

	for (int l = 0; l < k->f->dim_count; l++)
		all *= fmax(1, spread[l]);
	return all * (k->f->noise[output] + 0x1p-31 * (k->size[output] + k->f->noise[output])) * (1 + 0x1p-40);
}

/* ---- values ---- */

struct sampling {
	struct knots *k;
	size_t done; /* pieces */
	double deadline;
	atomic_int failed;
};

static double *value_at(const struct knots *k, int output, size_t point)
{
	return k->values + ((size_t)output * k->points + point) * k->stride;
}

static void take_points(void *job, size_t piece)
{
	struct sampling *s = job;
	const struct field *f = s->k->f;
	size_t n = f->coefficient_count;
	double *work = s->failed ? NULL : field_work(f), *c = malloc((size_t)f->output_count * n * sizeof *c);
	struct field_point q;

	piece += s->done;
	if (!work || !c)
		s->failed = 1;
	for (size_t i = piece * POINTS; i < (piece + 1) * POINTS && i < s->k->points && !s->failed; i++) {
		grid_point(&s->k->grid, i, &q);
		field_evaluate(f, &q, work, c);
		for (int o = 0; o < f->output_count; o++) {
			memcpy(value_at(s->k, o, i), c + (size_t)o * n, n * sizeof *c);
			memset(value_at(s->k, o, i) + n, 0, (s->k->stride - n) * sizeof *c);
		}
		if (seconds_now() > s->deadline)
			s->failed = 1;
	}
	free(c);
	free(work);
}

static double largest(const struct knots *k, int output)
{
	const double *v = value_at(k, output, 0);
	double most = 0;

	for (size_t i = 0; i < k->points * k->stride; i++)
		most = fabs(v[i]) <= most ? most : fabs(v[i]);
	return most;
}

/* 1 or 0 as knots_make; the first piece tells how long all will take. */
static int sample(struct knots *k, const struct effort *x, double seconds)
{
	double start = seconds_now();
	struct sampling s = {.k = k, .deadline = fmin(x->deadline, start + seconds)};
	size_t pieces = (k->points + POINTS - 1) / POINTS;

	take_points(&s, 0);
	if (!s.failed && (seconds_now() - start) * (double)pieces / x->threads > seconds)
		return 0;
	s.done = 1;
	if (!s.failed)
		workers_run(x->workers, x->threads, take_points, &s, pieces - 1);
	for (int o = 0; o < k->f->output_count && !s.failed; o++)
		k->size[o] = largest(k, o);
	return !s.failed;
}

/* A length that is short against its distance from 0 has places that are known less well. */
static int is_short(const struct field_dim *dim)
{
	double farthest = fmax(fabs(dim->lower), fabs(dim->upper));

	return !dim->is_angle && !field_is_point(dim) && dim->upper - dim->lower < 0x1p-8 * farthest;
}

static int count_of(const struct field_dim *dim)
{
	return dim->is_angle ? 2 * dim->degree + 1 : field_is_point(dim) ? 1 : LENGTH_KNOTS;
}

int knots_make(struct knots *k, const struct field *f, const struct effort *x, double seconds)
{
	double points = 1, numbers;

	*k = (struct knots){.f = f};
	k->stride = (f->coefficient_count + FIELD_VECTOR - 1) / FIELD_VECTOR * FIELD_VECTOR;
	for (int l = 0; l < f->dim_count; l++) {
		points *= k->counts[l] = count_of(&f->dims[l]);
		if (is_short(&f->dims[l]))
			return 0;
	}
	numbers = points * (double)k->stride * f->output_count;
	if (!f->has_grid || !f->dim_count || numbers > MOST_NUMBERS)
		return 0;
	k->points = (size_t)points;
	k->values = aligned_alloc(FIELD_VECTOR * sizeof(double), (size_t)numbers * sizeof(double));
	k->size = malloc((size_t)f->output_count * sizeof *k->size);
	if (!k->values || !k->size || !grid_make(&k->grid, f, k->counts, 1))
		return 0;
	return sample(k, x, seconds);
}

void knots_free(struct knots *k)
{
	grid_free(&k->grid);
	free(k->values);
	free(k->size);
	*k = (struct knots){.f = NULL};
}
