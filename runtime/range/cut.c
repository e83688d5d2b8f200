#include "range/cut.h"
#include "range/magnitude.h"
#include <math.h>
#include <string.h>

/* Of so many rows of q grids are close. */
enum { LIMB_DIMS = 5, MOST_LEAVES = 16 };

struct cutting {
	const struct relaxed *r;
	const struct dag *d;
	const struct field *fields;
	int field_count, from;
	const struct effort *x;
	double seconds;
	struct arena *a;
	int *body;       /* by output, where it is cut off; -1: nowhere */
	uint64_t *dims;  /* by node: rows of q that it depends on, where a body is cut off */
	unsigned char *live;
};

/* ---- where ---- */

/* Is it a number of how this body moves? */
static int is_leaf(const struct dag *d, uint32_t i, int number)
{
	const struct node *n = &d->nodes[i];

	return op_arity[n->op] > 0 && n->tag.body == number && n->tag.component &&
	       (!strcmp(n->tag.quantity, "w") || !strcmp(n->tag.quantity, "dw") || !strcmp(n->tag.quantity, "a"));
}

static uint64_t bit_of(const struct field *f, int row)
{
	for (int k = 0; k < f->dim_count; k++)
		if (f->dims[k].row == row)
			return (uint64_t)1 << k;
	return 0;
}

static int dims_left(const struct cutting *s, const struct field *f, int output, int number)
{
	int position = dag_find_role(s->d, ROLE_JOINT_POSITION, 0), count = 0;
	uint64_t all;

	for (uint32_t i = 0; i < s->d->count; i++) {
		const struct node *n = &s->d->nodes[i];

		s->dims[i] = n->op == OP_INPUT && (int)n->arg[0].i == position ? bit_of(f, (int)n->arg[1].i) : 0;
		for (int k = 0; k < op_arity[n->op] && !is_leaf(s->d, i, number); k++)
			s->dims[i] |= s->dims[n->arg[k].i];
	}
	for (all = s->dims[s->d->outputs[output].value.i]; all; all &= all - 1)
		count++;
	return count;
}

static int body_of(const struct cutting *s, int output)
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
	int best = -1, body = f->dim_count >= s->from ? body_of(s, output) : -1;

	for (body = body >= 0 ? t->bodies[body].parent : -1; body >= 0; body = t->bodies[body].parent)
		if (dims_left(s, f, output, t->bodies[body].number) <= LIMB_DIMS)
			best = body;
	return best;
}

/* Is node i cut through, and so read as an input? */
static int find(const uint32_t *list, int count, uint32_t node)
{
	for (int k = 0; k < count; k++)
		if (list[k] == node)
			return k;
	return -1;
}

/* What the outputs of these fields read, and the nodes in `also`, up to leaves. */
static void mark_live(const struct cutting *s, int body, const uint32_t *also, int count, const uint32_t *leaves, int leaf_count)
{
	memset(s->live, 0, s->d->count);
	for (size_t o = 0; o < s->d->output_count; o++)
		if (s->body[o] == body)
			s->live[s->d->outputs[o].value.i] = 1;
	for (int k = 0; k < count; k++)
		s->live[also[k]] = 1;
	for (size_t i = s->d->count; i-- > 0;)
		for (int k = 0; k < op_arity[s->d->nodes[i].op] && s->live[i] && find(leaves, leaf_count, (uint32_t)i) < 0; k++)
			s->live[s->d->nodes[i].arg[k].i] = 1;
}

/* ---- how it moves ---- */

static int list_leaves(const struct cutting *s, int body, uint32_t *leaves)
{
	int count = 0;

	for (uint32_t i = 0; i < s->d->count; i++)
		if (is_leaf(s->d, i, s->r->view.tree.bodies[body].number)) {
			if (count == MOST_LEAVES)
				return -1;
			leaves[count++] = i;
		}
	return count;
}

/* Of the leaves as outputs. Returns 0 when memory runs out, or nothing is known. */
static int find_ranges(const struct cutting *s, const uint32_t *leaves, int count, struct interval *ranges)
{
	struct relaxed *r = arena_alloc(s->a, 1, sizeof *r);
	struct output *outputs = arena_alloc(s->a, (size_t)count + 1, sizeof *outputs);
	struct rneagen_error e = {0};
	struct field *fields;
	struct box box;
	int n;

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

		if (!magnitude_find(of, &fields[k], &box, 0, s->x, s->seconds / (double)n))
			return 0;
		for (int o = 0; o < fields[k].output_count; o++)
			ranges[fields[k].outputs[o]] =
				(struct interval){fmax(of[o].lower, -fields[k].plain[o]), fmin(of[o].upper, fields[k].plain[o])};
	}
	return 1;
}

