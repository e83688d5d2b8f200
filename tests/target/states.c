#include "target/states.h"
#include <check.h>
#include <stdlib.h>

static double *numbers(int count, int rows)
{
	double *x = calloc((size_t)(count * rows) + 1, sizeof *x);

	ck_assert_ptr_nonnull(x);
	return x;
}

static void evaluate_f64(struct model *m, struct states *s, size_t k, const struct eval_terms *terms)
{
	const double *in[] = {s->q + k * (size_t)s->nq, s->qd + k * (size_t)s->nv, s->qdd + k * (size_t)s->nv, NULL};
	double *out[] = {NULL, NULL, NULL, s->eval + k * (size_t)s->nv};

	ck_assert(eval_f64(&m->dag[ALGORITHM_rnea], in, out, terms));
}

static void evaluate_f32(struct model *m, struct states *s, size_t k, const struct eval_terms *terms)
{
	size_t nq = (size_t)s->nq, nv = (size_t)s->nv;
	float *x = calloc(nq + 3 * nv, sizeof *x);
	const float *in[] = {x, x + nq, x + nq + nv, NULL};
	float *out[] = {NULL, NULL, NULL, x + nq + 2 * nv};

	ck_assert_ptr_nonnull(x);
	for (size_t i = 0; i < nq; i++)
		x[i] = (float)s->q[k * nq + i];
	for (size_t i = 0; i < nv; i++) {
		x[nq + i] = (float)s->qd[k * nv + i];
		x[nq + nv + i] = (float)s->qdd[k * nv + i];
	}
	ck_assert(eval_f32(&m->dag[ALGORITHM_rnea], in, out, terms));
	for (size_t i = 0; i < nv; i++)
		s->eval[k * nv + i] = (double)out[3][i];
	free(x);
}

/* eval gives terms in the order of the DAG's outputs; here they stand by row. */
static void evaluate(struct model *m, struct states *s, size_t k)
{
	const struct dag *d = &m->dag[ALGORITHM_rnea];
	double *terms = numbers(2, s->nv);
	struct eval_terms t = {terms, terms + s->nv};

	if (s->f32)
		evaluate_f32(m, s, k, &t);
	else
		evaluate_f64(m, s, k, &t);
	for (size_t i = 0; i < d->output_count; i++) {
		size_t row = k * (size_t)s->nv + (size_t)d->outputs[i].row;

		s->size[row] = t.size[i];
		s->bound[row] = t.bound[i];
	}
	free(terms);
}

int state_is_angle(const struct model *m, int row)
{
	const struct tree_joint *j = tree_joint_of_q(&m->tree, row);

	return j && (j->type == JOINT_REVOLUTE || j->type == JOINT_CONTINUOUS || (j->type == JOINT_PLANAR && row == j->iq + 2));
}

static void enlarge_angles(const struct model *m, int f32, double by, double *q)
{
	for (int i = 0; i < m->tree.nq && !m->tree.mimic_count; i++)
		if (state_is_angle(m, i))
			q[i] = f32 ? (double)(float)(q[i] * by) : q[i] * by;
}

struct states states_new_large(struct model *m, uint64_t seed, int count, int f32, int with_noise, double enlarge)
{
	int nq = m->tree.nq, nv = m->tree.nv;
	struct states s = {.count = count,
		.nq = nq,
		.nv = nv,
		.f32 = f32,
		.q = numbers(count, nq),
		.qd = numbers(count, nv),
		.qdd = numbers(count, nv),
		.eval = numbers(count, nv),
		.size = numbers(count, nv),
		.bound = numbers(count, nv),
		.noise = numbers(count, nv),
		.tau = calloc((size_t)(count * nv), sizeof(wide))};
	wide *magnitude = calloc((size_t)nv, sizeof *magnitude);
	struct rng rng = rng_seed(seed);

	ck_assert(s.tau && magnitude);
	for (int k = 0; k < count; k++) {
		double *q = s.q + k * nq, *qd = s.qd + k * nv, *qdd = s.qdd + k * nv;

		reference_sample(m->reference, &rng, f32, q, qd, qdd);
		if (k >= count - 100 && k % 10 == 0)
			enlarge_angles(m, f32, enlarge, q);
		reference_rnea(m->reference, q, qd, qdd, s.tau + k * nv);
		if (with_noise)
			reference_magnitude(m->reference, q, qd, qdd, magnitude);
		for (int i = 0; i < nv; i++)
			s.noise[k * nv + i] = 4 * 0x1p-53 * (double)magnitude[i];
		evaluate(m, &s, (size_t)k);
	}
	free(magnitude);
	return s;
}

struct states states_new(struct model *m, uint64_t seed, int count, int f32, int with_noise)
{
	return states_new_large(m, seed, count, f32, with_noise, 1e9);
}

void states_free(struct states *s)
{
	free(s->q);
	free(s->qd);
	free(s->qdd);
	free(s->tau);
	free(s->eval);
	free(s->size);
	free(s->bound);
	free(s->noise);
}
