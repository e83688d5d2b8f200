#define _POSIX_C_SOURCE 200809L
#define _XOPEN_SOURCE 700
#include "range/seek.h"
#include "core/seconds.h"
#include "range/extreme.h"
#include <math.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>

enum { ROUNDS = 12, FIRST_ROUNDS = 3, STARTS = 4, TRIES = 96 };

struct seeking {
	const struct field *f;
	const struct effort *effort;
	struct sought (*best)[2]; /* [piece][output] */
	int failed;
	double deadline;
	unsigned long long seed;
};

/* What one thread works in. */
struct room {
	double *work, *coefficients, *scalars, *values;
};

static int room_make(struct room *r, const struct field *f)
{
	*r = (struct room){field_work(f), malloc((size_t)f->output_count * f->coefficient_count * sizeof(double)), field_scalars(f),
		malloc((size_t)f->output_count * sizeof(double))};
	return r->work && r->coefficients && r->scalars && r->values;
}

static void room_free(struct room *r)
{
	free(r->work);
	free(r->coefficients);
	free(r->scalars);
	free(r->values);
}

static void point_of(const struct field *f, const double *q, struct field_point *p)
{
	for (int k = 0; k < f->dim_count; k++)
		field_place(&f->dims[k], q[k], p->x[k]);
}

static double value_at(const struct field *f, int o, const struct sought *s, struct room *r)
{
	struct field_point p;

	point_of(f, s->q, &p);
	field_values(f, &p, s->x, r->scalars, r->values);
	return r->values[o];
}

/* From five values of an angle, a turn apart in all: a0 + a1 cos + b1 sin + a2 cos 2 + b2 sin 2. From three of a length: a
   parabola. */
static void fit(const struct field *f, int k, const double *y, double *a)
{
	memset(a, 0, 5 * sizeof *a);
	for (int i = 0; i < 5 && f->dims[k].is_angle; i++)
		for (int h = 0; h < 5; h++) {
			double angle = 2 * 3.14159265358979323846 * i / 5 * ((h + 1) / 2);

			a[h] += y[i] * (h == 0 ? 0.2 : h % 2 ? 0.4 * cos(angle) : 0.4 * sin(angle));
		}
	if (f->dims[k].is_angle)
		return;
	a[0] = y[1];
	a[1] = 0.5 * (y[2] - y[0]);
	a[2] = 0.5 * (y[2] + y[0]) - y[1];
}

static double fitted(const struct field *f, int k, const double *a, double q)
{
	double half = 0.5 * (f->dims[k].upper - f->dims[k].lower), t = (q - f->dims[k].lower - half) / half;

	if (!f->dims[k].is_angle)
		return a[0] + (a[1] + a[2] * t) * t;
	return a[0] + a[1] * cos(q) + a[2] * sin(q) + a[3] * cos(2 * q) + a[4] * sin(2 * q);
}

static double place_of(const struct field_dim *k, int i)
{
	return k->is_angle ? 2 * 3.14159265358979323846 * i / 5 : k->lower + 0.5 * (k->upper - k->lower) * i;
}

/* The best q_k of its range, all else as it is: a fine comb, then thirds. */
static double climb(const struct field *f, int k, const double *a, int sign)
{
	const struct field_dim *dim = &f->dims[k];
	double step = (dim->upper - dim->lower) / TRIES, best = dim->lower, low, high;

	for (int i = 1; i <= TRIES; i++)
		if (sign * fitted(f, k, a, dim->lower + i * step) > sign * fitted(f, k, a, best))
			best = dim->lower + i * step;
	low = fmax(dim->lower, best - step);
	high = fmin(dim->upper, best + step);
	for (int i = 0; i < 40; i++) {
		double p = low + (high - low) / 3, q = high - (high - low) / 3;

		if (sign * fitted(f, k, a, p) > sign * fitted(f, k, a, q))
			high = q;
		else
			low = p;
	}
	return fmin(dim->upper, fmax(dim->lower, 0.5 * (low + high)));
}

