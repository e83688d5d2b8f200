#include "range/parts/cutting.h"
#include "range/magnitude.h"
#include <math.h>
#include <string.h>

struct cutting cutting_of(const struct relaxed *r, const struct field *fields, int field_count, struct arena *a)
{
	struct cutting s = {.r = r, .d = &r->view.dag, .fields = fields, .field_count = field_count, .a = a,
		.body = arena_alloc(a, r->view.dag.output_count + 1, sizeof(int)), .reads = arena_alloc(a, r->view.dag.count, sizeof(uint64_t)),
		.live = arena_alloc(a, r->view.dag.count, 1), .carries = arena_alloc(a, (size_t)r->view.tree.body_count + 1, 1)};

	for (size_t o = 0; o < r->view.dag.output_count && !a->failed; o++)
		s.body[o] = -1;
	return s;
}

/* ---- where ---- */

static int is_named(const struct tag *tag, int number, const char *quantity, char component)
{
	return tag->body == number && tag->component == component && !strcmp(tag->quantity, quantity);
}

/* Adds nodes with this name; of a number that a joint leaves as it is in the body before, that body's. Returns the new count, -1:
   too many. */
static int add_leaves(const struct cutting *s, int body, const char *quantity, char component, uint32_t *leaves, int count)
{
	const struct tree *t = &s->r->view.tree;
	int before = count;

	for (; body >= 0 && count == before; body = t->bodies[body].parent)
		for (uint32_t i = 1; i < s->d->count; i++) {
			const struct node *n = &s->d->nodes[i];

			if (!op_arity[n->op] || !is_named(&n->tag, t->bodies[body].number, quantity, component))
				continue;
			if (count == MOST_LEAVES)
				return -1;
			leaves[count++] = i;
		}
	return count;
}

int cutting_leaves(const struct cutting *s, int body, uint32_t *leaves)
{
	static const char *const names[] = {"w", "dw", "a"};
	int count = 0;

	for (int k = 0; k < 9 && count >= 0; k++)
		count = add_leaves(s, body, names[k / 3], "xyz"[k % 3], leaves, count);
	return count;
}

static uint64_t bit_of(const struct field *f, int row)
{
	for (int k = 0; k < f->dim_count; k++)
		if (f->dims[k].row == row)
			return (uint64_t)1 << k;
	return 0;
}

static int dims_left(const struct cutting *s, const struct field *f, int output, int body)
{
	int position = dag_find_role(s->d, ROLE_JOINT_POSITION, 0), count = 0;
	uint32_t leaves[MOST_LEAVES];
	int leaf_count = cutting_leaves(s, body, leaves);
	uint64_t all;

	for (uint32_t i = 0; i < s->d->count; i++) {
		const struct node *n = &s->d->nodes[i];

		s->reads[i] = n->op == OP_INPUT && (int)n->arg[0].i == position ? bit_of(f, (int)n->arg[1].i) : 0;
		for (int k = 0; k < op_arity[n->op] && dag_place(leaves, leaf_count, i) < 0; k++)
			s->reads[i] |= s->reads[n->arg[k].i];
	}
	for (all = s->reads[s->d->outputs[output].value.i]; all; all &= all - 1)
		count++;
	return count;
}

int cutting_body(const struct cutting *s, int output)
{
	const struct output *o = &s->d->outputs[output];
	const struct tree *t = &s->r->view.tree;
	enum role role = s->d->arguments[o->argument].role;
	int is_torque = role == ROLE_JOINT_TORQUE || role == ROLE_BIAS_TORQUE || role == ROLE_GRAVITY_TORQUE;

	for (int i = 0; i < t->joint_count && is_torque; i++)
		if (o->row >= t->joints[i].iv && o->row < t->joints[i].iv + t->joints[i].nv)
			return t->joints[i].body;
	return -1;
}

