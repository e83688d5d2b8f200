#include "plan/plan.h"
#include "plan/readings.h"
#include <stdio.h>
#include <string.h>

/* Operations in one expression; more, and an operand gets a line of its own. */
enum { LONGEST_EXPRESSION = 5 };

struct planner {
	struct plan *p;
	const struct dag *d;
	struct arena *a;
	uint32_t *uses;
	unsigned char *named, *weight; /* weight: operations written in the node's own expression */
	const int *reach;              /* of readings_reach; NULL: lines are as long as they may be */
	char **taken;                  /* hash set of names */
	size_t taken_size;
};

static int is_leaf(const struct planner *b, struct ref a)
{
	return b->named[a.i] || b->d->nodes[a.i].op == OP_CONST;
}

/* A value gets a line if it is an input, a sine or cosine, named by the algorithm, or used twice. A sign alone never
   does, unless what it negates would be written twice. */
static int deserves_line(const struct planner *b, size_t i)
{
	const struct node *n = &b->d->nodes[i];

	if (n->op == OP_CONST || n->op == OP_PAIR)
		return 0;
	if (n->op == OP_INPUT || n->op == OP_SIN || n->op == OP_COS || (b->d->is_each && n->op >= OP_LANE0))
		return 1;
	if (n->op == OP_NEG && is_leaf(b, n->arg[0]))
		return 0;
	return n->tag.quantity[0] != 0 || b->uses[i] > 1;
}

/* Weigh the expression at node i; while it is too long, name its heaviest operand. */
static void weigh(struct planner *b, size_t i)
{
	const struct node *n = &b->d->nodes[i];

	for (;;) {
		int total = 1, heaviest = -1, most = 0;

		for (int k = 0; k < op_arity[n->op]; k++) {
			uint32_t a = n->arg[k].i;
			int weight = b->named[a] ? 0 : b->weight[a];

			total += weight;
			if (weight > most) {
				most = weight;
				heaviest = k;
			}
		}
		if (total <= LONGEST_EXPRESSION || heaviest < 0) {
			b->weight[i] = (unsigned char)(op_arity[n->op] && n->op != OP_PAIR ? total : 0);
			return;
		}
		b->named[n->arg[heaviest].i] = 1;
	}
}

/* What coordinates share on their way back to the base is made before the loops, but for signs. */
static void name_shared(struct planner *b, const struct node *n, size_t loops)
{
	for (int k = 0; k < op_arity[n->op]; k++) {
		uint32_t i = dag_bare(b->d, n->arg[k].i, NULL);

		if (i < loops && b->d->nodes[i].op != OP_CONST)
			b->named[i] = 1;
	}
}

/* What lanes are made of, and what has lanes, have names; so has a lane that a loop reads. */
static void name_parts(struct planner *b, const struct node *n, int is_in_loop)
{
	int has_parts = n->op == OP_PAIR || n->op == OP_PACK || n->op >= OP_LANE0;

	for (int k = 0; k < op_arity[n->op]; k++) {
		enum op op = b->d->nodes[n->arg[k].i].op;

		if (op != OP_CONST && op != OP_PAIR && (has_parts || (is_in_loop && op >= OP_LANE0)))
			b->named[n->arg[k].i] = 1;
	}
}

/* What the inputs of earlier joints are enough for is made when these are there. */
static void name_earlier(struct planner *b, size_t i)
{
	const struct node *n = &b->d->nodes[i];

	for (int k = 0; k < op_arity[n->op]; k++) {
		uint32_t bare = dag_bare(b->d, n->arg[k].i, NULL);

		if (op_arity[b->d->nodes[bare].op] && b->reach[bare] >= 0 && b->reach[bare] < b->reach[i])
			b->named[bare] = 1;
	}
}

static void choose_lines(struct planner *b)
{
	size_t loops = dag_loops_begin(b->d);

	for (size_t i = 0; i < b->d->count; i++) {
		if (!b->uses[i])
			continue;
		if (b->reach)
			name_earlier(b, i);
		weigh(b, i);
		name_parts(b, &b->d->nodes[i], i >= loops);
		if (i >= loops && dag_loops_go_back(b->d))
			name_shared(b, &b->d->nodes[i], loops);
		b->named[i] = (unsigned char)deserves_line(b, i);
	}
}

/* Rows of the joints: q2, or q0x ... q0qw for a floating joint and q3x q3y q3t for a planar one. */
static void name_joint_row(const struct body *k, const char *argument, int row, int is_q, char *name, size_t size)
{
	static const char *const floating_q[] = {"x", "y", "z", "qx", "qy", "qz", "qw"};
	static const char *const floating_v[] = {"vx", "vy", "vz", "wx", "wy", "wz"};
	static const char *const planar[] = {"x", "y", "t"};
	const char *part = "";

	if (k->type == JOINT_FLOATING)
		part = is_q ? floating_q[row] : floating_v[row];
	else if (k->type == JOINT_PLANAR)
		part = planar[row];
	snprintf(name, size, "%s%d%s", argument, k->number, part);
}