/* The best q_k, where the output is a polynomial of the degree that it has in most robots; else a guess. */
static void climb_along(const struct field *f, int o, int k, int sign, struct sought *s, struct room *r)
{
	double y[5], a[5];

	for (int i = 0; i < (f->dims[k].is_angle ? 5 : 3); i++) {
		s->q[k] = place_of(&f->dims[k], i);
		y[i] = value_at(f, o, s, r);
	}
	fit(f, k, y, a);
	s->q[k] = climb(f, k, a, sign);
}

/* The best drives and rates of these q, then one q after the other. */
static void go_round(const struct field *f, int o, int sign, struct sought *s, struct room *r)
{
	struct field_point p;

	point_of(f, s->q, &p);
	field_evaluate(f, &p, r->work, r->coefficients);
	extreme_corner(f, r->coefficients + (size_t)o * f->coefficient_count, sign, s->x);
	for (int k = 0; k < f->dim_count; k++)
		if (f->dims[k].lower != f->dims[k].upper)
			climb_along(f, o, k, sign, s, r);
	s->value = value_at(f, o, s, r);
}

static void ascend(const struct seeking *k, int o, int sign, int rounds, struct sought *s, struct room *r)
{
	s->value = value_at(k->f, o, s, r);
	for (int round = 0; round < rounds && seconds_now() < k->deadline; round++) {
		struct sought next = *s;

		go_round(k->f, o, sign, &next, r);
		if (sign * next.value <= sign * s->value + 1e-9 * fabs(s->value))
			return;
		*s = next;
	}
}

/* A state anywhere, or every third time at a corner of q. */
static void start(const struct field *f, unsigned short seed[3], struct sought *s)
{
	int is_corner = erand48(seed) < 0.34;

	for (int k = 0; k < f->dim_count; k++) {
		double t = erand48(seed);

		t = is_corner ? t > 0.5 : t;
		s->q[k] = fmin(f->dims[k].upper, f->dims[k].lower + t * (f->dims[k].upper - f->dims[k].lower));
	}
	for (int i = 0; i < f->drive_count; i++)
		s->x[i] = f->drives[i].ball ? 0 : f->drives[i].range.lower;
	for (int j = 0; j < f->rate_count; j++)
		s->x[f->drive_count + j] = f->rates[j].range.lower;
}

static void seek(void *job, size_t piece)
{
	struct seeking *s = job;
	const struct field *f = s->f;
	unsigned short seed[3] = {(unsigned short)piece, (unsigned short)(piece >> 16), (unsigned short)s->seed};
	struct room r;
	struct sought (*best)[2] = s->best + piece * (size_t)f->output_count;
	int done = room_make(&r, f);

	s->failed |= !done;
	for (int i = 0; i < STARTS && done; i++)
		for (int o = 0; o < f->output_count; o++)
			for (int side = 0; side < 2; side++) {
				int sign = side ? 1 : -1;
				struct sought now = {0};

				start(f, seed, &now);
				ascend(s, o, sign, i == 0 && s->seed == 0 ? FIRST_ROUNDS : ROUNDS, &now, &r);
				if ((i == 0 && s->seed == 0) || sign * now.value > sign * best[o][side].value)
					best[o][side] = now;
			}
	room_free(&r);
}

int seek_extremes(struct sought (*best)[2], const struct field *f, const struct effort *x, double seconds)
{
	size_t pieces = x->threads, outputs = (size_t)f->output_count;
	struct seeking s = {.f = f, .effort = x, .deadline = fmin(x->deadline, seconds_now() + seconds)};

	s.best = calloc(pieces * outputs, sizeof *s.best);
	if (!s.best)
		return 0;
	for (; s.seed == 0 || (seconds_now() < s.deadline && s.seed < 200); s.seed++)
		workers_run(x->workers, x->threads, seek, &s, pieces);
	memcpy(best, s.best, outputs * sizeof *best);
	for (size_t i = 1; i < pieces; i++)
		for (size_t o = 0; o < outputs; o++)
			for (int side = 0; side < 2; side++)
				if ((side ? 1 : -1) * s.best[i * outputs + o][side].value > (side ? 1 : -1) * best[o][side].value)
					best[o][side] = s.best[i * outputs + o][side];
	free(s.best);
	return !s.failed;
}
