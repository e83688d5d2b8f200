#include "range/cut.h"
#include "range/magnitude.h"
#include <math.h>
#include <string.h>

/* Of so many rows of q grids are close, and from so many on a cut is looked for. */
enum { LIMB_DIMS = 7, CUT_FROM = 9, MOST_LEAVES = 16 };

struct cutting {
	const struct relaxed *r;
	const struct dag *d;
	const struct field *fields;
	int field_count;
	const struct effort *x;
	double seconds;
	struct arena *a;
	int *body;       /* by field; -1: it is not cut */
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

static int dims_left(const struct cutting *s, const struct field *f, int number)
{
	int position = dag_find_role(s->d, ROLE_JOINT_POSITION, 0), count = 0;
	uint64_t all = 0;

	for (uint32_t i = 0; i < s->d->count; i++) {
		const struct node *n = &s->d->nodes[i];

		s->dims[i] = n->op == OP_INPUT && (int)n->arg[0].i == position ? bit_of(f, (int)n->arg[1].i) : 0;
		for (int k = 0; k < op_arity[n->op] && !is_leaf(s->d, i, number); k++)
			s->dims[i] |= s->dims[n->arg[k].i];
	}
	for (int o = 0; o < f->output_count; o++)
		all |= s->dims[s->d->outputs[f->outputs[o]].value.i];
	for (; all; all &= all - 1)
		count++;
	return count;
}

static int body_of(const struct cutting *s, const struct field *f)
{
	const struct output *o = &s->d->outputs[f->outputs[0]];
	const struct tree *t = &s->r->view.tree;
	enum role role = s->d->arguments[o->argument].role;

	for (int i = 0; i < t->joint_count && (role == ROLE_JOINT_TORQUE || role == ROLE_BIAS_TORQUE || role == ROLE_GRAVITY_TORQUE); i++)
		if (o->row >= t->joints[i].iv && o->row < t->joints[i].iv + t->joints[i].nv)
			return t->joints[i].body;
	return -1;
}

/* The body nearest the ground that leaves few enough. */
static int choose(const struct cutting *s, const struct field *f)
{
	const struct tree *t = &s->r->view.tree;
	int best = -1, body = f->dim_count >= CUT_FROM ? body_of(s, f) : -1;

	for (body = body >= 0 ? t->bodies[body].parent : -1; body >= 0; body = t->bodies[body].parent)
		if (dims_left(s, f, t->bodies[body].number) <= LIMB_DIMS)
			best = body;
	return best;
}

/* ---- how it moves ---- */

static void mark_live(const struct cutting *s, int body)
{
	memset(s->live, 0, s->d->count);
	for (int k = 0; k < s->field_count; k++)
		for (int o = 0; o < s->fields[k].output_count && s->body[k] == body; o++)
			s->live[s->d->outputs[s->fields[k].outputs[o]].value.i] = 1;
	for (size_t i = s->d->count; i-- > 0;)
		for (int k = 0; k < op_arity[s->d->nodes[i].op] && s->live[i] && !is_leaf(s->d, (uint32_t)i, s->r->view.tree.bodies[body].number); k++)
			s->live[s->d->nodes[i].arg[k].i] = 1;
}

static int list_leaves(const struct cutting *s, int body, uint32_t *leaves)
{
	int count = 0;

	for (uint32_t i = 0; i < s->d->count; i++)
		if (s->live[i] && is_leaf(s->d, i, s->r->view.tree.bodies[body].number)) {
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
			ranges[fields[k].outputs[o]] = (struct interval){fmax(of[o].lower, -fields[k].plain[o]), fmin(of[o].upper, fields[k].plain[o])};
	}
	return 1;
}

/* ---- the limb ---- */

struct copying {
	const struct cutting *s;
	const uint32_t *leaves;
	int count, rates, drives; /* leaves; arguments */
	struct ref *map;
};

static int is_rate(const struct dag *d, uint32_t i)
{
	return !strcmp(d->nodes[i].tag.quantity, "w");
}

static struct ref copy(void *context, struct dag *out, size_t i)
{
	const struct copying *c = context;
	const struct node *n = &c->s->d->nodes[i];
	struct ref arg[3] = {{0}};

