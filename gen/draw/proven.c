/* A DAG without some terms computes v + e where the whole one has v. A sum without a term t is off by -t too, and of a product of
   a and b
     e = a e_b + b e_a + e_a e_b.
   So an output's change is exactly the sum, over all operations, of its derivative in the whole DAG by the operation, times what
   is left out there and products of changes: the rest. Magnitudes of values and of derivatives are bounded over the whole box
   (norms.h). */
#include "draw/proven.h"
#include "draw/proven_bound.h"
#include <math.h>
#include <stdlib.h>

/* A term that may be left out. */
struct term {
	uint32_t node;
	int operand;
	double cost; /* the largest part of an output's budget that it takes alone */
};

struct choosing {
	struct dropping p;
	double fraction;
	struct term *terms;
	size_t count;
	unsigned char *out; /* the result: by node, bits of operands */
	char *live;         /* by node: outputs are made of it, without what is out */
	double *error;      /* by node: no change is larger */
	double *sum;        /* by output: of its change, as far as it is known */
};

/* 0 times anything is 0, for what is 0 is exactly that. */
static double product(double a, double b)
{
	return a == 0 || b == 0 ? 0 : a * b;
}

static double size_of_term(const struct choosing *c, const struct term *t)
{
	return c->p.size[c->p.d->nodes[t->node].arg[t->operand].i];
}

static double slope_at(const struct choosing *c, size_t output, uint32_t node)
{
	const double *slope = c->p.slope[output];

	return slope && node <= c->p.d->outputs[output].value.i ? slope[node] : 0;
}

static double budget_of(const struct choosing *c, size_t output)
{
	return isfinite(c->p.scale[output]) ? c->fraction * c->p.scale[output] : 0;
}

static int is_open(const struct choosing *c, uint32_t node)
{
	const struct node *n = &c->p.d->nodes[node];

	return c->p.uses[node] && !c->p.kept[node] && (n->op == OP_ADD || n->op == OP_SUB);
}

/* ---- candidates ---- */

static double cost_of(const struct choosing *c, const struct term *t)
{
	double size = size_of_term(c, t), cost = 0;

	for (size_t i = 0; i < c->p.d->output_count; i++) {
		double part = product(slope_at(c, i, t->node), size);

		if (part > 0)
			cost = fmax(cost, part / budget_of(c, i));
	}
	return cost;
}

static int by_cost(const void *a, const void *b)
{
	const struct term *x = a, *y = b;

	if (x->cost != y->cost)
		return (x->cost > y->cost) - (x->cost < y->cost);
	return x->node != y->node ? (x->node > y->node) - (x->node < y->node) : x->operand - y->operand;
}

static void list_terms(struct choosing *c)
{
	for (uint32_t i = 1; i < c->p.d->count; i++)
		for (int k = 0; k < 2 && is_open(c, i); k++) {
			struct term t = {i, k, 0};

			t.cost = cost_of(c, &t);
			if (t.cost <= 1)
				c->terms[c->count++] = t;
		}
	qsort(c->terms, c->count, sizeof *c->terms, by_cost);
}

/* ---- what is left out ---- */

static void find_live(struct choosing *c)
{
	const struct dag *d = c->p.d;

	for (size_t i = 0; i < d->count; i++)
		c->live[i] = 0;
	for (size_t i = 0; i < d->output_count; i++)
		c->live[d->outputs[i].value.i] = 1;
	for (size_t i = d->count; i-- > 0;)
		for (int k = 0; k < op_arity[d->nodes[i].op] && c->live[i]; k++)
			if (!(c->out[i] >> k & 1))
				c->live[d->nodes[i].arg[k].i] = 1;
}

/* Is there room for it in every output? Adds it to the sums where there is. */
static int fits(struct choosing *c, const struct term *t, double share)
{
	double size = size_of_term(c, t);

	for (size_t i = 0; i < c->p.d->output_count; i++)
		if (!(c->sum[i] + product(slope_at(c, i, t->node), size) <= share * budget_of(c, i)))
			return 0;
	for (size_t i = 0; i < c->p.d->output_count; i++)
		c->sum[i] += product(slope_at(c, i, t->node), size);
	return 1;
}

