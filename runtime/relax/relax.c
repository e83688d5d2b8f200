#include "relax/relaxing.h"
#include "relax/plain.h"
#include <math.h>

static int are_along(const real a[3], const real b[3])
{
	return (a[0] == b[0] && a[1] == b[1] && a[2] == b[2]) || (a[0] == -b[0] && a[1] == -b[1] && a[2] == -b[2]);
}

/* All that is read of its joint's quaternion is R^T g, each element once. */
static int is_of_ball(const struct relaxing *s, const struct fresh *f)
{
	for (int i = 0; i < s->fresh_count; i++) {
		const struct fresh *o = &s->fresh[i];

		if (o->joint != f->joint || o == f)
			continue;
		if (o->component < 0 || o->component == f->component || !are_along(o->g, f->g))
			return 0;
	}
	return f->component >= 0 && !s->is_boxed;
}

/* Drives first by joint, then what is no ball. */
static void number(struct relaxing *s, int first_row)
{
	struct relaxed *r = s->out;
	int drives = 0, rows = first_row;

	r->ball_count = 0;
	for (int i = 0; i < s->fresh_count; i++)
		s->fresh[i].is_drive &= s->fresh[i].joint < 0;
	for (int i = 0; i < s->fresh_count; i++) {
		struct fresh *f = &s->fresh[i];
		int known = 0;

		if (f->joint < 0 || !is_of_ball(s, f) || r->ball_count == RELAXED_BALLS)
			continue;
		for (int k = 0; k < i; k++)
			known |= s->fresh[k].joint == f->joint;
		if (known)
			continue;
		r->balls[r->ball_count] = (struct relaxed_ball){drives, 0,
			(double)sqrtl(f->g[0] * f->g[0] + f->g[1] * f->g[1] + f->g[2] * f->g[2]) * (1 + 2.01 * RELAXED_QUATERNION)};
		for (int k = i; k < s->fresh_count; k++)
			if (s->fresh[k].joint == f->joint) {
				s->fresh[k].is_drive = 1;
				s->fresh[k].at = drives++;
			}
		r->balls[r->ball_count].count = drives - r->balls[r->ball_count].first;
		r->ball_count++;
	}
	for (int i = 0; i < s->fresh_count; i++) {
		struct fresh *f = &s->fresh[i];

		if (f->joint >= 0 && f->is_drive)
			continue;
		f->at = f->is_drive ? drives++ : rows++;
	}
}

/* ---- the DAG ---- */

static struct ref input_of(const struct relaxing *s, struct dag *out, uint32_t fresh)
{
	const struct fresh *f = &s->fresh[fresh - 1];

	return dag_input(out, f->is_drive ? s->out->drives : s->position, f->at);
}

struct copying {
	const struct relaxing *s;
	struct ref *map;
};

/* Operations as they are, without any rule: what rounds stays. */
static struct ref copy(void *context, struct dag *out, size_t i)
{
	const struct copying *c = context;
	const struct relaxing *s = c->s;
	const struct node *n = &s->d->nodes[i];
	struct ref arg[3] = {{0}};

	if (i == 0 || !s->uses[i])
		return (struct ref){0};
	if (s->by_value[i])
		return input_of(s, out, s->by_value[i]);
	if (op_arity[n->op] == 0)
		return dag_copy_leaf(out, s->d, i);
	for (int k = 0; k < op_arity[n->op]; k++)
		arg[k] = c->map[n->arg[k].i];
	if ((n->op == OP_SIN || n->op == OP_COS) && s->by_angle[n->arg[0].i])
		arg[0] = input_of(s, out, s->by_angle[n->arg[0].i]);
	return dag_node(out, n->op, arg[0], arg[1], arg[2], 0);
}

static int count_of(const struct relaxing *s, int is_drive)
{
	int count = 0;

	for (int i = 0; i < s->fresh_count; i++)
		count += s->fresh[i].is_drive == is_drive;
	return count;
}

/* The DAG's arguments, with those that are new. */
static enum rneagen_code declare(struct relaxing *s, struct dag *from)
{
	struct relaxed *r = s->out;
	int rows = count_of(s, 0), drives = count_of(s, 1);