/* ---- a part with inputs of its own ---- */

struct copying {
	const struct cutting *s;
	const uint32_t *leaves;
	int count, rates, drives; /* leaves; arguments */
	struct ref *map;
};

static struct ref copy(void *context, struct dag *out, size_t i)
{
	const struct copying *c = context;
	const struct node *n = &c->s->d->nodes[i];
	struct ref arg[3] = {{0}};
	int leaf;

	if (i == 0 || !c->s->live[i])
		return (struct ref){0};
	leaf = find(c->leaves, c->count, (uint32_t)i);
	if (leaf >= 0)
		return dag_input(out, strcmp(n->tag.quantity, "w") ? c->drives : c->rates, leaf);
	if (op_arity[n->op] == 0)
		return dag_copy_leaf(out, c->s->d, i);
	for (int k = 0; k < op_arity[n->op]; k++)
		arg[k] = c->map[n->arg[k].i];
	return dag_node(out, n->op, arg[0], arg[1], arg[2], 0);
}

/* Those of the fields, and wrenches. */
static int list_outputs(const struct cutting *s, struct cut *c, struct dag *from)
{
	size_t most = s->d->output_count + (size_t)c->wrench_count + 1;
	struct output *outputs = arena_alloc(s->a, most, sizeof *outputs);

	c->outputs = arena_alloc(s->a, most, sizeof *c->outputs);
	from->output_count = 0;
	if (!outputs || !c->outputs)
		return 0;
	for (size_t o = 0; o < s->d->output_count; o++)
		if (s->body[o] == c->body) {
			c->outputs[from->output_count] = (int)o;
			outputs[from->output_count++] = s->d->outputs[o];
		}
	for (int k = 0; k < c->wrench_count; k++) {
		c->outputs[from->output_count] = (int)s->d->output_count + k;
		outputs[from->output_count++] = (struct output){s->d->outputs[0].argument, k, {c->wrenches[k]}};
	}
	from->outputs = outputs;
	return 1;
}

/* Returns 0 when memory runs out, or it cannot be cut. */
static int cut_off(const struct cutting *s, struct cut *c, const uint32_t *leaves, int count, const struct interval *ranges)
{
	struct dag from = *s->d;
	struct copying of = {.s = s, .leaves = leaves, .count = count, .map = arena_alloc(s->a, s->d->count, sizeof *of.map)};
	struct rneagen_error e = {0};

	mark_live(s, c->body, c->wrenches, c->wrench_count, leaves, count);
	if (count <= 0 || !of.map || from.argument_count + 2 > DAG_ARGUMENTS || !list_outputs(s, c, &from))
		return 0;
	if (!(c->leaves = arena_alloc(s->a, (size_t)count, sizeof *c->leaves)))
		return 0;
	memcpy(c->leaves, leaves, (size_t)count * sizeof *leaves);
	c->leaf_count = count;
	of.rates = from.argument_count++;
	of.drives = from.argument_count++;
	from.arguments[of.rates] = (struct argument){.name = "limb_rates", .rows = count, .role = ROLE_JOINT_VELOCITY};
	from.arguments[of.drives] = (struct argument){.name = "limb_drives", .rows = count, .role = ROLE_JOINT_ACCELERATION};
	from.section_count = 0;
	c->relaxed = *s->r;
	dag_init(&c->relaxed.view.dag, s->a);
	dag_copy(&c->relaxed.view.dag, &from, of.map, copy, &of);
	for (int i = of.rates; i <= of.drives; i++) {
		c->relaxed.rows[i] = arena_alloc(s->a, (size_t)count, sizeof **c->relaxed.rows);
		for (int k = 0; k < count && c->relaxed.rows[i]; k++)
			c->relaxed.rows[i][k] = ranges[k];
	}
	memcpy(c->box.rows, c->relaxed.rows, sizeof c->box.rows);
	c->field_count = s->a->failed || c->relaxed.view.dag.failed ? -1 : field_split(&c->fields, &c->relaxed, s->a, &e);
	return c->field_count >= 0;
}

