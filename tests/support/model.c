#include "support/model.h"
#include "support/merged.h"
#include <check.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static void open_reference(struct model *m, const char *urdf, size_t length, const struct rneagen_options *o, const char *what)
{
	char message[256];
	struct reference_options r = {.floating = o->base == RNEAGEN_FLOATING,
		.independent = o->mimic == RNEAGEN_MIMIC_INDEPENDENT, .gravity = o->gravity, .order = o->order};

	m->reference = reference_open(urdf, length, &r, message, sizeof message);
	ck_assert_msg(m->reference != NULL, "%s: reference: %s", what, message);
}

void model_open(struct model *m, const char *urdf, size_t length, const struct rneagen_options *o, const char *what)
{
	struct rneagen_error e = {0};
	struct analysis *x;

	*m = (struct model){0};
	arena_init(&m->arena, NULL);
	ck_assert_msg(!robot_read(&m->robot, urdf, length, what, &m->arena, &e), "%s", e.message);
	ck_assert_msg(!merged_analysis(&x, &m->robot, o, &m->arena, &e), "%s", e.message);
	m->tree = x->stated;
	m->request = x->request;
	for (int i = 0; i < MODEL_DAGS; i++) {
		dag_init(&m->raw[i], &m->arena);
		ALGORITHMS[i]->build(&m->raw[i], i == ALGORITHM_rnea ? &x->tree : &m->tree, &m->request);
		dag_init(&m->dag[i], &m->arena);
		dag_fuse(&m->dag[i], &m->raw[i], o->strict);
		ck_assert(!m->dag[i].failed);
	}
	open_reference(m, urdf, length, o, what);
	ck_assert_int_eq(m->tree.nq, m->reference->nq);
	ck_assert_int_eq(m->tree.nv, m->reference->nv);
	ck_assert_int_eq(m->tree.body_count, m->reference->nb);
}

void model_close(struct model *m)
{
	reference_close(m->reference);
	arena_free(&m->arena);
}

/* One state in both precisions, its torques, and what is known of their errors. */
struct sample {
	double *q, *qd, *qdd, *tau, *size, *bound;
	wide *noise; /* what the rounding of the URDF's numbers, and the zeros taken for it, can make */
	float *in_f32[3], *tau_f32;
	wide *reference;
};

static struct sample sample_new(const struct model *m)
{
	size_t nq = (size_t)m->tree.nq, nv = (size_t)m->tree.nv;
	struct sample s = {.q = calloc(nq, sizeof(double)), .qd = calloc(nv, sizeof(double)), .qdd = calloc(nv, sizeof(double)),
		.tau = calloc(nv, sizeof(double)), .size = calloc(nv, sizeof(double)), .bound = calloc(nv, sizeof(double)),
		.tau_f32 = calloc(nv, sizeof(float)), .reference = calloc(nv, sizeof(wide)),
		.noise = calloc(nv, sizeof(wide))};

	for (int i = 0; i < 3; i++)
		s.in_f32[i] = calloc(i ? nv : nq, sizeof(float));
	return s;
}

static void sample_free(struct sample *s)
{
	free(s->q);
	free(s->qd);
	free(s->qdd);
	free(s->tau);
	free(s->size);
	free(s->bound);
	for (int i = 0; i < 3; i++)
		free(s->in_f32[i]);
	free(s->tau_f32);
	free(s->reference);
	free(s->noise);
}

static void evaluate_f64(struct model *m, struct sample *s)
{
	const double *in[] = {s->q, s->qd, s->qdd, NULL};
	double *out[] = {NULL, NULL, NULL, s->tau};
	struct eval_terms terms = {s->size, s->bound};

	ck_assert(eval_f64(&m->dag[ALGORITHM_rnea], in, out, &terms));
}

static void evaluate_f32(struct model *m, struct sample *s)
{
	const double *from[] = {s->q, s->qd, s->qdd};
	const float *in[] = {s->in_f32[0], s->in_f32[1], s->in_f32[2], NULL};
	float *out[] = {NULL, NULL, NULL, s->tau_f32};
	struct eval_terms terms = {s->size, s->bound};

	for (int i = 0; i < 3; i++)
		for (int k = 0; k < (i ? m->tree.nv : m->tree.nq); k++)
			s->in_f32[i][k] = (float)from[i][k];
	ck_assert(eval_f32(&m->dag[ALGORITHM_rnea], in, out, &terms));
	for (int k = 0; k < m->tree.nv; k++)
		s->tau[k] = (double)s->tau_f32[k];
}

static double ratio(double a, double b)
{
	return a == 0 ? 0 : a / b;
}

/* Terms and bounds stand in the order of the DAG's outputs. */
static void judge(const struct model *m, const struct sample *s, double eps, struct model_error *e)
{
	const struct dag *d = &m->dag[ALGORITHM_rnea];
	double error = reference_error(s->tau, s->reference, m->tree.nv);

	e->max = error > e->max || error != error ? error : e->max;
	e->rms += error * error;
	for (size_t i = 0; i < d->output_count; i++) {
		int row = d->outputs[i].row;
		double off = (double)fabsl((long double)s->tau[row] - s->reference[row]);
		double noise = 4 * 0x1p-53 * (double)s->noise[row];

		e->terms = fmax(e->terms, ratio(fmax(off - noise, 0), eps * s->size[i]));
		e->bound = fmax(e->bound, ratio(off, s->bound[i] + noise));
	}
}

static struct model_error measure(struct model *m, uint64_t seed, int samples, int f32)
{
	struct sample s = sample_new(m);
	struct rng rng = rng_seed(seed);
	struct model_error e = {0};

	for (int i = 0; i < samples; i++) {
		reference_sample(m->reference, &rng, f32, s.q, s.qd, s.qdd);
		reference_rnea(m->reference, s.q, s.qd, s.qdd, s.reference);
		reference_magnitude(m->reference, s.q, s.qd, s.qdd, s.noise);
		if (f32)
			evaluate_f32(m, &s);
		else
			evaluate_f64(m, &s);
		judge(m, &s, f32 ? 0x1p-23 : 0x1p-52, &e);
	}
	e.rms = sqrt(e.rms / samples);
	sample_free(&s);
	return e;
}

struct model_error model_error_f64(struct model *m, uint64_t seed, int samples)
{
	return measure(m, seed, samples, 0);
}

struct model_error model_error_f32(struct model *m, uint64_t seed, int samples)
{
	return measure(m, seed, samples, 1);
}