/* The body nearest the ground that leaves few enough. */
static int choose(const struct cutting *s, const struct field *f, int output)
{
	const struct tree *t = &s->r->view.tree;
	int best = -1, body = f->dim_count >= s->from ? cutting_body(s, output) : -1;

	for (body = body >= 0 ? t->bodies[body].parent : -1; body >= 0; body = t->bodies[body].parent)
		if (dims_left(s, f, output, body) <= s->dims)
			best = body;
	return best;
}

static int is_beyond(const struct tree *t, int body, int of)
{
	for (; body >= 0; body = t->bodies[body].parent)
		if (body == of)
			return 1;
	return 0;
}

int cutting_is_small(const struct cutting *s, int body)
{
	const struct tree *t = &s->r->view.tree;
	int rows = 0;

	for (int i = 0; i < t->joint_count; i++)
		rows += is_beyond(t, t->joints[i].body, body) ? t->joints[i].nq : 0;
	return rows <= s->dims;
}

int cutting_is_whole(const struct cutting *s, int body)
{
	for (size_t o = 0; o < s->d->output_count; o++)
		if (s->body[o] >= 0 && is_beyond(&s->r->view.tree, cutting_body(s, (int)o), body))
			return 0;
	return 1;
}

/* The first body from this one on that has several children, where at least two are limbs; -1: there is none. */
static int carrier_of(const struct cutting *s, int body)
{
	const struct tree *t = &s->r->view.tree;

	for (int next = body, children = 1; next >= 0 && children == 1; body = next) {
		children = 0;
		for (int b = 0; b < t->body_count; b++)
			if (t->bodies[b].parent == body && ++children == 1)
				next = b;
		next = children == 1 ? next : body;
	}
	for (int b = 0, limbs = 0; b < t->body_count && body >= 0; b++)
		if (t->bodies[b].parent == body && cutting_is_small(s, b) && cutting_is_whole(s, b) && ++limbs == 2)
			return body;
	return -1;
}

void cutting_choose(struct cutting *s)
{
	for (int k = 0; k < s->field_count; k++)
		for (int o = 0; o < s->fields[k].output_count; o++)
			s->body[s->fields[k].outputs[o]] = choose(s, &s->fields[k], s->fields[k].outputs[o]);
	for (int k = 0; k < s->field_count; k++)
		for (int o = 0; o < s->fields[k].output_count && s->fields[k].dim_count >= s->from; o++) {
			int output = s->fields[k].outputs[o], carrier = s->body[output] < 0 ? carrier_of(s, cutting_body(s, output)) : -1;

			if (carrier >= 0)
				s->carries[carrier] = 1;
		}
}

/* ---- how it moves ---- */

/* Of the leaves as outputs. */
int cutting_ranges(const struct cutting *s, const uint32_t *leaves, int count, struct interval *ranges)
{
	struct relaxed *r = arena_alloc(s->a, 1, sizeof *r);
	struct output *outputs = arena_alloc(s->a, (size_t)count + 1, sizeof *outputs);
	struct rneagen_error e = {0};
	struct effort own = *s->x;
	struct field *fields;
	struct box box;
	int n;

	own.record = NULL; /* these are no rows of the text */
	if (!r || !outputs)
		return 0;
	*r = *s->r;
	memcpy(box.rows, r->rows, sizeof box.rows);
	for (int i = 0; i < count; i++)
		outputs[i] = (struct output){s->d->outputs[0].argument, i, {leaves[i]}};
	r->view.dag.outputs = outputs;
	r->view.dag.output_count = (size_t)count;
	if ((n = field_split(&fields, r, s->a, &e)) < 0)
		return 0;
	for (int k = 0; k < n; k++) {
		struct interval of[MOST_LEAVES];

		if (!magnitude_find(of, &fields[k], &box, 0, &own, s->seconds / (double)n))
			return 0;
		for (int o = 0; o < fields[k].output_count; o++)
			ranges[fields[k].outputs[o]] =
				(struct interval){fmax(of[o].lower, -fields[k].plain[o]), fmin(of[o].upper, fields[k].plain[o])};
	}
	return 1;
}
