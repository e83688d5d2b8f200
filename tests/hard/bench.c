/* Measuring one case: its robot and states, gen/eval in the precision asked for, and the two references in quad. */
#include "bench.h"
#include "plan/plan.h"
#include "quad.h"
#include "support/numbers.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* One state and what comes of it, by row of tau. */
struct trial {
	double *q, *qd, *qdd;
	double *tau, *size, *bound; /* in the precision that is measured; S_i; the running bound */
	double *noise;		    /* the magnitudes that the reference sums, and rounds */
	double *terms;		    /* in the order of the outputs */
	float *in_f32[3], *tau_f32;
	__float128 *in_quad[3], *reference, *exact, *rounded; /* the DAG in quad, its constants as made and as rounded */
};

struct bench {
	struct hard hard;
	struct quad *quad;
	struct dag rounded; /* constants rounded to the precision */
	struct trial trial;
	double *ratios;
	int f32, nq, nv, samples, counted;
	double largest_error, largest_bound;
};

static struct trial trial_new(int nq, int nv)
{
	struct trial t = {.q = numbers_new(nq, sizeof(double)), .qd = numbers_new(nv, sizeof(double)),
		.qdd = numbers_new(nv, sizeof(double)), .tau = numbers_new(nv, sizeof(double)), .size = numbers_new(nv, sizeof(double)),
		.bound = numbers_new(nv, sizeof(double)), .noise = numbers_new(nv, sizeof(double)),
		.terms = numbers_new(2 * nv, sizeof(double)), .tau_f32 = numbers_new(nv, sizeof(float)),
		.reference = numbers_new(nv, sizeof(__float128)), .exact = numbers_new(nv, sizeof(__float128)),
		.rounded = numbers_new(nv, sizeof(__float128))};

	for (int i = 0; i < 3; i++) {
		t.in_f32[i] = numbers_new(i ? nv : nq, sizeof(float));
		t.in_quad[i] = numbers_new(i ? nv : nq, sizeof(__float128));
	}
	return t;
}

static void trial_free(struct trial *t)
{
	void *all[] = {t->q, t->qd, t->qdd, t->tau, t->size, t->bound, t->noise, t->terms, t->tau_f32, t->reference, t->exact,
		t->rounded, t->in_f32[0], t->in_f32[1], t->in_f32[2], t->in_quad[0], t->in_quad[1], t->in_quad[2]};

	for (size_t i = 0; i < sizeof all / sizeof *all; i++)
		free(all[i]);
}

/* The same DAG, its constants rounded as the text writes them. */
static void round_constants(struct bench *b)
{
	const struct dag *d = &b->hard.model.dag[ALGORITHM_rnea];

	b->rounded = *d;
	b->rounded.nodes = numbers_new((int)d->count, sizeof *d->nodes);
	memcpy(b->rounded.nodes, d->nodes, d->count * sizeof *d->nodes);
	for (size_t i = 0; i < d->count; i++) {
		struct node *n = &b->rounded.nodes[i];

		if (n->op == OP_CONST)
			n->value = b->f32 ? (real)(float)n->value : (real)(double)n->value;
	}
}

static void widen(struct bench *b)
{
	const double *from[] = {b->trial.q, b->trial.qd, b->trial.qdd};

	for (int i = 0; i < 3; i++)
		for (int k = 0; k < (i ? b->nv : b->nq); k++) {
			b->trial.in_f32[i][k] = (float)from[i][k];
			b->trial.in_quad[i][k] = (__float128)from[i][k];
		}
}

static int evaluate_quad(const struct dag *d, struct trial *t, __float128 *tau)
{
	const __float128 *in[] = {t->in_quad[0], t->in_quad[1], t->in_quad[2], NULL};
	__float128 *out[] = {NULL, NULL, NULL, tau};

	return eval_quad(d, in, out, NULL);
}

/* In the precision that is measured; a float's torques widened. */
static int evaluate(struct bench *b, const struct eval_terms *terms)
{
	const struct dag *d = &b->hard.model.dag[ALGORITHM_rnea];
	struct trial *t = &b->trial;
	const float *in_f32[] = {t->in_f32[0], t->in_f32[1], t->in_f32[2], NULL};
	const double *in_f64[] = {t->q, t->qd, t->qdd, NULL};

	if (!b->f32)
		return eval_f64(d, in_f64, (double *[]){NULL, NULL, NULL, t->tau}, terms);
	if (!eval_f32(d, in_f32, (float *[]){NULL, NULL, NULL, t->tau_f32}, terms))
		return 0;
	for (int i = 0; i < b->nv; i++)
		t->tau[i] = (double)t->tau_f32[i];
	return 1;
}

static void run_trial(struct bench *b)
{
	const struct dag *d = &b->hard.model.dag[ALGORITHM_rnea];
	struct trial *t = &b->trial;
	struct eval_terms terms = {t->terms, t->terms + b->nv};

	widen(b);
	quad_rnea(b->quad, t->q, t->qd, t->qdd, t->reference);
	quad_magnitude(b->quad, t->q, t->qd, t->qdd, t->noise);
	if (!evaluate(b, &terms) || !evaluate_quad(d, t, t->exact) || !evaluate_quad(&b->rounded, t, t->rounded))
		abort();
	for (size_t i = 0; i < d->output_count; i++) {
		t->size[d->outputs[i].row] = terms.size[i];
		t->bound[d->outputs[i].row] = terms.bound[i];
	}
}

