/* From the DAG as the algorithm made it to the DAG that is written: live nodes only, a product with one use joined to
   the sum that uses it, signs given to constants and swapped differences where that is free. Where the same bits are wanted
   everywhere, every product is joined to every sum that uses it: a compiler that joins products and sums on its own then
   finds none. That costs nothing but the product itself, where something else uses it too. */
#include "dag/dag.h"
#include <math.h>

struct fuser {
	struct dag *out;
	const struct dag *in;
	const uint32_t *uses;
	int every;               /* join products with further uses, too */
	uint32_t *joined;        /* how many sums have taken this product into an FMA */
	unsigned char *absorbed; /* this node is computed by its users */
	struct ref *map;         /* in -> out */
};

static int lone(const struct fuser *f, struct ref a, enum op op)
{
	return f->in->nodes[a.i].op == op && f->uses[a.i] == 1;
}

/* A product that a float's rounding may leave without its factor: compilers know that fma(1, x, y) is x + y, and join the
   product that y is to that sum. */
static int is_unit(const struct fuser *f, struct ref a)
{
	const struct node *n = &f->in->nodes[a.i], *factor;

	if (n->op != OP_MUL)
		return 0;
	factor = &f->in->nodes[n->arg[0].i];
	return factor->op == OP_CONST && fabsl(fabsl(factor->value) - 1) < 0x1p-23L;
}

/* Which operand of a sum is a product of its own? -1: neither. */
static int product_operand(const struct fuser *f, const struct node *n)
{
	if (n->op != OP_ADD && n->op != OP_SUB)
		return -1;
	if (f->every && is_unit(f, n->arg[1]) && f->in->nodes[n->arg[0].i].op == OP_MUL)
		return 0;
	if (f->every && is_unit(f, n->arg[0]) && f->in->nodes[n->arg[1].i].op == OP_MUL)
		return 1;
	for (int k = 1; k >= 0; k--)
		if (lone(f, n->arg[k], OP_MUL))
			return k;
	for (int k = 1; k >= 0 && f->every; k--)
		if (f->in->nodes[n->arg[k].i].op == OP_MUL)
			return k;
	return -1;
}

/* -x. gcc takes -(a*b + c) for -a*b - c, which differs in the sign of an exact zero: where the same bits are wanted
   everywhere, a joined sum that only its negation uses is written as the latter. */
static struct ref negated(struct fuser *f, struct ref x)
{
	const struct node *n = &f->in->nodes[x.i], *p;
	int product = f->every && f->uses[x.i] == 1 ? product_operand(f, n) : -1;
	struct ref a, rest;

	if (f->every && f->uses[x.i] == 1 && n->op == OP_FMA) {
		rest = negated(f, n->arg[2]);
		return dag_fma(f->out, negated(f, n->arg[0]), f->map[n->arg[1].i], rest);
	}
	if (product < 0)
		return dag_neg(f->out, f->map[x.i]);
	p = &f->in->nodes[n->arg[product].i];
	a = n->op == OP_SUB && product == 1 ? f->map[p->arg[0].i] : negated(f, p->arg[0]);
	rest = n->op == OP_SUB && product == 0 ? f->map[n->arg[1].i] : negated(f, n->arg[!product]);
	return dag_fma(f->out, a, f->map[p->arg[1].i], rest);
}

/* x + a*b, x - a*b = x + (-a)*b, a*b - x = a*b + (-x); a is the constant where there is one */
static struct ref fuse_sum(struct fuser *f, const struct node *n, int product)
{
	const struct node *p = &f->in->nodes[n->arg[product].i];
	struct ref a = f->map[p->arg[0].i], b = f->map[p->arg[1].i], x = f->map[n->arg[!product].i];

	if (n->op == OP_SUB && product == 1)
		a = negated(f, p->arg[0]);
	if (n->op == OP_SUB && product == 0)
		x = negated(f, n->arg[!product]);
	return dag_fma(f->out, a, b, x);
}

/* -(a - b) = b - a; -(c*x) = (-c)*x */
static struct ref fuse_neg(struct fuser *f, const struct node *n)
{
	const struct node *m = &f->in->nodes[n->arg[0].i];
	struct ref a = f->map[m->arg[0].i], b = f->map[m->arg[1].i], none = {0};

	if (f->absorbed[n->arg[0].i] && m->op == OP_SUB)
		return dag_node(f->out, OP_SUB, b, a, none, 0);
	if (f->absorbed[n->arg[0].i])
		return dag_node(f->out, OP_MUL, dag_neg(f->out, a), b, none, 0);
	return negated(f, n->arg[0]);
}

static struct ref fuse_node(void *context, struct dag *out, size_t i)
{
	struct fuser *f = context;
	const struct node *n = &f->in->nodes[i];
	int product = product_operand(f, n);
	struct ref args[3] = {{0}};

	if (!f->uses[i] || f->absorbed[i])
		return args[0];
	if (!op_arity[n->op])
		return dag_copy_leaf(out, f->in, i);
	if (n->op == OP_NEG)
		return fuse_neg(f, n);
	if (product >= 0)
		return fuse_sum(f, n, product);
	for (int k = 0; k < op_arity[n->op]; k++)
		args[k] = f->map[n->arg[k].i];
	return dag_node(out, n->op, args[0], args[1], args[2], 0);
}

/* Can the negation of this node be written as a swapped difference or a product by a negative constant? */
static int neg_is_free(const struct fuser *f, struct ref a)
{
	const struct node *m = &f->in->nodes[a.i];

	if (lone(f, a, OP_SUB))
		return product_operand(f, m) < 0;
	return lone(f, a, OP_MUL) && f->in->nodes[m->arg[0].i].op == OP_CONST;
}

static void mark_absorbed(struct fuser *f)
{
	for (size_t i = 0; i < f->in->count; i++) {
		const struct node *n = &f->in->nodes[i];
		int product = f->uses[i] ? product_operand(f, n) : -1;

		if (product >= 0)
			f->joined[n->arg[product].i]++;
		if (f->uses[i] && n->op == OP_NEG)
			f->absorbed[n->arg[0].i] = (unsigned char)neg_is_free(f, n->arg[0]);
	}
	for (size_t i = 0; i < f->in->count; i++)
		f->absorbed[i] |= f->joined[i] && f->joined[i] == f->uses[i];
}

static void fuse_once(struct dag *out, const struct dag *d, int every)
{
	struct fuser f = {.out = out, .in = d, .every = every};
	uint32_t *uses = arena_alloc(out->arena, d->count, sizeof *uses);

	f.uses = uses;
	f.joined = arena_alloc(out->arena, d->count, sizeof *f.joined);
	f.absorbed = arena_alloc(out->arena, d->count, 1);
	f.map = arena_alloc(out->arena, d->count, sizeof *f.map);
	if (d->failed || !uses || !f.joined || !f.absorbed || !f.map) {
		out->failed = 1;
		return;
	}
	dag_uses(d, uses);
	mark_absorbed(&f);
	dag_copy(out, d, f.map, fuse_node, &f);
	arena_release(out->arena, f.map);
	arena_release(out->arena, f.absorbed);
	arena_release(out->arena, f.joined);
	arena_release(out->arena, uses);
}

/* A value that several products negate has one use left once these are joined: a second turn sees it. */
void dag_fuse(struct dag *out, const struct dag *d, int every)
{
	struct dag joined;

	if (!every) {
		fuse_once(out, d, 0);
		return;
	}
	dag_init(&joined, out->arena);
	fuse_once(&joined, d, 1);
	fuse_once(out, &joined, 1);
	dag_free(&joined);
}
