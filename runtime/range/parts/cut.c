#include "range/parts/cut.h"
#include "range/parts/cutting.h"
#include <string.h>

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
		for (int k = 0; k < op_arity[s->d->nodes[i].op] && s->live[i] && dag_place(leaves, leaf_count, (uint32_t)i) < 0; k++)
			s->live[s->d->nodes[i].arg[k].i] = 1;
}

/* ---- a part with inputs of its own ---- */

struct copying {
	const struct cutting *s;
	const uint32_t *leaves;
	int count, rates, drives; /* leaves; arguments */
	const struct cut *cuts;   /* whose loads are drives */
	int cut_count;
	struct ref *map;
};

static struct ref operation(const struct copying *c, struct dag *out, const struct node *n)
{
	struct ref arg[3] = {{0}};

	for (int k = 0; k < op_arity[n->op]; k++)
		arg[k] = c->map[n->arg[k].i];
	if (n->op == OP_FMA && (!arg[0].i || !arg[1].i)) /* without limbs much is 0 */
		return arg[2];
	return dag_operation(out, n->op, arg[0], arg[1], arg[2]);
}

/* Force and moment without their limbs, and loads in their place. */
static struct ref with_loads(const struct copying *c, struct dag *out, uint32_t i, struct ref value)
{
	int row = 0;

	for (const struct cut *of = c->cuts; of < c->cuts + c->cut_count; of++) {
		int total = loads_total(&of->loads, i), n = of->loads.total_count;

		for (int limb = 0; limb < of->loads.limb_count && total >= 0; limb++)
			value = dag_add(out, value, dag_input(out, c->drives, row + limb * n + total));
		row += of->load_count;
	}
	return value;
}

static int is_wrench(const struct copying *c, uint32_t i)
{
	for (int k = 0; k < c->cut_count; k++)
		if (loads_is_wrench(&c->cuts[k].loads, i))
			return 1;
	return 0;
}

static struct ref copy(void *context, struct dag *out, size_t i)
{
	const struct copying *c = context;
	const struct node *n = &c->s->d->nodes[i];
	int leaf;

	if (i == 0 || !c->s->live[i] || is_wrench(c, (uint32_t)i))
		return (struct ref){0};
	leaf = dag_place(c->leaves, c->count, (uint32_t)i);
	if (leaf >= 0)
		return dag_input(out, strcmp(n->tag.quantity, "w") ? c->drives : c->rates, leaf);
	if (op_arity[n->op] == 0)
		return dag_copy_leaf(out, c->s->d, i);
	return with_loads(c, out, (uint32_t)i, operation(c, out, n));
}

/* Those that are cut off here. */
static int list_outputs(const struct cutting *s, struct cut *c, struct dag *from)
{
	struct output *outputs = arena_alloc(s->a, s->d->output_count + 1, sizeof *outputs);

	c->outputs = arena_alloc(s->a, s->d->output_count + (size_t)c->load_count + 1, sizeof *c->outputs);
	from->output_count = 0;
	if (!outputs || !c->outputs)
		return 0;
	for (size_t o = 0; o < s->d->output_count; o++)
		if (s->body[o] == c->body) {
			c->outputs[from->output_count] = (int)o;
			outputs[from->output_count++] = s->d->outputs[o];
		}
	from->outputs = outputs;
	return 1;
}

static int add_loads(const struct cutting *s, struct cut *c, const struct ref *map)
{
	struct dag *out = &c->relaxed.view.dag;
	int n = c->loads.total_count;

	for (int limb = 0; limb < c->loads.limb_count; limb++) {
		struct ref load[LOADS_WRENCH];

		if (!loads_put(load, &c->loads, limb, s->d, out, map, s->a))
			return 0;
		for (int k = 0; k < n; k++) {
			c->outputs[out->output_count] = (int)s->d->output_count + limb * n + k;
			dag_output(out, out->argument_count - 3, limb * n + k, load[k]);
		}
	}
	return !out->failed;
}

/* Of gravity alone the degree in an angle is less, as field_split knows. */
static enum role role_of_loads(const struct dag *d)
{
	for (size_t o = 0; o < d->output_count; o++)
		if (d->arguments[d->outputs[o].argument].role != ROLE_GRAVITY_TORQUE)
			return ROLE_JOINT_TORQUE;
	return ROLE_GRAVITY_TORQUE;
}

