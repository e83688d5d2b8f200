/* Expressions in place of what stood for them. */
#include "dag/dag.h"

struct substitution {
	const struct dag *in;
	const struct ref *by;
	struct ref *map;     /* in -> out */
	unsigned char *live;
};

static int is_held(const struct node *n)
{
	return n->op == OP_INPUT && n->arg[0].i == DAG_HELD;
}

/* What outputs are made of, an expression where it is held too. */
static void mark(struct substitution *s)
{
	for (size_t i = 0; i < s->in->output_count; i++)
		s->live[s->in->outputs[i].value.i] = 1;
	for (size_t i = s->in->count; i-- > 0;) {
		const struct node *n = &s->in->nodes[i];

		if (!s->live[i])
			continue;
		if (is_held(n))
			s->live[s->by[n->arg[1].i].i] = 1;
		for (int k = 0; k < op_arity[n->op]; k++)
			s->live[n->arg[k].i] = 1;
	}
}

static struct ref again(void *context, struct dag *out, size_t i)
{
	const struct substitution *s = context;
	const struct node *n = &s->in->nodes[i];
	struct ref args[3] = {{0}};

	if (!s->live[i])
		return args[0];
	if (is_held(n))
		return s->map[s->by[n->arg[1].i].i];
	if (!op_arity[n->op])
		return dag_copy_leaf(out, s->in, i);
	for (int k = 0; k < op_arity[n->op]; k++)
		args[k] = s->map[n->arg[k].i];
	return dag_operation(out, n->op, args[0], args[1], args[2]);
}

void dag_substitute(struct dag *d, const struct ref *by)
{
	struct arena spare, *a = d->arena;
	struct substitution s = {.in = d, .by = by};
	struct dag out;

	if (d->failed)
		return;
	arena_init(&spare, &a->allocator);
	dag_init(&out, &spare);
	s.map = arena_alloc(&spare, d->count, sizeof *s.map);
	s.live = arena_alloc(&spare, d->count, 1);
	if (s.map && s.live) {
		mark(&s);
		dag_copy(&out, d, s.map, again, &s);
	}
	out.failed |= spare.failed;
	dag_free(d);
	d->arena = a;
	dag_take(d, &out);
	a->failed |= spare.failed;
	arena_free(&spare);
}

void dag_forget(struct dag *d)
{
	size_t kept = 0, section = 0;

	for (size_t i = 0; i < d->output_count; i++) {
		for (; section < d->section_count && d->sections[section].output <= i; section++)
			d->sections[section].output = kept;
		if (d->outputs[i].argument < DAG_UNSTORED)
			d->outputs[kept++] = d->outputs[i];
	}
	for (; section < d->section_count; section++)
		d->sections[section].output = kept;
	d->output_count = kept;
}