	*from = *s->d;
	from->section_count = 0;
	if (from->argument_count + 2 > DAG_ARGUMENTS)
		return error_set(s->e, RNEAGEN_LIMIT, "%s: %d inputs and outputs, and rnearun prove takes %d: free or want fewer",
			r->text->options.file, from->argument_count, DAG_ARGUMENTS - 2);
	if (s->position < 0) {
		s->position = from->argument_count;
		from->arguments[from->argument_count++] = (struct argument){.name = "q", .role = ROLE_JOINT_POSITION};
	}
	r->row_count = from->arguments[s->position].rows += rows;
	r->drives = drives ? from->argument_count : -1;
	if (drives)
		from->arguments[from->argument_count++] = (struct argument){.name = "drives", .rows = drives, .role = ROLE_JOINT_ACCELERATION};
	return RNEAGEN_OK;
}

/* The first where several are one. */
static void take_origins(struct relaxing *s, const struct ref *map)
{
	struct relaxed *r = s->out;

	r->origin = arena_alloc(s->a, r->view.dag.count, sizeof *r->origin);
	for (size_t i = s->d->count; i-- > 1 && r->origin;)
		if (map[i].i)
			r->origin[map[i].i] = (uint32_t)i;
}

static enum rneagen_code build(struct relaxing *s)
{
	struct copying c = {s, arena_alloc(s->a, s->d->count, sizeof *c.map)};
	struct dag from, *out = &s->out->view.dag;
	int before = s->position;

	number(s, before < 0 ? 0 : s->d->arguments[before].rows);
	if (declare(s, &from))
		return s->e->code;
	dag_init(out, s->a);
	if (c.map)
		dag_copy(out, &from, c.map, copy, &c);
	if (c.map && !out->failed)
		take_origins(s, c.map);
	return s->a->failed || out->failed ? error_memory(s->e) : RNEAGEN_OK;
}

/* Is a drive of a ball multiplied by what has drives or rates? */
static int has_products(const struct relaxing *s)
{
	const struct dag *d = &s->out->view.dag;
	unsigned char *has = arena_alloc(s->a, d->count, 1); /* 1: drives and rates; 2: those of balls */

	for (size_t i = 0; i < d->count && has; i++) {
		const struct node *n = &d->nodes[i];
		unsigned char a = op_arity[n->op] > 0 ? has[n->arg[0].i] : 0, b = op_arity[n->op] > 1 ? has[n->arg[1].i] : 0;

		if (n->op == OP_INPUT && (int)n->arg[0].i != s->position)
			has[i] = relaxed_ball_of(s->out, (int)n->arg[0].i, (int)n->arg[1].i) ? 3 : 1;
		if ((n->op == OP_MUL || n->op == OP_FMA) && (a | b) & 2 && a && b)
			return 1;
		if (op_arity[n->op])
			has[i] = a | b | (n->op == OP_FMA ? has[n->arg[2].i] : 0);
	}
	return 0;
}

static struct interval *copy_rows(const struct relaxing *s, int argument, int rows)
{
	struct interval *to = arena_alloc(s->a, (size_t)rows, sizeof *to);
	const struct interval *from = argument < s->d->argument_count ? s->given[argument] : NULL;

	for (int i = 0; from && to && i < s->d->arguments[argument].rows; i++)
		to[i] = from[i];
	return to;
}

/* Ranges of what is new, and what it stands for. */
static enum rneagen_code describe(struct relaxing *s)
{
	struct relaxed *r = s->out;
	const struct dag *d = &r->view.dag;

	for (int i = 0; i < d->argument_count; i++)
		r->rows[i] = d->arguments[i].is_output ? NULL : copy_rows(s, i, d->arguments[i].rows);
	r->of_q = arena_alloc(s->a, (size_t)r->row_count + 1, sizeof *r->of_q);
	r->source = arena_alloc(s->a, d->count, sizeof *r->source);
	if (s->a->failed)
		return error_memory(s->e);
	for (int i = 0; i < r->row_count; i++)
		r->of_q[i] = (struct relaxed_row){relax_turns(&r->text->tree, i, 1), 1, s->position, i, 1};
	for (int i = 0; i < s->fresh_count; i++) {
		const struct fresh *f = &s->fresh[i];

		r->rows[f->is_drive ? r->drives : s->position][f->at] = f->range;
		if (!f->is_drive)
			r->of_q[f->at] = f->row;
	}
	for (uint32_t i = 0; i < d->count; i++)
		for (int k = 0; k < s->fresh_count && d->nodes[i].op == OP_INPUT; k++) {
			const struct fresh *f = &s->fresh[k];
			int argument = f->is_drive ? r->drives : s->position;

			if ((int)d->nodes[i].arg[0].i == argument && (int)d->nodes[i].arg[1].i == f->at)
				r->source[i] = 1 + f->of;
		}
	return RNEAGEN_OK;
}