/* Outputs for loads, so that these have fields of their own, and two more inputs, of so many rows. */
static int declare(struct copying *c, struct dag *from, int rows)
{
	if (from->argument_count + 3 > DAG_ARGUMENTS)
		return 0;
	from->arguments[from->argument_count++] =
		(struct argument){.name = "loads", .rows = LOADS_LIMBS * LOADS_WRENCH, .is_output = 1, .role = role_of_loads(from)};
	c->rates = from->argument_count++;
	c->drives = from->argument_count++;
	from->arguments[c->rates] = (struct argument){.name = "limb_rates", .rows = rows, .role = ROLE_JOINT_VELOCITY};
	from->arguments[c->drives] = (struct argument){.name = "limb_drives", .rows = rows, .role = ROLE_JOINT_ACCELERATION};
	from->section_count = 0;
	return 1;
}

static void take_ranges(const struct cutting *s, struct cut *c, int argument, const struct interval *ranges, int rows)
{
	c->relaxed.rows[argument] = arena_alloc(s->a, (size_t)rows + 1, sizeof **c->relaxed.rows);
	for (int k = 0; k < rows && c->relaxed.rows[argument]; k++)
		c->relaxed.rows[argument][k] = ranges[k];
}

/* Returns 0 when memory runs out, or it cannot be cut. */
static int cut_off(const struct cutting *s, struct cut *c, struct copying *of, const struct interval *ranges, int rows)
{
	struct dag from = *s->d;
	struct rneagen_error e = {0};

	of->s = s;
	of->map = arena_alloc(s->a, s->d->count, sizeof *of->map);
	if (!of->map || !declare(of, &from, rows) || !list_outputs(s, c, &from))
		return 0;
	c->relaxed = *s->r;
	dag_init(&c->relaxed.view.dag, s->a);
	dag_copy(&c->relaxed.view.dag, &from, of->map, copy, of);
	if (c->load_count && !add_loads(s, c, of->map))
		return 0;
	take_ranges(s, c, of->rates, ranges, rows);
	take_ranges(s, c, of->drives, ranges, rows);
	memcpy(c->box.rows, c->relaxed.rows, sizeof c->box.rows);
	c->field_count = s->a->failed || c->relaxed.view.dag.failed ? -1 : field_split(&c->fields, &c->relaxed, s->a, &e);
	return c->field_count > 0;
}

/* Of small limbs that have some of its outputs, and of whole ones where it carries them for others. Where force and moment are no
   sums of loads there are none. */
static void find_loads(const struct cutting *s, struct cut *c)
{
	const struct tree *t = &s->r->view.tree;
	unsigned char *is_limb = arena_alloc(s->a, (size_t)t->body_count, 1);

	for (size_t o = 0; o < s->d->output_count && is_limb; o++)
		for (int b = s->body[o] == c->body ? cutting_body(s, (int)o) : -1; b >= 0; b = t->bodies[b].parent)
			is_limb[b] = 1;
	for (int b = 0; b < t->body_count && is_limb; b++)
		is_limb[b] = t->bodies[b].parent == c->body && cutting_is_small(s, b) &&
			(is_limb[b] || (s->carries[c->body] && cutting_is_whole(s, b)));
	if (!is_limb || !loads_find(&c->loads, s->d, t, c->body, is_limb, s->a))
		c->loads = (struct loads){0};
	c->load_count = c->loads.limb_count * c->loads.total_count;
}

int cut_differs(const struct relaxed *r, const struct field *fields, int field_count, int from, int dims, int others,
	struct arena *a)
{
	struct cutting s = cutting_of(r, fields, field_count, a), other = cutting_of(r, fields, field_count, a);

	if (a->failed)
		return -1;
	s.from = other.from = from;
	s.dims = dims;
	other.dims = others;
	cutting_choose(&s);
	cutting_choose(&other);
	return memcmp(s.body, other.body, s.d->output_count * sizeof *s.body) ||
	       memcmp(s.carries, other.carries, (size_t)r->view.tree.body_count);
}