/* ---- judging ---- */

static double distance(__float128 a, __float128 b)
{
	return (double)(a < b ? b - a : a - b);
}

/* Divided by the largest, since squares of tiny torques vanish. */
static double norm(const double *x, int n)
{
	double largest = 0, sum = 0;

	for (int i = 0; i < n; i++)
		largest = fmax(largest, fabs(x[i]));
	for (int i = 0; i < n && largest > 0; i++)
		sum += x[i] / largest * (x[i] / largest);
	return largest * sqrt(sum);
}

static double norm_quad(const __float128 *a, const __float128 *b, int n)
{
	double *off = numbers_new(n, sizeof *off), size;

	for (int i = 0; i < n; i++)
		off[i] = distance(a[i], b ? b[i] : 0);
	size = norm(off, n);
	free(off);
	return size;
}

static void judge_torque(const struct bench *b, int i, struct outcome *o)
{
	const struct trial *t = &b->trial;
	__float128 tau = (__float128)t->tau[i];
	double off = distance(tau, t->reference[i]), off_dag = distance(tau, t->exact[i]);
	double eps = b->f32 ? 0x1p-23 : 0x1p-52;

	if (!isfinite(t->tau[i])) {
		o->overflowed++;
		o->broken += !isinf(t->bound[i]);
		return;
	}
	if (!(off_dag <= t->bound[i] && off <= t->bound[i] + 0x1p-100 * t->noise[i])) {
		o->broken++;
		fprintf(stderr, "%s %s: torque %d is off by %g, from the DAG's by %g, bound %g\n", b->hard.of->name,
			b->f32 ? "f32" : "f64", i, off, off_dag, t->bound[i]);
	}
	if (off > 0 && t->size[i] > 0)
		o->terms = fmax(o->terms, off / t->size[i] / eps);
	if (off_dag > 0)
		o->least = fmin(o->least, t->bound[i] / off_dag);
}

static void judge_sample(struct bench *b, struct outcome *o)
{
	struct trial *t = &b->trial;
	__float128 *tau = numbers_new(b->nv, sizeof *tau);
	double size = norm_quad(t->reference, NULL, b->nv), bound = norm(t->bound, b->nv), off;

	for (int i = 0; i < b->nv; i++) {
		judge_torque(b, i, o);
		tau[i] = (__float128)t->tau[i];
	}
	off = norm_quad(tau, t->reference, b->nv);
	if (size > 0) {
		o->max = fmax(o->max, off / size);
		o->rms += off / size * (off / size);
		o->model = fmax(o->model, norm_quad(t->rounded, t->reference, b->nv) / size);
		o->arithmetic = fmax(o->arithmetic, norm_quad(tau, t->rounded, b->nv) / size);
		b->counted++;
	}
	if (off > 0)
		b->ratios[b->samples++] = bound / off;
	b->largest_error = fmax(b->largest_error, off);
	b->largest_bound = fmax(b->largest_bound, bound);
	free(tau);
}

static int ascending(const void *a, const void *b)
{
	const double *x = a, *y = b;

	return (*x > *y) - (*x < *y);
}

static void bench_open(struct bench *b, const struct hard_case *c)
{
	char message[256];

	hard_open(&b->hard, c);
	b->nq = b->hard.model.tree.nq;
	b->nv = b->hard.model.tree.nv;
	b->trial = trial_new(b->nq, b->nv);
	b->ratios = numbers_new(c->samples, sizeof *b->ratios);
	b->quad = quad_open(
		b->hard.urdf, b->hard.length, c->floating, 0, QUAD_DECIMALS, b->hard.options.gravity, NULL,
		message, sizeof message);
	if (!b->quad)
		abort();
	round_constants(b);
}

static void bench_close(struct bench *b)
{
	free(b->ratios);
	free(b->rounded.nodes);
	trial_free(&b->trial);
	quad_close(b->quad);
	hard_close(&b->hard);
}

static unsigned count_flops(struct model *m)
{
	struct operation_count n;
	struct plan plan;

	if (!plan_build(&plan, &m->dag[ALGORITHM_rnea], &m->tree, &m->arena))
		abort();
	n = plan_operations(&plan);
	return n.mul + n.add + n.sub + 2 * n.fma;
}

struct outcome bench_measure(const struct hard_case *c, int f32, unsigned *flops)
{
	struct bench b = {.f32 = f32};
	struct outcome o = {.least = (double)INFINITY};
	struct rng rng = rng_seed(BENCH_SEED);

	bench_open(&b, c);
	*flops = count_flops(&b.hard.model);
	for (int i = 0; i < c->samples; i++) {
		hard_sample(&b.hard, &rng, f32, b.trial.q, b.trial.qd, b.trial.qdd);
		run_trial(&b);
		judge_sample(&b, &o);
	}
	qsort(b.ratios, (size_t)b.samples, sizeof *b.ratios, ascending);
	o.typical = b.samples ? b.ratios[b.samples / 2] : 0;
	o.of_max = b.largest_error > 0 ? b.largest_bound / b.largest_error : 0;
	o.least = b.samples ? o.least : 0;
	o.rms = b.counted ? sqrt(o.rms / b.counted) : 0;
	bench_close(&b);
	return o;
}
