/* Outputs that take an operation in common are joined, and all rows between them. */
#include "plan/grid/joined.h"
#include "plan/readings.h"

struct finder {
	const struct dag *d;
	int rows;              /* of the robot; an output's are those, once or more */
	const struct tree *t;  /* needed where base_rows is above 0 */
	int base_rows;         /* the inputs of these first rows join nothing: each part makes again what they alone make */
	unsigned char *varies; /* by node: it is made of what each sample has of its own, beside those inputs */
	int *output;           /* by node: 1 + an output that takes it; 0: none does */
	int *joined;           /* by output: another one that it is joined to, or itself */
};

/* A stretch of rows that share nothing with others; how many operations they take. */
struct limb {
	int first, last;
	unsigned operations;
};

static int row_of(const struct finder *f, size_t output)
{
	return f->d->outputs[output].row % f->rows;
}

static int root_of(struct finder *f, int output)
{
	while (f->joined[output] != output)
		output = f->joined[output] = f->joined[f->joined[output]];
	return output;
}

static void take(struct finder *f, uint32_t node, int output)
{
	if (!node_is_operation(&f->d->nodes[node]) || !f->varies[node])
		return;
	if (f->output[node])
		f->joined[root_of(f, f->output[node] - 1)] = root_of(f, output);
	else
		f->output[node] = output + 1;
}

/* What reads a row that a kernel before has left is joined to what writes it. */
static void take_left(struct finder *f)
{
	const struct dag *d = f->d;

	for (size_t i = 0; i < d->count; i++)
		for (int k = 0; k < op_arity[d->nodes[i].op] && f->output[i]; k++) {
			const struct node *n = &d->nodes[d->nodes[i].arg[k].i];

			if (n->op != OP_INPUT || n->arg[0].i == DAG_STRUCK || !d->arguments[n->arg[0].i].is_output)
				continue;
			for (size_t o = 0; o < d->output_count; o++)
				if (d->outputs[o].argument == (int)n->arg[0].i && d->outputs[o].row == (int)n->arg[1].i)
					f->joined[root_of(f, f->output[i] - 1)] = root_of(f, (int)o);
		}
}

static int is_of_base(const struct finder *f, const struct node *input)
{
	const struct tree_joint *j = f->base_rows ? readings_joint(f->d, input, f->t) : NULL;

	return j && j->iv < f->base_rows;
}

static void find_varying(struct finder *f)
{
	const struct dag *d = f->d;

	for (size_t i = 0; i < d->count; i++) {
		const struct node *n = &d->nodes[i];

		if (n->op == OP_INPUT)
			f->varies[i] = n->arg[0].i != DAG_STRUCK && !d->arguments[n->arg[0].i].per_batch && !is_of_base(f, n);
		for (int k = 0; k < op_arity[n->op]; k++)
			f->varies[i] |= f->varies[n->arg[k].i];
	}
}

static int find(struct finder *f, struct arena *a)
{
	const struct dag *d = f->d;

	f->varies = arena_alloc(a, d->count, 1);
	f->output = arena_alloc(a, d->count, sizeof *f->output);
	f->joined = arena_alloc(a, d->output_count + 1, sizeof *f->joined);
	if (a->failed)
		return 0;
	find_varying(f);
	for (size_t i = 0; i < d->output_count; i++)
		f->joined[i] = (int)i;
	for (size_t i = 0; i < d->output_count; i++)
		take(f, d->outputs[i].value.i, (int)i);
	for (size_t i = d->count; i-- > 0;)
		for (int k = 0; k < op_arity[d->nodes[i].op] && f->output[i]; k++)
			take(f, d->nodes[i].arg[k].i, f->output[i] - 1);
	take_left(f);
	return 1;
}

/* By row: the first row that it, or one after it, is joined to. */
static void join_rows(struct finder *f, int *first, int *least)
{
	const struct dag *d = f->d;

	for (int i = 0; i < f->rows; i++)
		first[i] = i;
	for (size_t i = 0; i < d->output_count; i++)
		least[i] = f->rows;
	for (size_t i = 0; i < d->output_count; i++) {
		int *l = &least[root_of(f, (int)i)];

		*l = row_of(f, i) < *l ? row_of(f, i) : *l;
	}
	for (size_t i = 0; i < d->output_count; i++) {
		int *of_row = &first[row_of(f, i)], l = least[root_of(f, (int)i)];

		*of_row = l < *of_row ? l : *of_row;
	}
	for (int i = f->rows - 1; i > 0; i--)
		if (first[i] < i && first[i] < first[i - 1])
			first[i - 1] = first[i];
}

/* Returns how many there are. */
static int limbs_of(struct finder *f, struct limb *limbs, struct arena *a)
{
	const struct dag *d = f->d;
	size_t rows = (size_t)f->rows + 1;
	int *first = arena_alloc(a, rows, sizeof *first), *least = arena_alloc(a, d->output_count + 1, sizeof *least);
	int *limb = arena_alloc(a, rows, sizeof *limb), count = 0;

	if (a->failed)
		return 0;
	join_rows(f, first, least);
	for (int i = 0; i < f->rows; i++) {
		if (first[i] == i)
			limbs[count++] = (struct limb){.first = i};
		limbs[count - 1].last = i;
		limb[i] = count - 1;
	}
	for (size_t i = 0; i < d->count; i++)
		if (f->output[i])
			limbs[limb[row_of(f, (size_t)f->output[i] - 1)]].operations++;
	return count;
}

/* By row: its part. Returns how many there are. */
static int deal_out(const struct limb *limbs, int count, int *part)
{
	unsigned most = 0, sum = 0;
	int parts = 0;

	for (int i = 0; i < count; i++)
		most = limbs[i].operations > most ? limbs[i].operations : most;
	for (int i = 0; i < count; i++) {
		sum += limbs[i].operations;
		if (i == 0 || 8 * sum > 9 * most) { /* a joint about the vertical that carries nothing else takes none */
			parts++;
			sum = limbs[i].operations;
		}
		for (int row = limbs[i].first; row <= limbs[i].last; row++)
			part[row] = parts - 1;
	}
	return parts;
}

static int own(int *owner, struct finder *f, struct arena *a)
{
	size_t rows = (size_t)f->rows + 1;
	struct limb *limbs = arena_alloc(a, rows, sizeof *limbs);
	int *part = arena_alloc(a, rows, sizeof *part), count;

	if (!find(f, a))
		return 0;
	count = limbs_of(f, limbs, a);
	if (a->failed)
		return 0;
	count = deal_out(limbs, count, part);
	for (size_t i = 0; i < f->d->output_count; i++)
		owner[i] = part[row_of(f, i)];
	return count;
}

int joined_own(int *owner, const struct dag *d, int nv, struct arena *a)
{
	struct finder f = {.d = d, .rows = nv};

	return own(owner, &f, a);
}

int joined_own_beyond(int *owner, const struct dag *d, const struct tree *t, int base_rows, struct arena *a)
{
	struct finder f = {.d = d, .rows = t->nv, .t = t, .base_rows = base_rows};

	return own(owner, &f, a);
}