/* How a floating base moves depends on no row of q, but for its own: nothing is cut there. */
static int limb(const struct cutting *s, struct cut *c, int body)
{
	const struct tree *t = &s->r->view.tree;
	int is_base = t->floating && t->bodies[body].parent < 0;
	struct interval ranges[MOST_LEAVES];
	struct copying of;

	*c = (struct cut){.body = body};
	if (!(c->leaves = arena_alloc(s->a, MOST_LEAVES, sizeof *c->leaves)))
		return 0;
	c->leaf_count = is_base ? 0 : cutting_leaves(s, body, c->leaves);
	if (!is_base && (c->leaf_count <= 0 || !cutting_ranges(s, c->leaves, c->leaf_count, ranges)))
		return 0;
	find_loads(s, c);
	mark_live(s, body, c->loads.totals, c->loads.total_count, c->leaves, c->leaf_count);
	of = (struct copying){.leaves = c->leaves, .count = c->leaf_count};
	return cut_off(s, c, &of, ranges, c->leaf_count);
}

int cut_make(struct cut **cuts, const struct relaxed *r, const struct field *fields, int field_count, int from, int dims,
	const struct effort *x, double seconds, struct arena *a)
{
	struct cutting s = cutting_of(r, fields, field_count, a);
	int count = 0;

	s.from = from;
	s.dims = dims;
	s.x = x;
	s.seconds = seconds;
	*cuts = arena_alloc(a, (size_t)r->view.tree.body_count + 1, sizeof **cuts);
	if (a->failed)
		return -1;
	cutting_choose(&s);
	for (int b = 0; b < r->view.tree.body_count; b++) {
		int is_cut = s.carries[b];

		for (size_t o = 0; o < s.d->output_count; o++)
			is_cut |= s.body[o] == b;
		if (is_cut && limb(&s, &(*cuts)[count], b))
			count++;
	}
	return a->failed ? -1 : count;
}

/* Is an output, by its number in what was cut, of a limb? */
static int is_of_limb(const struct cut *cuts, int count, int output)
{
	for (int i = 0; i < count; i++)
		for (size_t k = 0; k < cuts[i].relaxed.view.dag.output_count; k++)
			if (cuts[i].outputs[k] == output)
				return 1;
	return 0;
}

int cut_has_torques(const struct cut *cuts, int count)
{
	for (int i = 0; i < count; i++)
		if ((int)cuts[i].relaxed.view.dag.output_count > cuts[i].load_count)
			return 1;
	return 0;
}

/* Does an output read the limbs through their loads alone? */
static int is_closed(const struct cutting *s, size_t output, const struct cut *cuts, int count)
{
	for (int i = 0; i < count; i++) {
		memset(s->live, 0, s->d->count);
		s->live[s->d->outputs[output].value.i] = 1;
		if (!loads_are_closed(&cuts[i].loads, s->d, s->live))
			return 0;
	}
	return 1;
}

int cut_rest(struct cut *rest, const struct relaxed *r, const struct field *fields, int field_count, int from,
	const struct cut *cuts, int cut_count, struct interval *const *ranges, struct arena *a)
{
	struct cutting s = cutting_of(r, fields, field_count, a);
	struct copying of = {.cuts = cuts, .cut_count = cut_count};
	struct interval loads[LOADS_LIMBS * MOST_LEAVES];
	int count = 0, some = 0;

	*rest = (struct cut){.body = 0};
	if (a->failed)
		return -1;
	for (int k = 0; k < field_count; k++)
		for (int o = 0; o < fields[k].output_count && fields[k].dim_count >= from; o++) {
			int output = fields[k].outputs[o];

			if (!is_of_limb(cuts, cut_count, output) && is_closed(&s, (size_t)output, cuts, cut_count))
				s.body[output] = 0;
			some += s.body[output] == 0;
		}
	for (int i = 0; i < cut_count; i++)
		for (int k = 0; k < cuts[i].load_count; k++)
			if (count < (int)(sizeof loads / sizeof *loads))
				loads[count++] = ranges[i][k];
			else
				return 0;
	if (!some || !count)
		return 0;
	mark_live(&s, 0, NULL, 0, NULL, 0);
	return cut_off(&s, rest, &of, loads, count) ? 1 : a->failed ? -1 : 0;
}