/* Rows of what is neither of joints nor of bodies: vectors, wrenches and inertias have names, others numbers. */
static void name_other(const struct argument *a, int row, char *name, size_t size)
{
	static const char *const vector[] = {"x", "y", "z"}, *const wrench[] = {"fx", "fy", "fz", "nx", "ny", "nz"};
	static const char *const inertia[] = {"m", "hx", "hy", "hz", "Ixx", "Ixy", "Ixz", "Iyy", "Iyz", "Izz"};
	static const char *const *const parts[] = {[ROWS_VECTOR] = vector, [ROWS_WRENCH] = wrench, [ROWS_INERTIA] = inertia};
	enum role_rows rows = role_rows(a->role);

	if (parts[rows])
		snprintf(name, size, "%.40s_%s", a->name, parts[rows][row]);
	else
		snprintf(name, size, "%.40s_%d", a->name, row);
}

static void name_input(const struct planner *b, const struct node *n, char *name, size_t size)
{
	const struct tree *t = b->p->tree;
	const struct argument *a = &b->d->arguments[n->arg[0].i];
	const struct tree_joint *j;
	int row = (int)n->arg[1].i, is_q = role_rows(a->role) == ROWS_NQ;

	if (a->role == ROLE_BODY_WRENCHES) {
		snprintf(name, size, "own_%s%d%c", row % 6 < 3 ? "f" : "n", t->bodies[row / 6].number, "xyz"[row % 3]);
		return;
	}
	if (!is_q && role_rows(a->role) != ROWS_NV) {
		name_other(a, row, name, size);
		return;
	}
	j = is_q ? tree_joint_of_q(t, row) : tree_joint_of_row(t, row);
	name_joint_row(&t->bodies[j->body], a->name, row - (is_q ? j->iq : j->iv), is_q, name, size);
}

/* A copy of the name if it is new; else NULL. */
static const char *take(struct planner *b, const char *name)
{
	size_t h = 5381;

	for (const char *s = name; *s; s++)
		h = h * 33 + (unsigned char)*s;
	for (h %= b->taken_size; b->taken[h]; h = (h + 1) % b->taken_size)
		if (!strcmp(b->taken[h], name))
			return NULL;
	return b->taken[h] = arena_string(b->a, name, strlen(name));
}

/* A sum that grows as children return keeps its name and counts: f1x, f1x_2, f1x_3. */
static const char *name_value(struct planner *b, size_t i, unsigned *temporaries)
{
	const struct node *n = &b->d->nodes[i];
	char first[64] = "", name[80];
	const char *taken;

	if (n->op == OP_INPUT && !(n->tag.quantity[0] && b->d->arguments[n->arg[0].i].is_output)) /* else an earlier kernel's value */
		name_input(b, n, first, sizeof first);
	else if (n->op == OP_WIDEN && b->p->names[n->arg[0].i])
		snprintf(first, sizeof first, "%.55s_wide", b->p->names[n->arg[0].i]);
	else if (n->is_wide && !b->d->is_each && n->tag.quantity[0])
		snprintf(first, sizeof first, "%s%d%.1s_wide", n->tag.quantity, n->tag.body, &n->tag.component);
	else if (n->tag.quantity[0])
		snprintf(first, sizeof first, "%s%d%.1s", n->tag.quantity, n->tag.body, &n->tag.component);
	else
		snprintf(first, sizeof first, "t%u", ++*temporaries);
	snprintf(name, sizeof name, "%s", first);
	for (int again = 2; !(taken = take(b, name)) && !b->a->failed; again++)
		snprintf(name, sizeof name, "%s_%d", first, again);
	return taken;
}

void plan_add_line(struct plan *p, enum line_kind kind, struct ref value, size_t index)
{
	p->lines[p->line_count++] = (struct line){kind, value, index};
}

static void add_value(struct planner *b, size_t i)
{
	struct ref me = {(uint32_t)i}, partner;
	enum op op = b->d->nodes[i].op;

	if (op == OP_SIN || op == OP_COS) {
		partner = plan_partner(b->p, me, op == OP_SIN ? OP_COS : OP_SIN);
		if (!partner.i || partner.i > i)
			plan_add_line(b->p, LINE_SINCOS, me, 0);
	} else {
		plan_add_line(b->p, op == OP_INPUT ? LINE_INPUT : LINE_VALUE, me, 0);
	}
}

/* Nodes and outputs that stand before a section; after the last one, all of them. */
struct stretch {
	size_t node, output;
};

static struct stretch before(const struct dag *d, size_t section)
{
	if (section == d->section_count)
		return (struct stretch){d->count, d->output_count};
	return (struct stretch){d->sections[section].node, d->sections[section].output};
}

static void add_stretch(struct planner *b, struct stretch first, struct stretch end)
{
	for (size_t i = first.node; i < end.node; i++)
		if (b->named[i])
			add_value(b, i);
	for (size_t i = first.output; i < end.output; i++)
		plan_add_line(b->p, LINE_STORE, b->d->outputs[i].value, i);
}

