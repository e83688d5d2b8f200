#include "drop.h"
#include "eval.h"
#include "sample.h"
#include <math.h>
#include <string.h>

struct dropping {
	const struct dag *d;
	const struct tree *t;
	struct states states;
	double *value, *slope;    /* by node: in one state; derivative of one output */
	double *scale;            /* by output: its largest magnitude */
	double (*effect)[2];      /* by node and operand: the largest part of an output */
	char *guarded;            /* by node: a root or quotient is taken of it, whose terms keep it from 0 */
	double fraction;          /* a term with less of every output goes */
	struct ref *map;
};

/* ---- one state ---- */

static double value_of(const struct dropping *p, const struct node *n, size_t state)
{
	if (n->op != OP_INPUT)
		return eval_node(n, p->value);
	if ((int)n->arg[0].i >= p->d->argument_count)
		return 0; /* nothing that is said depends on it */
	return sample_input(&p->states, p->t, &p->d->arguments[n->arg[0].i], (int)n->arg[1].i, state);
}

static void evaluate(struct dropping *p, size_t state)
{
	for (size_t i = 0; i < p->d->count; i++)
		p->value[i] = value_of(p, &p->d->nodes[i], state);
}

/* From a value's slope back to those of what it is made of. */
static void spread(struct dropping *p, const struct node *n, double slope)
{
	double by[3];

	eval_partials(n, p->value, by);
	for (int k = 0; k < op_arity[n->op]; k++)
		p->slope[n->arg[k].i] += slope * by[k];
}

static void note(struct dropping *p, size_t i, double share)
{
	const struct node *n = &p->d->nodes[i];

	for (int k = 0; k < 2 && (n->op == OP_ADD || n->op == OP_SUB); k++)
		p->effect[i][k] = fmax(p->effect[i][k], fabs(share * p->value[n->arg[k].i]));
}

/* What each operand of a sum has of one output. */
static void sweep(struct dropping *p, size_t output)
{
	size_t top = p->d->outputs[output].value.i;

	if (p->scale[output] == 0)
		return;
	memset(p->slope, 0, (top + 1) * sizeof *p->slope);
	p->slope[top] = 1;
	for (size_t i = top; i > 0; i--)
		if (p->slope[i] != 0) {
			note(p, i, p->slope[i] / p->scale[output]);
			spread(p, &p->d->nodes[i], p->slope[i]);
		}
}

static void examine(struct dropping *p)
{
	for (size_t k = 0; k < p->states.count; k++) {
		evaluate(p, k);
		for (size_t i = 0; i < p->d->output_count; i++)
			p->scale[i] = fmax(p->scale[i], fabs(p->value[p->d->outputs[i].value.i]));
	}
	for (size_t k = 0; k < p->states.count; k++) {
		evaluate(p, k);
		for (size_t i = 0; i < p->d->output_count; i++)
			sweep(p, i);
	}
}

/* v^2 + width^2 under a root is not v^2, however small the width is beside the sampled v. */
static void guard(struct dropping *p)
{
	for (size_t i = p->d->count; i-- > 0;) {
		const struct node *n = &p->d->nodes[i];

		if (n->op == OP_SQRT || n->op == OP_DIV)
			p->guarded[n->arg[n->op == OP_DIV].i] = 1;
		for (int k = 0; k < op_arity[n->op] && p->guarded[i]; k++)
			p->guarded[n->arg[k].i] = 1;
	}
}

/* ---- the copy ---- */

static struct ref copy(void *context, struct dag *out, size_t i)
{
	const struct dropping *p = context;
	const struct node *n = &p->d->nodes[i];
	struct ref arg[3];

	for (int k = 0; k < op_arity[n->op]; k++) {
		arg[k] = p->map[n->arg[k].i];
		if ((n->op == OP_ADD || n->op == OP_SUB) && !p->guarded[i] && p->effect[i][k] < p->fraction)
			arg[k] = (struct ref){0};
	}
	switch (n->op) {
	case OP_CONST:
		return dag_const(out, n->value);
	case OP_INPUT:
		return dag_input(out, (int)n->arg[0].i, (int)n->arg[1].i);
	case OP_NEG:
		return dag_neg(out, arg[0]);
	case OP_ADD:
		return dag_add(out, arg[0], arg[1]);
	case OP_SUB:
		return dag_sub(out, arg[0], arg[1]);
	case OP_MUL:
		return dag_mul(out, arg[0], arg[1]);
	case OP_DIV:
		return dag_div(out, arg[0], arg[1]);
	case OP_SQRT:
		return dag_sqrt(out, arg[0]);
	case OP_SIN:
		return dag_sin(out, arg[0]);
	case OP_COS:
		return dag_cos(out, arg[0]);
	default:
		return dag_fma(out, arg[0], arg[1], arg[2]);
	}
}

void drop_terms(struct dag *out, const struct dag *d, const struct tree *t, double fraction)
{
	struct arena *a = out->arena;
	struct dropping p = {.d = d, .t = t, .fraction = fraction};

	p.value = arena_alloc(a, d->count, sizeof *p.value);
	p.slope = arena_alloc(a, d->count, sizeof *p.slope);
	p.scale = arena_alloc(a, d->output_count, sizeof *p.scale);
	p.effect = arena_alloc(a, d->count, sizeof *p.effect);
	p.guarded = arena_alloc(a, d->count, 1);
	p.map = arena_alloc(a, d->count, sizeof *p.map);
	if (d->failed || !p.value || !p.slope || !p.scale || !p.effect || !p.guarded || !p.map ||
		!sample_states(&p.states, t->source, t, &SAMPLE_EFFECTS)) {
		out->failed = 1;
		return;
	}
	examine(&p);
	guard(&p);
	dag_copy(out, d, p.map, copy, &p);
	sample_free(&p.states);
}
