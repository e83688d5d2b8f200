#include "range/box.h"
#include "base/text.h"
#include "relax/relax.h"
#include <stdio.h>
#include <string.h>

static const struct interval UNKNOWN = {1, 0};

static int is_known(struct interval x)
{
	return x.lower <= x.upper;
}

/* A quaternion's number is from -1 to 1, but for how far its length may be from 1. */
static struct interval position_limits(const struct tree_joint *t, const struct joint *j, int row)
{
	if (t->type == JOINT_FLOATING && row >= 3)
		return (struct interval){-1 - RELAXED_QUATERNION, 1 + RELAXED_QUATERNION};
	if (t->type == JOINT_CONTINUOUS || (t->type == JOINT_PLANAR && row == 2))
		return interval_turn();
	return j && j->has_limits && t->nq == 1 ? (struct interval){j->lower, j->upper} : UNKNOWN;
}

static struct interval rate_limits(const struct joint *j)
{
	return j && j->has_rates && j->velocity > 0 ? (struct interval){-j->velocity, j->velocity} : UNKNOWN;
}

static void take_limits(struct box *b, const struct analysis *x, int argument)
{
	const struct tree *t = &x->tree;
	enum role role = x->dag.arguments[argument].role;

	for (int i = 0; i < t->joint_count; i++) {
		const struct tree_joint *k = &t->joints[i];
		const struct joint *j = tree_joint_of(t->source, t, i);

		for (int r = 0; r < k->nq && role == ROLE_JOINT_POSITION; r++)
			b->rows[argument][k->iq + r] = position_limits(k, j, r);
		for (int r = 0; r < k->nv && role == ROLE_JOINT_VELOCITY; r++)
			b->rows[argument][k->iv + r] = rate_limits(j);
	}
}

static struct interval times(struct interval mass, double lower, double upper)
{
	return interval_mul(mass, (struct interval){lower, upper});
}

/* The ten numbers of a box of this mass, no side over 0.2 m and its centre within 0.1 m of the origin in each axis; of a link
   with an inertia of its own that of the URDF, of which such a box has up to a tenth: as draw.h draws them. */
static void take_body(struct interval *rows, const struct freed *f, struct interval mass)
{
	static const int is_square[FREED_ROWS] = {[4] = 1, [7] = 1, [9] = 1};
	double own = (double)f->nominal[0];
	struct interval part = own > 0 ? times(mass, 0, 0.1) : mass, rest = times(mass, 0.9, 1);

	rows[0] = mass;
	for (int i = 1; i < FREED_ROWS; i++) {
		rows[i] = i < 4 ? times(part, -0.1, 0.1) : is_square[i] ? times(part, 0, 0.02 / 3 + 0.02) : times(part, -0.01, 0.01);
		if (own > 0)
			rows[i] = interval_add(rows[i], interval_mul(rest, interval_around(f->nominal[i] / f->nominal[0], 0)));
	}
}

static const struct freed *body_of(const struct analysis *x, const struct argument *a)
{
	return a->role == ROLE_LINK_INERTIA || a->role == ROLE_LINK_PAYLOAD ? request_freed(&x->request, a->name) : NULL;
}

/* What the scene says; of a body its mass. */
static void take_ranges(struct box *b, const struct analysis *x, int argument)
{
	const struct argument *a = &x->dag.arguments[argument];
	const struct freed *body = body_of(x, a);
	const struct request_range *r;

	for (int row = 0; row < a->rows; row++) {
		r = request_range_of(&x->request, a->name, row);
		if (r && !(a->role == ROLE_JOINT_POSITION && tree_is_quaternion(&x->tree, row)))
			b->rows[argument][row] = (struct interval){r->lower, r->upper};
	}
	r = body ? request_range_of(&x->request, a->name, 0) : NULL;
	if (r)
		take_body(b->rows[argument], body, (struct interval){r->lower, r->upper});
}

