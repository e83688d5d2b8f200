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
#include "range/adjoint.h"
#include "range/norms.h"
#include "range/split.h"
#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

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
	int position, dims[SPLIT_DIMS];
	struct split split;
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

static void examine(void *context, struct leaf *leaf)
{
	struct hunt *h = context;

	for (int k = 0; k < h->split.dim_count; k++)
		h->rows[h->position][h->dims[k]] = leaf->q[k];
	norms_evaluate(&h->norms, (const struct interval *const *)h->rows, h->values, h->norm);
	leaf->value = h->values[h->x.root.i];
	for (int i = 0; i < h->count; i++)
		leaf->sizes[i] = error_of(h, &h->models[i]);
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

/* Rows of q that the output depends on and that have room. */
static void list_dims(struct hunt *h)
{
	for (uint32_t i = 0; i < h->x.count; i++) {
		const struct node *n = &h->x.d.nodes[h->x.value[i].i];
		const struct interval *r;

		if (n->op != OP_INPUT || (int)n->arg[0].i != h->position || h->split.dim_count == SPLIT_DIMS)
			continue;
		r = &h->rows[h->position][n->arg[1].i];
		if (r->lower < r->upper)
			h->dims[h->split.dim_count++] = (int)n->arg[1].i;
	}
}

static int hunt_make(struct hunt *h, const struct job *j, size_t output)
{
	*h = (struct hunt){.d = &j->a->dag, .models = j->models, .count = j->count};
	arena_init(&h->arena, NULL);
	h->position = dag_find_role(h->d, ROLE_JOINT_POSITION, 0);
	if (!adjoint_make(&h->x, h->d, output, 1, &h->arena) || !norms_make(&h->norms, &h->x.d, &h->arena) ||
		!box_copy(h->rows, j->b, h->d, &h->arena))
		return 0;
	h->values = arena_alloc(&h->arena, h->x.d.count, sizeof *h->values);
	h->norm = arena_alloc(&h->arena, h->norms.set_count + 1, sizeof *h->norm);
	h->running = arena_alloc(&h->arena, h->x.count, sizeof *h->running);
	list_dims(h);
	return !h->arena.failed;
}

static void take(const struct hunt *h, struct prove_row *r)
{
	double errors[SPLIT_SIZES];
	struct interval value;

	split_total(&h->split, errors, &value);
	for (int m = 0; m < h->count; m++)
		r->error_bound[m] = errors[m] > 0 ? round_up(errors[m]) : 0;
	r->low = fmax(r->low, value.lower);
	r->high = fmin(r->high, value.upper);
}

static void hunt_output(void *job, size_t output)
{
	struct job *j = job;
	struct leaf root = {.value = {0, 0}};
	struct hunt h;
	int done = hunt_make(&h, j, output);

	for (int m = 0; m < j->count; m++)
		j->rows[output].error_bound[m] = (double)INFINITY;
	for (int k = 0; k < h.split.dim_count && done; k++)
		root.q[k] = h.rows[h.position][h.dims[k]];
	h.split.examine = examine;
	h.split.context = &h;
	if (done && split_run(&h.split, &root, fmin(j->deadline, seconds_now() + j->seconds)))
		take(&h, &j->rows[output]);
	else
		j->failed = 1;
	split_free(&h.split);
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
