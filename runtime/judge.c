#include "judge.h"
#include "eval.h"
#include <math.h>
#include <stdlib.h>

#if defined __SIZEOF_FLOAT128__ && defined RNEAGEN_QUAD
#define eval_exact eval_quad
#else
#define eval_exact eval_real
#endif

enum { Q, QD, QDD, INPUTS, ARGUMENTS = INPUTS + 1 };

/* One state and what comes of it. */
struct trial {
	exact *x;
	double *x64, *tau64, *size; /* size: in the order of the DAG's outputs */
};

int judge_is_f32(enum rneagen_precision precision)
{
	return precision == RNEAGEN_F32 || precision == RNEAGEN_MIXED;
}

static double eps_of(const struct judge *j)
{
	return judge_is_f32(j->precision) ? 0x1p-23 : 0x1p-52;
}

/* Divided by the largest, since squares of tiny torques vanish. */
static double norm(const double *x, size_t n)
{
	double largest = 0, sum = 0;

	for (size_t i = 0; i < n; i++) {
		if (!isfinite(x[i]))
			return (double)INFINITY;
		largest = fmax(largest, fabs(x[i]));
	}
	for (size_t i = 0; i < n && largest > 0; i++)
		sum += x[i] / largest * (x[i] / largest);
	return largest * sqrt(sum);
}

static double norm_exact(const struct judge *j, size_t k)
{
	double sum = 0, largest = 0;
	const exact *tau = j->tau + k * j->states.nv;

	for (size_t i = 0; i < j->states.nv; i++)
		largest = fmax(largest, fabs((double)tau[i]));
	for (size_t i = 0; i < j->states.nv && largest > 0; i++)
		sum += (double)tau[i] / largest * ((double)tau[i] / largest);
	return largest * sqrt(sum);
}

/* ---- evaluating ---- */

static int trial_new(struct trial *t, const struct analysis *a)
{
	size_t nv = (size_t)a->tree.nv, rows = (size_t)a->tree.nq + 2 * nv;

	*t = (struct trial){.x = calloc(rows, sizeof *t->x), .x64 = calloc(rows, sizeof *t->x64),
		.tau64 = calloc(nv, sizeof *t->tau64), .size = calloc(nv, sizeof *t->size)};
	return t->x && t->x64 && t->tau64 && t->size;
}

static void trial_free(struct trial *t)
{
	free(t->x);
	free(t->x64);
	free(t->tau64);
	free(t->size);
}

static void load(struct trial *t, const struct states *s, size_t k)
{
	const double *from[INPUTS] = {s->q + k * s->nq, s->qd + k * s->nv, s->qdd + k * s->nv};
	size_t at = 0;

	for (int i = 0; i < INPUTS; i++)
		for (size_t r = 0; r < (i == Q ? s->nq : s->nv); r++, at++) {
			t->x[at] = (exact)from[i][r];
			t->x64[at] = from[i][r];
		}
}

static int evaluate(struct judge *j, const struct dag *d, struct trial *t, size_t k)
{
	size_t nq = j->states.nq, nv = j->states.nv;
	const exact *in[ARGUMENTS] = {t->x, t->x + nq, t->x + nq + nv};
	const double *in64[ARGUMENTS] = {t->x64, t->x64 + nq, t->x64 + nq + nv};
	struct eval_terms terms = {t->size, NULL};

	load(t, &j->states, k);
	if (!eval_exact(d, in, (exact *[ARGUMENTS]){[INPUTS] = j->tau + k * nv}, NULL) ||
		!eval_f64(d, in64, (double *[ARGUMENTS]){[INPUTS] = t->tau64}, &terms))
		return 0;
	for (size_t i = 0; i < d->output_count; i++)
		j->size[k * nv + (size_t)d->outputs[i].row] = t->size[i];
	return 1;
}

int judge_open(struct judge *j, const struct analysis *a, enum rneagen_precision precision, const struct sample_options *o)
{
	struct trial t = {0};
	size_t nv = (size_t)a->tree.nv;
	int done;

	*j = (struct judge){.precision = precision, .tau = calloc(o->count, nv * sizeof *j->tau),
		.size = calloc(o->count, nv * sizeof *j->size)};
	done = j->tau && j->size && sample_states(&j->states, &a->robot, &a->tree, o) && trial_new(&t, a);
	if (done && judge_is_f32(precision))
		sample_round(&j->states);
	for (size_t k = 0; done && k < o->count; k++)
		done = evaluate(j, &a->dag, &t, k);
	trial_free(&t);
	if (!done)
		judge_free(j);
	return done;
}

void judge_free(struct judge *j)
{
	free(j->tau);
	free(j->size);
	sample_free(&j->states);
	*j = (struct judge){0};
}

/* ---- judging ---- */

int judge_bound(const struct judge *j, const struct analysis *a, const struct rneagen_options *o, int on_gpu, double *max)
{
	const struct states *s = &j->states;
	struct eval_model m = eval_model_of(o, on_gpu);
	double *bound = calloc(s->nv, sizeof *bound);
	int done = bound != NULL;

	*max = -1;
	for (size_t k = 0; done && k < s->count; k++) {
		const double *in[ARGUMENTS] = {s->q + k * s->nq, s->qd + k * s->nv, s->qdd + k * s->nv};
		double size = norm_exact(j, k);

		done = eval_bound(&a->dag, &m, in, (double *[ARGUMENTS]){[INPUTS] = bound});
		if (size > 0)
			*max = fmax(*max, norm(bound, s->nv) / size);
	}
	if (!(*max >= 0) || isinf(*max))
		*max = (double)NAN;
	free(bound);
	return done;
}

/* The error of sample k in the norm; the worst of its torques by terms is taken note of. */
static double judge_sample(const struct judge *j, const double *tau, size_t k, double *terms)
{
	size_t nv = j->states.nv;
	double largest = 0, sum = 0;

	for (int pass = 0; pass < 2; pass++)
		for (size_t i = 0; i < nv; i++) {
			exact off = (exact)tau[k * nv + i] - j->tau[k * nv + i];
			double x = fabs((double)off), size = j->size[k * nv + i];

			if (!isfinite(x))
				x = (double)INFINITY;
			if (pass == 0)
				largest = fmax(largest, x);
			else if (largest > 0 && isfinite(largest))
				sum += x / largest * (x / largest);
			if (x > 0)
				*terms = fmax(*terms, x / (eps_of(j) * size));
		}
	return isfinite(largest) ? largest * sqrt(sum) : largest;
}

struct judge_errors judge_torques(const struct judge *j, const double *tau)
{
	struct judge_errors e = {0};
	size_t counted = 0;

	for (size_t k = 0; k < j->states.count; k++) {
		double off = judge_sample(j, tau, k, &e.terms), size = norm_exact(j, k);

		if (!(size > 0))
			continue;
		e.max = fmax(e.max, off / size);
		e.rms += off / size * (off / size);
		counted++;
	}
	e.rms = counted ? sqrt(e.rms / (double)counted) : (double)NAN;
	if (!counted)
		e.max = (double)NAN;
	return e;
}
