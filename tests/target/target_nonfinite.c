/* Inputs that are not finite. Which torque depends on which input is asked of the reference, by moving the input. */
#include "target/target_check.h"
#include <check.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { SAMPLES = 3 };

/* The inputs of a sample, one after the other. */
struct inputs {
	int nq, nv;
	double *x; /* q, qd, qdd */
};

static void run_reference(const struct check *c, const struct inputs *in, wide *tau)
{
	reference_rnea(c->model->reference, in->x, in->x + in->nq, in->x + in->nq + in->nv, tau);
}

/* Clear yes or nothing: a change far above rounding. */
static void find_dependence(const struct check *c, struct inputs *in, int which, char *depends)
{
	wide *before = calloc((size_t)in->nv, sizeof *before), *after = calloc((size_t)in->nv, sizeof *after);
	double kept = in->x[which];

	run_reference(c, in, before);
	in->x[which] += 0.37;
	run_reference(c, in, after);
	in->x[which] = kept;
	for (int i = 0; i < in->nv; i++)
		depends[i] =
			fabsl((long double)(after[i] - before[i])) > 1e-9L * (1e-3L + fabsl((long double)before[i]));
	free(before);
	free(after);
}

static size_t element(const struct target *t, int sample, int row, int rows)
{
	return (size_t)(t->options.layout == RNEAGEN_SOA ? row * SAMPLES + sample : sample * rows + row);
}

struct batch {
	struct array in[3], tau;
};

static struct batch batch_new(const struct check *c)
{
	const struct states *s = c->states;
	const double *const from[] = {s->q, s->qd, s->qdd};
	struct batch b;

	for (int k = 0; k < 3; k++) {
		int rows = k ? s->nv : s->nq;

		b.in[k] = array_new(s->f32, (size_t)(rows * SAMPLES));
		for (int i = 0; i < rows * SAMPLES; i++)
			array_set(&b.in[k], element(c->target, i / rows, i % rows, rows), from[k][i]);
	}
	b.tau = array_new(s->f32, (size_t)(s->nv * SAMPLES));
	return b;
}

static void run(const struct check *c, struct batch *b, double *tau)
{
	target_batch(c->target, &b->in[0], &b->in[1], &b->in[2], &b->tau, SAMPLES);
	for (size_t i = 0; i < b->tau.count; i++)
		tau[i] = array_get(&b->tau, i);
}

/* The same bits; but gcc in its own dialect joins products to sums as it likes, not in every loop alike. */
static int is_untouched(const struct check *c, double spoilt, double sound)
{
	double near = strstr(c->target->what, "-std=gnu") ? (c->target->f32 ? 1e-4 : 1e-12) : 0;

	return same_number(spoilt, sound) || fabs(spoilt - sound) <= near * (1 + fabs(sound));
}

/* Torques with input `row` of array `k` of the middle sample spoilt, against those without. */
static void judge(const struct check *c, const double *spoilt, const double *sound, const char *depends, int k, int row)
{
	static const char *const names[] = {"q", "qd", "qdd"};
	int nv = c->states->nv;

	for (int sample = 0; sample < SAMPLES; sample++)
		for (int i = 0; i < nv; i++) {
			size_t e = element(c->target, sample, i, nv);

			ck_assert_msg(sample == 1 || is_untouched(c, spoilt[e], sound[e]),
				"%s: %s[%d] not finite in sample 1: torque %d of sample %d is %g", c->target->what,
				names[k], row, i, sample, spoilt[e]);
			ck_assert_msg(sample != 1 || !depends[i] || !isfinite(spoilt[e]),
				"%s: %s[%d] not finite: torque %d is %g", c->target->what, names[k], row, i, spoilt[e]);
		}
}

void check_nonfinite(const struct check *c)
{
	static const double values[] = {NAN, INFINITY, -INFINITY};
	const struct states *s = c->states;
	double beyond = s->f32 ? 1.001e4 : 1.001e7; /* of the domain of sine and cosine in the other modes */
	struct inputs in = {s->nq, s->nv, malloc((size_t)(s->nq + 2 * s->nv) * sizeof(double))};
	double *sound = calloc((size_t)(2 * SAMPLES * s->nv), sizeof *sound), *spoilt = sound + SAMPLES * s->nv;
	char *depends = calloc((size_t)s->nv, 1);
	struct batch b = batch_new(c);

	memcpy(in.x, s->q + s->nq, (size_t)s->nq * sizeof(double));
	memcpy(in.x + s->nq, s->qd + s->nv, (size_t)s->nv * sizeof(double));
	memcpy(in.x + s->nq + s->nv, s->qdd + s->nv, (size_t)s->nv * sizeof(double));
	run(c, &b, sound);
	for (int which = 0; which < s->nq + 2 * s->nv; which++) {
		int k = which < s->nq		? 0
			: which < s->nq + s->nv ? 1
						: 2,
		    row = which - (k ? s->nq + (k - 1) * s->nv : 0);
		size_t place = element(c->target, 1, row, k ? s->nv : s->nq);

		find_dependence(c, &in, which, depends);
		for (int v = 0; v < 3; v++) {
			array_set(&b.in[k], place, values[v]);
			run(c, &b, spoilt);
			judge(c, spoilt, sound, depends, k, row);
		}
		if (c->target->options.trig != RNEAGEN_ACCURATE && k == 0 && state_is_angle(c->model, row)) {
			array_set(&b.in[k], place, beyond);
			run(c, &b, spoilt);
			judge(c, spoilt, sound, depends, k, row);
		}
		array_set(&b.in[k], place, in.x[which]);
	}
	for (int k = 0; k < 3; k++)
		array_free(&b.in[k]);
	array_free(&b.tau);
	free(depends);
	free(sound);
	free(in.x);
}
