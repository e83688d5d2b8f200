#include "steps/bends.h"
#include "dag/derive.h"
#include "steps/lengths.h"

/* A whole circle and more. */
static const struct span CIRCLE = {-4, 4};

/* Constants of derivatives are rounded in extended precision. */
#define CLOSED (1 + 0x1p-30)

struct copying {
	const struct dag *from;
	struct ref *map;
	const unsigned char *live;
};

static struct ref copy_node(struct copying *c, struct dag *out, uint32_t i)
{
	const struct node *n = &c->from->nodes[i];
	struct ref arg[3] = {{0}};

	for (int k = 0; k < op_arity[n->op]; k++)
		arg[k] = c->map[n->arg[k].i];
	if (n->op == OP_CONST || n->op == OP_INPUT)
		return dag_copy_leaf(out, c->from, i);
	return n->op == OP_ANEW ? arg[0] : dag_operation(out, n->op, arg[0], arg[1], arg[2]);
}

/* The output alone, in a DAG that can grow. */
static struct ref copy_output(struct dag *out, const struct dag *d, size_t output, struct arena *a)
{
	uint32_t root = d->outputs[output].value.i;
	unsigned char *live = arena_alloc(a, (size_t)root + 1, 1);
	struct copying c = {d, arena_alloc(a, (size_t)root + 1, sizeof *c.map), live};

	dag_init(out, a);
	for (int i = 0; i < d->argument_count; i++)
		dag_argument_of(out, d->arguments[i]);
	if (a->failed)
		return (struct ref){0};
	live[root] = 1;
	dag_mark_operands(d, (size_t)root + 1, live);
	for (uint32_t i = 0; i <= root && !out->failed; i++)
		if (live[i])
			c.map[i] = copy_node(&c, out, i);
	return c.map[root];
}

/* Over all angles; INFINITY where an operation is not known. */
static int size_of(const struct dag *d, size_t output, struct span *const *rows, struct arena *a, double *size)
{
	struct forms forms;
	struct lengths lengths;

	*size = (double)INFINITY;
	if (!forms_make(&forms, d, output, 0, a))
		return !a->failed;
	if (!lengths_make(&lengths, &forms, a) || !lengths_close(&lengths, a))
		return 0;
	lengths_evaluate(&lengths, rows);
	*size = span_size(lengths.value[forms.root.form]) * CLOSED;
	return 1;
}

/* Of its `times`th derivative by an input. */
static int size_of_derivative(const struct dag *d, size_t output, int times, int argument, int row, struct span *const *rows,
	double *size)
{
	struct arena arena;
	struct dag own;
	struct ref root;
	int done;

	arena_init(&arena, NULL);
	root = copy_output(&own, d, output, &arena);
	done = !arena.failed && !own.failed;
	for (int i = 0; i < times && done; i++)
		done = derive_by(&own, &root, argument, row);
	if (done)
		dag_output(&own, d->outputs[output].argument, d->outputs[output].row, root);
	done = done && !own.failed && size_of(&own, 0, rows, &arena, size);
	arena_free(&arena);
	return done;
}

int bends_find(struct bends_start *b, const struct points *p, const struct dag *d, size_t output,
	struct span *const *rows, int position)
{
	struct span before[POINT_DIMS];
	int done;

	for (int k = 0; k < p->dim_count; k++) {
		before[k] = rows[position][p->dims[k].row];
		rows[position][p->dims[k].row] = p->dims[k].is_angle ? CIRCLE : before[k];
	}
	done = size_of_derivative(d, output, 0, position, 0, rows, &b->whole);
	for (int k = 0; k < p->dim_count && done; k++)
		done = size_of_derivative(d, output, 2, position, p->dims[k].row, rows, &b->bends[k]);
	for (int k = 0; k < p->dim_count; k++)
		rows[position][p->dims[k].row] = before[k];
	return done;
}