/* Terms of nothing but terms that are out take no room. */
static void recount(struct choosing *c)
{
	find_live(c);
	for (size_t i = 0; i < c->p.d->output_count; i++)
		c->sum[i] = 0;
	for (size_t i = 0; i < c->p.d->count; i++)
		c->out[i] = c->live[i] ? c->out[i] : 0;
	for (size_t i = 0; i < c->count; i++)
		if (c->out[c->terms[i].node] >> c->terms[i].operand & 1)
			fits(c, &c->terms[i], (double)INFINITY);
}

/* The smallest first, until nothing more has room. */
static void choose(struct choosing *c, double share)
{
	int more = 1;

	for (size_t i = 0; i < c->p.d->count; i++)
		c->out[i] = 0;
	for (int round = 0; round < 8 && more; round++) {
		recount(c);
		more = 0;
		for (size_t i = 0; i < c->count; i++) {
			const struct term *t = &c->terms[i];

			if (!c->live[t->node] || c->out[t->node] >> t->operand & 1 || !fits(c, t, share))
				continue;
			c->out[t->node] |= (unsigned char)(1 << t->operand);
			more = 1;
		}
	}
	recount(c);
}

/* ---- the proof ---- */

/* What is not linear in the changes of a node's operands; its own change into c->error. */
static double rest_of(struct choosing *c, uint32_t i)
{
	const struct node *n = &c->p.d->nodes[i];
	double size[3], e[3], inherited = 0, rest = 0;

	for (int k = 0; k < 3; k++) {
		size[k] = k < op_arity[n->op] ? c->p.size[n->arg[k].i] : 0;
		e[k] = k < op_arity[n->op] ? c->error[n->arg[k].i] : 0;
	}
	switch (n->op) {
	case OP_FMA:
	case OP_MUL:
		inherited = product(size[0], e[1]) + product(size[1], e[0]) + e[2];
		rest = product(e[0], e[1]);
		break;
	case OP_NEG:
	case OP_ANEW:
	case OP_ADD:
	case OP_SUB:
		inherited = e[0] + e[1];
		for (int k = 0; k < 2; k++)
			rest += c->out[i] >> k & 1 ? size[k] + e[k] : 0;
		break;
	default: /* nothing is left out below these */
		break;
	}
	c->error[i] = (inherited + rest) * (1 + 0x1p-48);
	return rest;
}

/* Is every output's change within its budget? Into c->sum, and what is told. */
static int holds(struct choosing *c, struct proven *told)
{
	const struct dag *d = c->p.d;
	int good = 1;

	*told = (struct proven){0};
	for (size_t k = 0; k < d->output_count; k++)
		c->sum[k] = 0;
	for (uint32_t i = 0; i < d->count; i++) {
		double rest = c->live[i] ? rest_of(c, i) : (c->error[i] = 0);

		for (size_t k = 0; k < d->output_count && rest > 0; k++)
			c->sum[k] += product(slope_at(c, k, i), rest);
	}
	for (size_t k = 0; k < d->output_count; k++) {
		double change = c->sum[k] * (1 + 0x1p-30);

		good &= change <= budget_of(c, k);
		told->change = fmax(told->change, change);
		if (change > 0)
			told->share = fmax(told->share, change / c->p.scale[k]);
	}
	return good;
}

/* Products of changes take some room, which the choice does not know: less of it, until the proof holds. */
static void settle(struct choosing *c, struct proven *told)
{
	double share = 1;

	for (int i = 0; i < 40; i++, share *= i < 10 ? 0.97 : 0.7) {
		choose(c, share);
		if (holds(c, told))
			return;
	}
	for (size_t i = 0; i < c->p.d->count; i++)
		c->out[i] = 0;
	*told = (struct proven){0};
}

unsigned char *proven_find(struct proven *told, const struct dag *d, const struct tree *t, const struct request *k,
	double fraction, struct arena *a, struct rneagen_error *e)
{
	struct arena spare;
	struct choosing c = {.p = {.d = d, .t = t, .k = k, .a = &spare, .e = e}, .fraction = fraction,
		.out = arena_alloc(a, d->count, 1)};

	arena_init(&spare, &a->allocator);
	c.terms = arena_alloc(&spare, 2 * d->count, sizeof *c.terms);
	c.live = arena_alloc(&spare, d->count, 1);
	c.error = arena_alloc(&spare, d->count, sizeof *c.error);
	c.sum = arena_alloc(&spare, d->output_count, sizeof *c.sum);
	if (!c.out || spare.failed)
		error_memory(e);
	else if (!proven_bound(&c.p)) {
		list_terms(&c);
		settle(&c, told);
	}
	arena_free(&spare);
	return e->code ? NULL : c.out;
}