/* Force and moment of the limbs that the body carries: of values with the same name the last, which has all in it. */
static int list_wrenches(const struct cutting *s, struct cut *c)
{
	const struct tree *t = &s->r->view.tree;

	c->wrenches = arena_alloc(s->a, 6 * (size_t)t->body_count, sizeof *c->wrenches);
	for (int b = 0; b < t->body_count && c->wrenches; b++)
		for (int k = 0; k < 6 && t->bodies[b].parent == c->body; k++)
			for (uint32_t i = (uint32_t)s->d->count; i-- > 0;) {
				const struct tag *tag = &s->d->nodes[i].tag;

				if (op_arity[s->d->nodes[i].op] && tag->body == t->bodies[b].number && tag->component == "xyz"[k % 3] &&
					!strcmp(tag->quantity, k < 3 ? "f" : "n")) {
					c->wrenches[c->wrench_count++] = i;
					break;
				}
			}
	return c->wrenches != NULL;
}

static struct cutting cutting_of(const struct relaxed *r, const struct field *fields, int field_count, struct arena *a)
{
	struct cutting s = {.r = r, .d = &r->view.dag, .fields = fields, .field_count = field_count, .a = a,
		.body = arena_alloc(a, r->view.dag.output_count + 1, sizeof(int)), .dims = arena_alloc(a, r->view.dag.count, sizeof(uint64_t)),
		.live = arena_alloc(a, r->view.dag.count, 1)};

	for (size_t o = 0; o < r->view.dag.output_count && !a->failed; o++)
		s.body[o] = -1;
	return s;
}

static int limb(const struct cutting *s, struct cut *c, int body)
{
	uint32_t leaves[MOST_LEAVES];
	struct interval ranges[MOST_LEAVES];
	int count = list_leaves(s, body, leaves);

	*c = (struct cut){.body = body};
	return count > 0 && list_wrenches(s, c) && find_ranges(s, leaves, count, ranges) && cut_off(s, c, leaves, count, ranges);
}

int cut_make(struct cut **cuts, const struct relaxed *r, const struct field *fields, int field_count, int from,
	const struct effort *x, double seconds, struct arena *a)
{
	struct cutting s = cutting_of(r, fields, field_count, a);
	int count = 0;

	s.from = from;
	s.x = x;
	s.seconds = seconds;
	*cuts = arena_alloc(a, s.d->output_count + 1, sizeof **cuts);
	if (a->failed)
		return -1;
	for (int k = 0; k < field_count; k++)
		for (int o = 0; o < fields[k].output_count; o++)
			s.body[fields[k].outputs[o]] = choose(&s, &fields[k], fields[k].outputs[o]);
	for (size_t o = 0; o < s.d->output_count; o++) {
		int known = s.body[o] < 0;

		for (size_t l = 0; l < o; l++)
			known |= s.body[l] == s.body[o];
		if (!known && limb(&s, &(*cuts)[count], s.body[o]))
			count++;
	}
	return a->failed ? -1 : count;
}

int cut_has(const struct cut *cuts, int count, int output)
{
	for (int i = 0; i < count; i++)
		for (size_t k = 0; k < cuts[i].relaxed.view.dag.output_count; k++)
			if (cuts[i].outputs[k] == output)
				return 1;
	return 0;
}

int cut_rest(struct cut *rest, const struct relaxed *r, const struct field *fields, int field_count, int from,
	const struct cut *cuts, int cut_count, struct interval *const *ranges, struct arena *a)
{
	struct cutting s = cutting_of(r, fields, field_count, a);
	uint32_t leaves[6 * MOST_LEAVES];
	struct interval of[6 * MOST_LEAVES];
	int count = 0, some = -1;

	*rest = (struct cut){.body = 0};
	if (a->failed)
		return -1;
	for (int k = 0; k < field_count; k++)
		for (int o = 0; o < fields[k].output_count; o++)
			if (fields[k].dim_count >= from && !cut_has(cuts, cut_count, fields[k].outputs[o]))
				s.body[fields[k].outputs[o]] = some = 0;
	for (int i = 0; i < cut_count; i++)
		for (int k = 0; k < cuts[i].wrench_count && count < 6 * MOST_LEAVES; k++) {
			leaves[count] = cuts[i].wrenches[k];
			of[count++] = ranges[i][k];
		}
	return some == 0 && cut_off(&s, rest, leaves, count, of) ? 1 : a->failed ? -1 : 0;
}
