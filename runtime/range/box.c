#include "range/box.h"
#include "base/text.h"
#include <math.h>
#include <stdio.h>
#include <string.h>

/* above pi */
static const double PI_ABOVE = 0x1.921fb54442d19p+1;

static const struct interval UNKNOWN = {1, 0};

static int is_known(struct interval x)
{
	return x.lower <= x.upper;
}

static struct interval position_limits(const struct tree_joint *t, const struct joint *j)
{
	if (t->type == JOINT_CONTINUOUS)
		return (struct interval){-PI_ABOVE, PI_ABOVE};
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
			b->rows[argument][k->iq + r] = position_limits(k, j);
		for (int r = 0; r < k->nv && role == ROLE_JOINT_VELOCITY; r++)
			b->rows[argument][k->iv + r] = rate_limits(j);
	}
}

/* What the scene says, the whole of an input before its joints, these before single rows. */
static void take_ranges(struct box *b, const struct analysis *x, int argument)
{
	const struct argument *a = &x->dag.arguments[argument];

	for (int level = 0; level < REQUEST_RANGE_LEVELS; level++)
		for (int i = 0; i < x->request.range_count; i++) {
			const struct request_range *r = &x->request.ranges[i];

			for (int row = r->first; r->level == level && !strcmp(r->argument, a->name) && row < r->first + r->count; row++)
				b->rows[argument][row] = (struct interval){r->lower, r->upper};
		}
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
static void put_missing(const struct box *b, const struct analysis *x, const unsigned char *const *read, int argument, struct text *out)
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
		return error_set(e, RNEAGEN_USAGE, "no limit is known of %.400s: give --range NAME=LOWER,UPPER for each", text_string(&missing));
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