	if (i == 0 || !c->s->live[i])
		return (struct ref){0};
	for (int k = 0; k < c->count; k++)
		if (c->leaves[k] == i)
			return dag_input(out, is_rate(c->s->d, (uint32_t)i) ? c->rates : c->drives, k);
	if (op_arity[n->op] == 0)
		return dag_copy_leaf(out, c->s->d, i);
	for (int k = 0; k < op_arity[n->op]; k++)
		arg[k] = c->map[n->arg[k].i];
	return dag_node(out, n->op, arg[0], arg[1], arg[2], 0);
}

static int list_outputs(const struct cutting *s, struct cut *c, struct dag *from)
{
	struct output *outputs = arena_alloc(s->a, s->d->output_count + 1, sizeof *outputs);

	c->outputs = arena_alloc(s->a, s->d->output_count + 1, sizeof *c->outputs);
	from->output_count = 0;
	for (int k = 0; k < s->field_count && outputs && c->outputs; k++)
		for (int o = 0; o < s->fields[k].output_count && s->body[k] == c->body; o++) {
			c->outputs[from->output_count] = s->fields[k].outputs[o];
			outputs[from->output_count++] = s->d->outputs[s->fields[k].outputs[o]];
		}
	from->outputs = outputs;
	return !s->a->failed;
}

/* Returns 0 when memory runs out, or it cannot be cut. */
static int cut_off(const struct cutting *s, struct cut *c)
{
	uint32_t leaves[MOST_LEAVES];
	struct interval ranges[MOST_LEAVES];
	struct dag from = *s->d;
	struct copying of = {.s = s, .leaves = leaves, .map = arena_alloc(s->a, s->d->count, sizeof *of.map)};
	struct rneagen_error e = {0};

	mark_live(s, c->body);
	of.count = list_leaves(s, c->body, leaves);
	if (of.count <= 0 || !of.map || from.argument_count + 2 > DAG_ARGUMENTS || !find_ranges(s, leaves, of.count, ranges) || !list_outputs(s, c, &from))
		return 0;
	of.rates = from.argument_count++;
	of.drives = from.argument_count++;
	from.arguments[of.rates] = (struct argument){.name = "limb_rates", .rows = of.count, .role = ROLE_JOINT_VELOCITY};
	from.arguments[of.drives] = (struct argument){.name = "limb_drives", .rows = of.count, .role = ROLE_JOINT_ACCELERATION};
	from.section_count = 0;
	c->relaxed = *s->r;
	dag_init(&c->relaxed.view.dag, s->a);
	dag_copy(&c->relaxed.view.dag, &from, of.map, copy, &of);
	for (int i = of.rates; i <= of.drives; i++) {
		c->relaxed.rows[i] = arena_alloc(s->a, (size_t)of.count, sizeof **c->relaxed.rows);
		for (int k = 0; k < of.count && c->relaxed.rows[i]; k++)
			c->relaxed.rows[i][k] = ranges[k];
	}
	memcpy(c->box.rows, c->relaxed.rows, sizeof c->box.rows);
	c->field_count = s->a->failed || c->relaxed.view.dag.failed ? -1 : field_split(&c->fields, &c->relaxed, s->a, &e);
	return c->field_count >= 0;
}

int cut_make(struct cut **cuts, const struct relaxed *r, const struct field *fields, int field_count, const struct effort *x,
	double seconds, struct arena *a)
{
	struct cutting s = {.r = r, .d = &r->view.dag, .fields = fields, .field_count = field_count, .x = x, .seconds = seconds, .a = a,
		.body = arena_alloc(a, (size_t)field_count + 1, sizeof *s.body), .dims = arena_alloc(a, r->view.dag.count, sizeof *s.dims),
		.live = arena_alloc(a, r->view.dag.count, 1)};
	int count = 0;

	*cuts = arena_alloc(a, (size_t)field_count + 1, sizeof **cuts);
	if (a->failed)
		return -1;
	for (int k = 0; k < field_count; k++)
		s.body[k] = choose(&s, &fields[k]);
	for (int k = 0; k < field_count; k++) {
		int known = s.body[k] < 0;

		for (int l = 0; l < k; l++)
			known |= s.body[l] == s.body[k];
		(*cuts)[count].body = s.body[k];
		if (!known && cut_off(&s, &(*cuts)[count]))
			count++;
	}
	return a->failed ? -1 : count;
}