const struct relaxed_ball *relaxed_ball_of(const struct relaxed *r, int argument, int row)
{
	for (int i = 0; i < r->ball_count && argument == r->drives; i++)
		if (row >= r->balls[i].first && row < r->balls[i].first + r->balls[i].count)
			return &r->balls[i];
	return NULL;
}

/* Nothing is new: the text's own DAG, and its box. */
static enum rneagen_code keep_all(struct relaxing *s)
{
	struct relaxed *r = s->out;

	r->is_same = 1;
	for (int i = 0; i < s->d->argument_count; i++)
		r->rows[i] = s->given[i];
	r->row_count = s->out->text->tree.nq;
	r->of_q = arena_alloc(s->a, (size_t)r->row_count + 1, sizeof *r->of_q);
	r->source = arena_alloc(s->a, s->d->count, sizeof *r->source);
	r->origin = arena_alloc(s->a, s->d->count, sizeof *r->origin);
	for (uint32_t i = 0; i < s->d->count && r->origin; i++)
		r->origin[i] = i;
	for (int i = 0; i < r->row_count && r->of_q; i++)
		r->of_q[i] = (struct relaxed_row){relax_turns(&r->text->tree, i, 1), 1, s->position, i, 1};
	return s->a->failed ? error_memory(s->e) : RNEAGEN_OK;
}

/* A friction that is free is no more than a quotient to whoever comes after. */
static enum rneagen_code check_text(const struct dag *d, const uint32_t *uses, const char *file, struct rneagen_error *e)
{
	for (size_t i = 0; i < d->output_count; i++) {
		const struct argument *a = &d->arguments[d->outputs[i].argument];

		if (a->role != ROLE_JOINT_TORQUE && a->role != ROLE_GRAVITY_TORQUE && a->role != ROLE_BIAS_TORQUE &&
			a->role != ROLE_MASS_MATRIX)
			return error_set(e, RNEAGEN_UNSUPPORTED, "%s: prove knows torques, gravity, bias and M, not %s", file, a->name);
	}
	for (uint32_t i = 1; i < d->count; i++) {
		const struct node *n = &d->nodes[i];
		const struct argument *a = &d->arguments[n->op == OP_INPUT && n->arg[0].i < DAG_ARGUMENTS ? n->arg[0].i : 0];

		if (uses[i] && n->op == OP_INPUT && (a->role == ROLE_FRICTION || a->role == ROLE_JOINT_FRICTION))
			return error_set(e, RNEAGEN_UNSUPPORTED,
				"%s: prove knows the URDF's friction (--friction), not %s that is free", file, a->name);
	}
	return RNEAGEN_OK;
}

enum rneagen_code relax(struct relaxed *r, const struct analysis *text, struct interval *const *given, struct arena *a,
	struct rneagen_error *e)
{
	size_t count = text->dag.count;
	struct relaxing s = {.out = r, .d = &text->dag, .given = given, .a = a, .e = e, .plain = arena_alloc(a, count, sizeof *s.plain),
		.uses = arena_alloc(a, count, sizeof *s.uses), .by_angle = arena_alloc(a, count, sizeof *s.by_angle),
		.by_value = arena_alloc(a, count, sizeof *s.by_value), .fresh = arena_alloc(a, 2 * count, sizeof *s.fresh)};

	*r = (struct relaxed){.text = text, .view = *text, .drives = -1};
	if (a->failed)
		return error_memory(e);
	dag_uses(s.d, s.uses);
	if (check_text(s.d, s.uses, text->options.file, e))
		return e->code;
	s.position = dag_find_role(s.d, ROLE_JOINT_POSITION, 0);
	plain_ranges(s.plain, s.d, given, s.uses);
	if (!(s.seen = relax_see(s.d, &text->tree, s.uses, a)))
		return error_memory(e);
	if (relax_fresh(&s))
		return e->code;
	if (!s.fresh_count)
		return keep_all(&s);
	if (build(&s))
		return e->code;
	if (r->ball_count && has_products(&s)) {
		s.is_boxed = 1;
		s.position = dag_find_role(s.d, ROLE_JOINT_POSITION, 0);
		if (build(&s))
			return e->code;
	}
	return describe(&s);
}