static void add_section(struct planner *b, size_t section)
{
	struct ref none = {0};
	size_t head = b->p->line_count;

	plan_add_line(b->p, LINE_SECTION, none, section);
	add_stretch(b, before(b->d, section), before(b->d, section + 1));
	if (b->p->line_count == head + 1)
		b->p->line_count = head; /* nothing to say */
}

static int build(struct plan *p, const struct dag *d, const struct tree *t, const int *reach, struct arena *a)
{
	struct planner b = {.p = p, .d = d, .a = a, .reach = reach, .taken_size = 2 * (d->count + DAG_ARGUMENTS) + 1};
	unsigned temporaries = 0;

	*p = (struct plan){.dag = d, .tree = t};
	b.uses = arena_alloc(a, d->count, sizeof *b.uses);
	b.named = arena_alloc(a, d->count, 1);
	b.weight = arena_alloc(a, d->count, 1);
	b.taken = arena_alloc(a, b.taken_size, sizeof *b.taken);
	p->names = arena_alloc(a, d->count, sizeof *p->names);
	p->lines = arena_take(a, d->count + d->output_count + d->section_count, sizeof *p->lines);
	if (a->failed || d->failed)
		return 0;
	dag_uses(d, b.uses);
	choose_lines(&b);
	for (int i = 0; i < d->argument_count; i++)
		take(&b, d->arguments[i].name);
	for (size_t i = 0; i < d->count; i++)
		if (b.named[i])
			p->names[i] = name_value(&b, i, &temporaries);
	add_stretch(&b, (struct stretch){0, 0}, before(d, 0));
	for (size_t s = 0; s < d->section_count; s++)
		add_section(&b, s);
	arena_release(a, b.taken);
	arena_release(a, b.weight);
	arena_release(a, b.named);
	arena_release(a, b.uses);
	return !a->failed;
}

int plan_build(struct plan *p, const struct dag *d, const struct tree *t, struct arena *a)
{
	return build(p, d, t, NULL, a);
}

int plan_build_by_joints(struct plan *p, const struct dag *d, const struct tree *t, struct arena *a)
{
	int *reach = arena_alloc(a, d->count, sizeof *reach);

	if (!reach)
		return 0;
	readings_reach(reach, d, t);
	return build(p, d, t, reach, a);
}

struct ref plan_partner(const struct plan *p, struct ref sincos, enum op op)
{
	struct ref none = {0}, found = dag_find(p->dag, op, p->dag->nodes[sincos.i].arg[0], none, none, 0);

	return found.i && p->names[found.i] ? found : none;
}

void plan_dump(const struct plan *p, struct text *t)
{
	static const char *const kinds[LINE_KINDS] = {[LINE_SECTION] = "section", [LINE_INPUT] = "input", [LINE_VALUE] = "value",
		[LINE_SINCOS] = "sincos", [LINE_STORE] = "store", [LINE_FETCH] = "fetch", [LINE_KEEP] = "keep", [LINE_SINE] = "sine",
		[LINE_JOIN] = "join"};
	static const char *const kinds_of_section[SECTION_COUNT] = {[SECTION_OUT] = "out", [SECTION_BACK] = "back",
		[SECTION_END] = "end", [SECTION_FREED] = "freed", [SECTION_TOTALS] = "totals", [SECTION_BIAS] = "bias",
		[SECTION_GRAVITY] = "gravity", [SECTION_BY] = "by", [SECTION_PRODUCTS] = "products", [SECTION_FACTORS] = "factors",
		[SECTION_ARTICULATED] = "articulated", [SECTION_INVERSE] = "inverse", [SECTION_RESIDUAL] = "residual",
		[SECTION_REFINED] = "refined", [SECTION_BOUND] = "bound", [SECTION_REGRESSOR] = "regressor", [SECTION_PLACE] = "place",
		[SECTION_JACOBIAN] = "jacobian", [SECTION_RATE] = "rate", [SECTION_SUBTREE] = "subtree", [SECTION_CENTROID] = "centroid",
		[SECTION_FACTORED] = "factored", [SECTION_OPSPACE] = "opspace", [SECTION_CONTACTS] = "contacts",
		[SECTION_SWEEPS] = "sweeps", [SECTION_ROWS] = "rows", [SECTION_INPUTS] = "inputs", [SECTION_COLUMNS] = "columns",
		[SECTION_WAY] = "way"};

	for (size_t i = 0; i < p->line_count; i++) {
		const struct line *l = &p->lines[i];

		text_printf(t, "%s", kinds[l->kind]);
		if (l->kind == LINE_SECTION) {
			const struct section *s = &p->dag->sections[l->index];
			text_printf(t, " %s %d", kinds_of_section[s->kind],
				p->tree->bodies[s->body].number);
		} else {
			text_printf(t, " node %u %s", (unsigned)l->value.i,
				p->names[l->value.i] ? p->names[l->value.i] : "-");
		}
		if (l->kind == LINE_STORE)
			text_printf(t, " -> %s[%d]", p->dag->arguments[p->dag->outputs[l->index].argument].name,
				p->dag->outputs[l->index].row);
		text_putc(t, '\n');
	}
}
