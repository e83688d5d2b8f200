/* A text computes v + delta where v is exact. For a product of a and b,
     delta = a delta_b + b delta_a + (delta_a delta_b + its own rounding),
   and so for each operation: what is linear in the operands' errors, and a rest. So the output's error is exactly the sum over all
   operations of (the output's derivative by the operation) times (the rest there), as in FPTaylor (Solovyev et al., Rigorous estimation
   of floating-point round-off errors with symbolic Taylor expansions, TOPLAS 41, 2018). Magnitudes of both are bounded over boxes of q
   (norms.h), for all drives and rates at once; the box with the largest bound is split until the time is over. */
#define _POSIX_C_SOURCE 200809L
#include "prove/rounding.h"
#include "core/seconds.h"
#include "dag/eval.h"
#include "prove/adjoint.h"
#include "prove/norms.h"
#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { MOST_BOXES = 1 << 18, TRY_EVERY = 32 };

struct leaf {
	double error[PROVE_PRECISIONS];
	struct interval value, q[FIELD_DIMS];
};

/* One output. */
struct hunt {
	const struct dag *d;
	const struct eval_model *models;
	int count;
	struct adjoint x;
	struct norms norms;
	struct interval *rows[DAG_ARGUMENTS]; /* of the box, those of q its own */
	struct interval *values;
	double *norm, *running;
	int position, dims[FIELD_DIMS], dim_count;
	double width[FIELD_DIMS], score[FIELD_DIMS];
	struct leaf *leaves; /* a heap: none has a larger first error than the one above it */
	size_t leaf_count;
	struct arena arena;
};

/* ---- a box ---- */

static double rounded(double unit, double tiny, double size)
{
	return unit * size + tiny;
}

static double size_of(const struct hunt *h, uint32_t i)
{
	return interval_size(h->values[h->x.value[i].i]);
}

/* How far what the text reads is from what was meant. */
static double given(const struct hunt *h, const struct node *n, double size, const struct eval_model *m)
{
	real off;

	if (n->op == OP_INPUT)
		return m->input > 0 && n->arg[0].i != (uint32_t)h->position ? rounded(m->input, m->tiny, size) : 0;
	off = fabsl((m->constant ? m->constant(n->value) : (real)(double)n->value) - n->value) + (real)within_error(dag_number(h->d, n));
	return off > 0 ? (double)off * (1 + 0x1p-40) + 2 * m->tiny : 0;
}

/* The rest at a node, and in *inherited what is linear in the errors of its operands; as spread_of of dag/eval.c, for all values of
   these sizes. */
static double rest_of(const struct hunt *h, uint32_t i, const struct eval_model *m, double *inherited)
{
	const struct node *n = &h->d->nodes[i];
	uint32_t a = op_arity[n->op] > 0 ? n->arg[0].i : 0, b = op_arity[n->op] > 1 ? n->arg[1].i : 0, c = op_arity[n->op] > 2 ? n->arg[2].i : 0;
	double A = size_of(h, a), B = size_of(h, b), ea = h->running[a], eb = h->running[b], value = size_of(h, i), product = A * eb + B * ea;
	double rest;

	*inherited = 0;
	switch (n->op) {
	case OP_CONST:
	case OP_INPUT:
		return given(h, n, value, m);
	case OP_NEG:
	case OP_ANEW:
		*inherited = ea;
		return 0;
	case OP_ADD:
	case OP_SUB:
		*inherited = ea + eb;
		rest = m->terms * (A + B + ea + eb);
		return rest + rounded(m->add, m->tiny, value + ea + eb + rest);
	case OP_MUL:
		*inherited = product;
		return ea * eb + rounded(m->mul, m->tiny, value + product + ea * eb);
	case OP_FMA:
		*inherited = product + h->running[c];
		rest = ea * eb + (m->fused ? 0 : rounded(m->mul, m->tiny, A * B + product + ea * eb));
		rest += m->terms * (A * B + size_of(h, c) + *inherited + rest);
		return rest + rounded(m->add, m->tiny, value + *inherited + rest);
	case OP_SIN:
	case OP_COS:
		if (!(A <= m->angle))
			return (double)INFINITY;
		return rounded(m->sincos, m->tiny, value) + (n->op == OP_SIN ? m->sine : m->cosine);
	default:
		return (double)INFINITY;
	}
}

