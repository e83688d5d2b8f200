/* erand48 */
#define _XOPEN_SOURCE 700
#include "draw.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { STATES = 3 }; /* q, qd, qdd */

static double around(unsigned short seed[3], double value, double by)
{
	return value + by * (2 * erand48(seed) - 1);
}

/* A box with half sides s and its centre at c: h = m c,  I = m/3 (s.s 1 - s s^T, diagonal) + m (c.c 1 - c c^T). */
static void draw_box(unsigned short seed[3], double *x)
{
	double m = 1 - erand48(seed), s[3], c[3];

	for (int i = 0; i < 3; i++) {
		s[i] = 0.1 * erand48(seed);
		c[i] = around(seed, 0, 0.1);
		x[1 + i] = m * c[i];
	}
	x[0] = m;
	for (int i = 0; i < 3; i++)
		for (int j = i; j < 3; j++) {
			int k = (i + 1) % 3, l = (i + 2) % 3;

			x[4 + inertia_index(i, j)] =
				i == j ? m / 3 * (s[k] * s[k] + s[l] * s[l]) + m * (c[k] * c[k] + c[l] * c[l]) : -m * c[i] * c[j];
		}
}

static void draw_freed(unsigned short seed[3], const struct freed *f, double *x)
{
	double length = 0, factor, box[FREED_ROWS];

	for (int i = 0; i < f->rows; i++)
		length = hypot(length, (double)f->nominal[i]);
	switch (f->kind) {
	case FREED_GRAVITY:
	case FREED_OFFSET:
		for (int i = 0; i < f->rows; i++)
			x[i] = around(seed, (double)f->nominal[i], f->kind == FREED_GRAVITY ? 0.1 * length : 0.1);
		return;
	default:
		draw_box(seed, box);
		factor = around(seed, 1, 0.1);
		for (int i = 0; i < f->rows; i++)
			x[i] = f->nominal[0] > 0 ? factor * (double)f->nominal[i] : box[i];
	}
}

static double *add_array(struct drawn *x, const char *name, size_t rows, int per_batch)
{
	struct drawn_array *a = &x->arrays[x->count++];

	*a = (struct drawn_array){name, rows, per_batch, calloc(per_batch ? 1 : x->states.count, rows * sizeof *a->values)};
	return a->values;
}

static int draw_others(struct drawn *x, const struct task *k, unsigned short seed[3])
{
	for (int i = 0; i < k->freed_count; i++) {
		const struct freed *f = &k->freed[i];
		double *values = add_array(x, f->argument, (size_t)f->rows, f->per_batch);

		for (size_t s = 0; values && s < (f->per_batch ? 1 : x->states.count); s++)
			draw_freed(seed, f, values + s * (size_t)f->rows);
		if (!values)
			return 0;
	}
	for (int i = 0; i < k->push_count; i++) {
		double *values = add_array(x, k->pushes[i].argument, 6, 0);

		for (size_t s = 0; values && s < 6 * x->states.count; s++)
			values[s] = around(seed, 0, 10);
		if (!values)
			return 0;
	}
	return 1;
}

/* What is no constant of the URDF's, such as the vectors that derivatives are multiplied by. */
static int draw_rest(struct drawn *x, const struct dag *d, unsigned short seed[3])
{
	for (int i = 0; i < d->argument_count; i++) {
		const struct argument *a = &d->arguments[i];
		size_t count = (a->per_batch ? 1 : x->states.count) * (size_t)a->rows;
		double *values;

		if (a->is_output || draw_rows(x, a, 0))
			continue;
		if (x->count == DRAWN_ARRAYS || !(values = add_array(x, a->name, (size_t)a->rows, a->per_batch)))
			return 0;
		for (size_t k = 0; k < count; k++)
			values[k] = around(seed, 0, 1);
	}
	return 1;
}

int draw_inputs(struct drawn *x, const struct robot *r, const struct tree *t, const struct dag *d,
	const struct sample_options *o)
{
	/* another sequence than that of the states */
	unsigned short seed[3] = {
		(unsigned short)~o->seed, (unsigned short)~(o->seed >> 16), (unsigned short)~(o->seed >> 32)};

	*x = (struct drawn){.count = STATES};
	if (!sample_states(&x->states, r, t, o))
		return 0;
	x->arrays[0] = (struct drawn_array){"q", x->states.nq, 0, x->states.q};
	x->arrays[1] = (struct drawn_array){"qd", x->states.nv, 0, x->states.qd};
	x->arrays[2] = (struct drawn_array){"qdd", x->states.nv, 0, x->states.qdd};
	if (draw_others(x, &t->task, seed) && draw_rest(x, d, seed))
		return 1;
	draw_free(x);
	return 0;
}

void draw_round(struct drawn *x)
{
	for (int i = 0; i < x->count; i++)
		for (size_t k = 0; k < (x->arrays[i].per_batch ? 1 : x->states.count) * x->arrays[i].rows; k++)
			x->arrays[i].values[k] = (double)(float)x->arrays[i].values[k];
}

void draw_free(struct drawn *x)
{
	for (int i = STATES; i < x->count; i++)
		free(x->arrays[i].values);
	sample_free(&x->states);
	*x = (struct drawn){0};
}

const double *draw_rows(const struct drawn *x, const struct argument *a, size_t sample)
{
	for (int i = 0; i < x->count && !a->is_output; i++)
		if (!strcmp(x->arrays[i].name, a->name))
			return x->arrays[i].values + (x->arrays[i].per_batch ? 0 : sample * x->arrays[i].rows);
	return NULL;
}