void box_put_name(const struct analysis *x, int argument, int row, struct text *out)
{
	const struct argument *a = &x->dag.arguments[argument];
	int is_q = a->role == ROLE_JOINT_POSITION;

	for (int i = 0; i < x->tree.joint_count; i++) {
		const struct tree_joint *k = &x->tree.joints[i];
		int first = is_q ? k->iq : k->iv, count = is_q ? k->nq : k->nv;

		if ((is_q || !strcmp(a->name, "qd") || !strcmp(a->name, "qdd") || !strcmp(a->name, "tau")) && count == 1 && row == first) {
			text_printf(out, "%s.%s", a->name, k->name);
			return;
		}
	}
	text_printf(out, "%s[%d]", a->name, row);
}

/* A whole input that has no limits is named once. */
static void put_missing(const struct box *b, const struct analysis *x, const unsigned char *const *read, int argument,
	struct text *out)
{
	const struct argument *a = &x->dag.arguments[argument];
	int missing = 0, needed = 0;

	for (int r = 0; r < a->rows; r++) {
		needed += read[argument][r];
		missing += read[argument][r] && !is_known(b->rows[argument][r]);
	}
	if (missing && missing == needed && needed > 1) {
		text_printf(out, "%s%s", out->length ? ", " : "", a->name);
		return;
	}
	for (int r = 0; r < a->rows; r++)
		if (read[argument][r] && !is_known(b->rows[argument][r])) {
			text_put(out, out->length ? ", " : "");
			box_put_name(x, argument, r, out);
		}
}

static enum rneagen_code check(const struct box *b, const struct analysis *x, struct arena *a, struct rneagen_error *e)
{
	unsigned char *read[DAG_ARGUMENTS] = {NULL};
	uint32_t *uses = arena_alloc(a, x->dag.count, sizeof *uses);
	struct text missing;

	text_init(&missing, a);
	for (int i = 0; i < x->dag.argument_count; i++)
		read[i] = arena_alloc(a, (size_t)x->dag.arguments[i].rows, 1);
	if (a->failed)
		return error_memory(e);
	dag_uses(&x->dag, uses);
	for (size_t i = 0; i < x->dag.count; i++)
		if (uses[i] && x->dag.nodes[i].op == OP_INPUT)
			read[x->dag.nodes[i].arg[0].i][x->dag.nodes[i].arg[1].i] = 1;
	for (int i = 0; i < x->dag.argument_count; i++)
		if (!x->dag.arguments[i].is_output)
			put_missing(b, x, (const unsigned char *const *)read, i, &missing);
	if (missing.failed)
		return error_memory(e);
	if (missing.length)
		return error_set(e, RNEAGEN_USAGE, "no limit is known of %.400s: give --range NAME=LOWER,UPPER for each",
			text_string(&missing));
	return RNEAGEN_OK;
}

enum rneagen_code box_make(struct box *b, const struct analysis *x, struct arena *a, struct rneagen_error *e)
{
	*b = (struct box){{NULL}};
	for (int i = 0; i < x->dag.argument_count; i++) {
		if (x->dag.arguments[i].is_output)
			continue;
		b->rows[i] = arena_alloc(a, (size_t)x->dag.arguments[i].rows, sizeof *b->rows[i]);
		if (!b->rows[i])
			return error_memory(e);
		for (int r = 0; r < x->dag.arguments[i].rows; r++)
			b->rows[i][r] = UNKNOWN;
		take_limits(b, x, i);
		take_ranges(b, x, i);
	}
	return check(b, x, a, e);
}

int box_copy(struct interval *rows[DAG_ARGUMENTS], const struct box *b, const struct dag *d, struct arena *a)
{
	for (int i = 0; i < d->argument_count; i++) {
		size_t count = (size_t)d->arguments[i].rows;

		rows[i] = b->rows[i] ? arena_alloc(a, count, sizeof *rows[i]) : NULL;
		if (rows[i])
			memcpy(rows[i], b->rows[i], count * sizeof *rows[i]);
	}
	return !a->failed;
}