/* Over the box in h->rows, whose values are known. */
static double error_of(struct hunt *h, const struct eval_model *m)
{
	double sum = 0, most;

	for (uint32_t i = 0; i < h->x.count; i++) {
		double inherited, rest = rest_of(h, i, m, &inherited) * (1 + 0x1p-48);

		h->running[i] = (inherited + rest) * (1 + 0x1p-48);
		if (!(size_of(h, i) + h->running[i] <= m->largest))
			return (double)INFINITY;
		if (h->x.slope[i].i && rest > 0)
			sum += interval_size(h->values[h->x.slope[i].i]) * rest;
	}
	/* sums of up to 2^20 terms; derivatives' own constants are rounded by 2^-64 */
	sum *= 1 + 0x1p-30;
	most = interval_size(h->values[h->x.root.i]) + sum;
	if (!(most <= m->store_largest))
		return (double)INFINITY;
	return m->store > 0 ? (sum + m->store * most + m->store_tiny) * (1 + 0x1p-30) : sum;
}

static void examine(struct hunt *h, struct leaf *leaf)
{
	for (int k = 0; k < h->dim_count; k++)
		h->rows[h->position][h->dims[k]] = leaf->q[k];
	norms_evaluate(&h->norms, (const struct interval *const *)h->rows, h->values, h->norm);
	leaf->value = h->values[h->x.root.i];
	for (int i = 0; i < h->count; i++)
		leaf->error[i] = error_of(h, &h->models[i]);
}

/* ---- boxes ---- */

static void push(struct hunt *h, const struct leaf *leaf)
{
	size_t at = h->leaf_count++;

	for (; at > 0 && h->leaves[(at - 1) / 2].error[0] < leaf->error[0]; at = (at - 1) / 2)
		h->leaves[at] = h->leaves[(at - 1) / 2];
	h->leaves[at] = *leaf;
}

static void pop(struct hunt *h, struct leaf *leaf)
{
	struct leaf last = h->leaves[--h->leaf_count];
	size_t at = 0, child;

	*leaf = h->leaves[0];
	for (; (child = 2 * at + 1) < h->leaf_count; at = child) {
		if (child + 1 < h->leaf_count && h->leaves[child + 1].error[0] > h->leaves[child].error[0])
			child++;
		if (!(h->leaves[child].error[0] > last.error[0]))
			break;
		h->leaves[at] = h->leaves[child];
	}
	h->leaves[at] = last;
}

/* Returns what of the error is left, at the worse half. */
static double halve(struct hunt *h, const struct leaf *leaf, int k, struct leaf halves[2])
{
	double middle = 0.5 * (leaf->q[k].lower + leaf->q[k].upper);

	halves[0] = halves[1] = *leaf;
	halves[0].q[k].upper = halves[1].q[k].lower = middle;
	examine(h, &halves[0]);
	examine(h, &halves[1]);
	return fmax(halves[0].error[0], halves[1].error[0]) / leaf->error[0];
}

static double part_of(const struct hunt *h, const struct leaf *leaf, int k)
{
	return (leaf->q[k].upper - leaf->q[k].lower) / h->width[k];
}

/* The dimension to halve: all are tried now and then; what each gained is remembered. */
static int choose(struct hunt *h, const struct leaf *leaf, int is_tried)
{
	struct leaf halves[2];
	int best = 0;

	for (int k = 0; k < h->dim_count && is_tried; k++) {
		double gain = (1 - halve(h, leaf, k, halves)) / part_of(h, leaf, k);

		h->score[k] = 0.5 * (h->score[k] + fmax(gain, 1e-6));
	}
	for (int k = 1; k < h->dim_count; k++)
		if (h->score[k] * part_of(h, leaf, k) > h->score[best] * part_of(h, leaf, best))
			best = k;
	return best;
}

static void run(struct hunt *h, double deadline)
{
	struct leaf leaf = {.value = {0, 0}}, halves[2];

	for (int k = 0; k < h->dim_count; k++)
		leaf.q[k] = h->rows[h->position][h->dims[k]];
	examine(h, &leaf);
	push(h, &leaf);
	for (size_t i = 0; h->dim_count && h->leaf_count + 1 < MOST_BOXES && seconds_now() < deadline; i++) {
		int k;

		if (!isfinite(h->leaves[0].error[0]))
			return;
		pop(h, &leaf);
		k = choose(h, &leaf, i % TRY_EVERY == 0);
		h->score[k] = 0.9 * h->score[k] + 0.1 * fmax(1e-6, (1 - halve(h, &leaf, k, halves)) / part_of(h, &leaf, k));
		push(h, &halves[0]);
		push(h, &halves[1]);
	}
}

