#include "drop.h"
#include "sample.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

struct dropping {
	const struct dag *d;
	const struct tree *t;
	struct states states;
	double *value, *slope;    /* by node: in one state; derivative of one output */
	double *scale;            /* by output: its largest magnitude */
	double (*effect)[2];      /* by node and operand: the largest part of an output */
	char *guarded;            /* by node: a root or quotient is taken of it, whose terms keep it from 0 */
	struct ref *map;
};

/* ---- one state ---- */

static double apply(const struct dropping *p, const struct node *n, size_t state)
{
	double a = op_arity[n->op] > 0 ? p->value[n->arg[0].i] : 0, b = op_arity[n->op] > 1 ? p->value[n->arg[1].i] : 0;

	switch (n->op) {
	case OP_CONST:
		return (double)n->value;
	case OP_INPUT:
		if ((int)n->arg[0].i >= p->d->argument_count)
			return 0; /* nothing that is said depends on it */
		return sample_input(&p->states, p->t, &p->d->arguments[n->arg[0].i], (int)n->arg[1].i, state);
	case OP_NEG:
		return -a;
	case OP_ADD:
		return a + b;
	case OP_SUB:
		return a - b;
	case OP_MUL:
		return a * b;
	case OP_DIV:
		return a / b;
	case OP_SQRT:
		return sqrt(a);
	case OP_SIN:
		return sin(a);
	case OP_COS:
		return cos(a);
	default:
		return a * b + p->value[n->arg[2].i];
	}
}

static void evaluate(struct dropping *p, size_t state)
{
	for (size_t i = 0; i < p->d->count; i++)
		p->value[i] = apply(p, &p->d->nodes[i], state);
}

/* The rules of differentiation, from a value back to what it is made of. */
static void spread(struct dropping *p, const struct node *n, double slope)
{
	const double *value = p->value;
	double *to = p->slope;

	switch (n->op) {
	case OP_NEG:
		to[n->arg[0].i] -= slope;
		break;
	case OP_ADD:
	case OP_SUB:
		to[n->arg[0].i] += slope;
		to[n->arg[1].i] += n->op == OP_ADD ? slope : -slope;
		break;
	case OP_FMA:
		to[n->arg[2].i] += slope;
		/* fall through */
	case OP_MUL:
		to[n->arg[0].i] += slope * value[n->arg[1].i];
		to[n->arg[1].i] += slope * value[n->arg[0].i];
		break;
	case OP_DIV:
		to[n->arg[0].i] += slope / value[n->arg[1].i];
		to[n->arg[1].i] -= slope * value[n->arg[0].i] / (value[n->arg[1].i] * value[n->arg[1].i]);
		break;
	case OP_SQRT:
		to[n->arg[0].i] += slope / (2 * sqrt(value[n->arg[0].i]));
		break;
	case OP_SIN:
		to[n->arg[0].i] += slope * cos(value[n->arg[0].i]);
		break;
	case OP_COS:
		to[n->arg[0].i] -= slope * sin(value[n->arg[0].i]);
		break;
	default:
		break;
	}
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

static struct ref copy(const struct dropping *p, struct dag *out, size_t i, double fraction)
{
	const struct node *n = &p->d->nodes[i];
	struct ref arg[3];

	for (int k = 0; k < op_arity[n->op]; k++) {
		arg[k] = p->map[n->arg[k].i];
		if ((n->op == OP_ADD || n->op == OP_SUB) && !p->guarded[i] && p->effect[i][k] < fraction)
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

static void copy_all(const struct dropping *p, struct dag *out, double fraction)
{
	const struct dag *d = p->d;
	size_t section = 0;

	for (int i = 0; i < d->argument_count; i++)
		dag_argument_of(out, d->arguments[i]);
	for (size_t i = 0; i < d->count; i++) {
		const struct tag *tag = &d->nodes[i].tag;

		for (; section < d->section_count && d->sections[section].node <= i; section++)
			dag_section(out, d->sections[section].kind, d->sections[section].body);
		p->map[i] = copy(p, out, i, fraction);
		if (tag->quantity[0])
			dag_tag(out, p->map[i], tag->quantity, tag->body, tag->component);
	}
	for (; section < d->section_count; section++)
		dag_section(out, d->sections[section].kind, d->sections[section].body);
	for (size_t i = 0; i < d->output_count; i++)
		dag_output(out, d->outputs[i].argument, d->outputs[i].row, p->map[d->outputs[i].value.i]);
	for (size_t i = 0; i < out->section_count; i++)
		out->sections[i].output = d->sections[i].output;
}

void drop_terms(struct dag *out, const struct dag *d, const struct tree *t, double fraction)
{
	struct arena *a = out->arena;
	struct dropping p = {.d = d, .t = t};

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
	copy_all(&p, out, fraction);
	sample_free(&p.states);
}