/* ---- outputs ---- */

struct job {
	struct prove_row *rows;
	const struct analysis *a;
	const struct box *b;
	const struct eval_model *models;
	int count, failed;
	double seconds, deadline; /* of one output; of all */
};

static int copy_rows(struct hunt *h, const struct box *b)
{
	for (int i = 0; i < h->d->argument_count; i++) {
		size_t rows = (size_t)h->d->arguments[i].rows;

		if (!b->rows[i])
			continue;
		h->rows[i] = arena_alloc(&h->arena, rows, sizeof *h->rows[i]);
		if (!h->rows[i])
			return 0;
		memcpy(h->rows[i], b->rows[i], rows * sizeof *h->rows[i]);
	}
	return 1;
}

/* Rows of q that the output depends on and that have room. */
static void list_dims(struct hunt *h)
{
	for (uint32_t i = 0; i < h->x.count; i++) {
		const struct node *n = &h->x.d.nodes[h->x.value[i].i];
		const struct interval *r;

		if (n->op != OP_INPUT || (int)n->arg[0].i != h->position || h->dim_count == FIELD_DIMS)
			continue;
		r = &h->rows[h->position][n->arg[1].i];
		if (r->lower < r->upper) {
			h->width[h->dim_count] = r->upper - r->lower;
			h->score[h->dim_count] = 0.1;
			h->dims[h->dim_count++] = (int)n->arg[1].i;
		}
	}
}

static int hunt_make(struct hunt *h, const struct job *j, size_t output)
{
	*h = (struct hunt){.d = &j->a->dag, .models = j->models, .count = j->count};
	arena_init(&h->arena, NULL);
	h->position = dag_find_role(h->d, ROLE_JOINT_POSITION, 0);
	h->leaves = malloc(MOST_BOXES * sizeof *h->leaves);
	if (!h->leaves || !adjoint_make(&h->x, h->d, output, &h->arena) || !norms_make(&h->norms, &h->x.d, &h->arena) || !copy_rows(h, j->b))
		return 0;
	h->values = arena_alloc(&h->arena, h->x.d.count, sizeof *h->values);
	h->norm = arena_alloc(&h->arena, h->norms.set_count + 1, sizeof *h->norm);
	h->running = arena_alloc(&h->arena, h->x.count, sizeof *h->running);
	list_dims(h);
	return !h->arena.failed;
}

static void take(const struct hunt *h, struct prove_row *r)
{
	double lower = (double)INFINITY, upper = -(double)INFINITY;

	for (int m = 0; m < h->count; m++)
		r->error_bound[m] = 0;
	for (size_t i = 0; i < h->leaf_count; i++) {
		lower = fmin(lower, h->leaves[i].value.lower);
		upper = fmax(upper, h->leaves[i].value.upper);
		for (int m = 0; m < h->count; m++)
			r->error_bound[m] = fmax(r->error_bound[m], round_up(h->leaves[i].error[m]));
	}
	r->low = fmax(r->low, lower);
	r->high = fmin(r->high, upper);
}

static void hunt_output(void *job, size_t output)
{
	struct job *j = job;
	struct hunt h;

	for (int m = 0; m < j->count; m++)
		j->rows[output].error_bound[m] = (double)INFINITY;
	if (hunt_make(&h, j, output)) {
		run(&h, fmin(j->deadline, seconds_now() + j->seconds));
		take(&h, &j->rows[output]);
	} else {
		j->failed = 1;
	}
	free(h.leaves);
	arena_free(&h.arena);
}

int rounding_find(struct prove_row *rows, const struct analysis *a, const struct box *b, const struct eval_model *models, int count,
	const struct effort *x, double seconds)
{
	size_t outputs = a->dag.output_count, rounds = (outputs + x->threads - 1) / x->threads;
	struct job j = {rows, a, b, models, count, 0, seconds / (double)(rounds ? rounds : 1), x->deadline};

	workers_run(x->workers, x->threads, hunt_output, &j, outputs);
	return !j.failed;
}
