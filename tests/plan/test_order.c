/* Plans in an order in which fewer values wait, by rules alone: each value is made before it is read, each output is stored once
   and is the same expression, and fewer values wait at once. What has an order of its own keeps it; on a processor a line stands
   early where then no more values wait. */
#include "passes/analysis.h"
#include "plan/early.h"
#include "support/read.h"
#include "support/random_robot.h"
#include "support/rng.h"
#include "support/suite.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { RANDOM_ROBOTS = 40, MOST_LINKS = 16 };

static const char *const SCENES[] = {"want tau, vjp", "want jvp", "want qdd", "want Minv", "want regressor", "vjp qdd"};
enum { SCENE_COUNT = sizeof SCENES / sizeof *SCENES };

/* Is it the same expression, in two DAGs? `same` knows the nodes of `a` that were found in `b`. */
static int is_same(const struct dag *a, struct ref x, const struct dag *b, struct ref y, uint32_t *same)
{
	const struct node *m = &a->nodes[x.i], *n = &b->nodes[y.i];
	int equal = m->op == n->op && m->is_wide == n->is_wide;

	if (same[x.i])
		return same[x.i] == y.i + 1;
	if (m->op == OP_CONST)
		return equal && m->value == n->value;
	if (m->op == OP_INPUT)
		return equal && m->arg[0].i == n->arg[0].i && m->arg[1].i == n->arg[1].i;
	for (int k = 0; k < op_arity[m->op] && equal; k++)
		equal = is_same(a, m->arg[k], b, n->arg[k], same);
	same[x.i] = equal ? y.i + 1 : 0;
	return equal;
}

static struct ref stored(const struct dag *d, const struct output *like)
{
	struct ref none = {0};

	for (size_t i = 0; i < d->output_count; i++)
		if (d->outputs[i].argument == like->argument && d->outputs[i].row == like->row)
			return d->outputs[i].value;
	ck_abort_msg("row %d of %s is not stored", like->row, d->arguments[like->argument].name);
	return none;
}

static void expect_same_outputs(const struct dag *before, const struct dag *after, const char *what)
{
	uint32_t *same = calloc(before->count, sizeof *same);

	ck_assert_msg(before->output_count == after->output_count, "%s: %zu outputs, not %zu", what, after->output_count,
		before->output_count);
	for (size_t i = 0; i < before->output_count && same; i++)
		ck_assert_msg(is_same(before, before->outputs[i].value, after, stored(after, &before->outputs[i]), same),
			"%s: row %d of %s is another one", what, before->outputs[i].row,
			before->arguments[before->outputs[i].argument].name);
	free(same);
}

static void expect_made(const struct plan *p, const unsigned char *has, struct ref r, const char *what)
{
	const struct node *n = &p->dag->nodes[r.i];

	if (n->op == OP_CONST || has[r.i])
		return;
	ck_assert_msg(!p->names[r.i], "%s: %s is read before it is made", what, p->names[r.i]);
	for (int k = 0; k < op_arity[n->op]; k++)
		expect_made(p, has, n->arg[k], what);
}

/* Lines make what they read, in this order. */
static void expect_runs(const struct plan *p, const char *what)
{
	unsigned char *has = calloc(p->dag->count, 1);

	for (const struct line *l = p->lines; l < p->lines + p->line_count && has; l++) {
		const struct node *n = &p->dag->nodes[l->value.i];

		if (l->kind == LINE_SECTION)
			continue;
		for (int k = 0; k < op_arity[n->op] && l->kind != LINE_STORE; k++)
			expect_made(p, has, n->arg[k], what);
		if (l->kind == LINE_STORE)
			expect_made(p, has, l->value, what);
		has[l->value.i] = 1;
		if (l->kind == LINE_SINCOS)
			has[plan_partner(p, l->value, OP_SIN).i] = has[plan_partner(p, l->value, OP_COS).i] = 1;
	}
	free(has);
}

/* A kernel keeps tau where qdd was: each joint's acceleration is read before its torque is stored. */
static void expect_in_place(const struct plan *p, const char *what)
{
	int qdd = dag_find_role(p->dag, ROLE_JOINT_ACCELERATION, 0), tau = dag_find_role(p->dag, ROLE_JOINT_TORQUE, 1);
	unsigned char *has = calloc((size_t)p->tree->nv + 1, 1);

	for (const struct line *l = p->lines; l < p->lines + p->line_count && has && qdd >= 0 && tau >= 0; l++) {
		const struct node *n = &p->dag->nodes[l->value.i];

		if (l->kind == LINE_STORE && p->dag->outputs[l->index].argument == tau)
			has[p->dag->outputs[l->index].row] = 1;
		else if (l->kind == LINE_INPUT && n->arg[0].i == (uint32_t)qdd)
			ck_assert_msg(!has[n->arg[1].i], "%s: row %u of qdd is read after tau's is stored", what, n->arg[1].i);
	}
	free(has);
}

/* ---- early lines ---- */

static void read_named(const struct plan *p, struct ref r, size_t line, size_t *last)
{
	const struct node *n = &p->dag->nodes[r.i];

	for (int k = 0; k < op_arity[n->op] && !p->names[r.i]; k++)
		read_named(p, n->arg[k], line, last);
	last[r.i] = line;
}

/* Lines between the one that makes a value and the last that reads it, summed over all values. */
static size_t waiting(const struct plan *p)
{
	size_t *made = calloc(p->dag->count, sizeof *made), *last = calloc(p->dag->count, sizeof *last), sum = 0;

	for (size_t i = 0; i < p->line_count && made && last; i++) {
		const struct line *l = &p->lines[i];
		const struct node *n = &p->dag->nodes[l->value.i];

		if (l->kind == LINE_STORE)
			read_named(p, l->value, i, last);
		for (int k = 0; k < op_arity[n->op] && l->kind != LINE_STORE && l->kind != LINE_SECTION; k++)
			read_named(p, n->arg[k], i, last);
		if (l->kind == LINE_VALUE)
			made[l->value.i] = last[l->value.i] = i;
	}
	for (size_t i = 0; i < p->dag->count && made && last; i++)
		sum += made[i] ? last[i] - made[i] : 0;
	free(last);
	free(made);
	return sum;
}

/* The same lines once each, but for sections that have none. Returns how much waits, over what did. */
static double expect_early(const struct plan *p, struct arena *a, const char *what)
{
	size_t lines = 0, *seen = calloc(p->dag->count + p->dag->output_count, sizeof *seen);
	struct plan early;

	ck_assert(plan_early(&early, p, a));
	expect_runs(&early, what);
	for (size_t i = 0; i < p->line_count; i++)
		lines += p->lines[i].kind != LINE_SECTION;
	for (size_t i = 0; i < early.line_count && seen; i++) {
		const struct line *l = &early.lines[i];

		if (l->kind == LINE_SECTION)
			continue;
		ck_assert_msg(!seen[l->kind == LINE_STORE ? p->dag->count + l->index : l->value.i]++, "%s: a line twice", what);
		lines--;
	}
	ck_assert_msg(!lines, "%s: %zu lines lost", what, lines);
	ck_assert_msg(plan_alive(&early, a) <= plan_alive(p, a), "%s: more at once", what);
	free(seen);
	return (double)waiting(&early) / (double)(waiting(p) + 1);
}

/* Most values at once, before and after; whether the order is another one; how much waits in early lines. */
struct most {
	int before, after, is_other;
	double early;
};

/* Of the scene's main function; 0 where there is no such scene of the robot. */
static struct most order(const char *urdf, size_t length, const struct rneagen_options *o, const char *what)
{
	struct rneagen_error e;
	struct analysis x;
	struct most most = {0};
	struct function p, part;

	if (analysis_open(&x, urdf, length, o, &e)) {
		ck_assert_msg(strstr(e.message, "singular") || strstr(e.message, "nothing"), "%s: %s", what, e.message);
		return most;
	}
	p = (struct function){.dag = x.dag};
	ck_assert(plan_build(&p.plan, &p.dag, &x.tree, x.arena));
	most.before = plan_alive(&p.plan, x.arena);
	most.early = expect_early(&p.plan, x.arena, what);
	part = (struct function){.dag = x.dag};
	ck_assert(plan_build(&part.plan, &part.dag, &x.tree, x.arena));
	ck_assert(plan_order(&p, &x.tree, &x.request, o, ORDERED_WHOLE, x.arena));
	ck_assert(plan_order(&part, &x.tree, &x.request, o, ORDERED_PART, x.arena));
	most.after = plan_alive(&p.plan, x.arena);
	most.is_other = p.dag.nodes != x.dag.nodes;
	expect_same_outputs(&x.dag, &p.dag, what);
	expect_same_outputs(&x.dag, &part.dag, what);
	expect_runs(&p.plan, what);
	expect_runs(&part.plan, what);
	expect_in_place(&p.plan, what);
	expect_in_place(&part.plan, what);
	analysis_free(&x);
	return most;
}

static struct most order_robot(const char *name, const char *scene)
{
	struct rneagen_options o = rneagen_options_default();
	char *urdf = robot_text(name);
	struct most most;

	o.scene = scene;
	most = order(urdf, strlen(urdf), &o, name);
	free(urdf);
	return most;
}

/* It would catch an order that keeps whole limbs waiting: a vjp of a humanoid has 444 values at once as it is made. */
START_TEST(test_fewer)
{
	struct most x = order_robot("atlas", "want tau, vjp"), hyq = order_robot("hyq", "want qdd, dqdd_dq, dqdd_dqd");

	ck_assert_msg(x.after < 0.65 * x.before, "atlas: %d at once, %d before", x.after, x.before);
	ck_assert_msg(hyq.after < 0.75 * hyq.before, "hyq: %d at once, %d before", hyq.after, hyq.before);
}
END_TEST

/* It would catch factors of M that wait for the bias, which has few values left over. */
START_TEST(test_bias)
{
	struct most x = order_robot("atlas", "want qdd"), panda = order_robot("panda", "want qdd");

	ck_assert_msg(x.after < 0.95 * x.before, "atlas: %d at once, %d before", x.after, x.before);
	ck_assert_msg(!panda.is_other, "panda: %d at once, %d before", panda.after, panda.before);
}
END_TEST

/* It would catch a tour, or a matrix, that is torn up though its own order is good. */
START_TEST(test_own)
{
	static const char *const scenes[] = {"want tau", "want M", "want tau, dtau_dq, dtau_dqd"};

	for (int i = 0; i < 3; i++) {
		struct most x = order_robot("atlas", scenes[i]);

		ck_assert_msg(!x.is_other, "%s: %d at once, %d before", scenes[i], x.after, x.before);
	}
}
END_TEST

/* It would catch outputs that are stored at the ends of their sections: elements of gradients then wait for all others of a
   joint. */
START_TEST(test_early)
{
	struct most x = order_robot("atlas", "want tau, dtau_dq, dtau_dqd"), panda = order_robot("panda", "want tau, dtau_dq, dtau_dqd");

	ck_assert_msg(x.early < 0.9, "atlas: %.2f of what waits", x.early);
	ck_assert_msg(panda.early < 0.9, "panda: %.2f of what waits", panda.early);
}
END_TEST

/* It would catch zeros of a tool without mass that are written over its acceleration, which is wanted, in shared memory. */
START_TEST(test_in_place)
{
	static const char urdf[] =
		"<robot name=\"t\"><link name=\"base\"/>"
		"<joint name=\"j1\" type=\"prismatic\"><parent link=\"base\"/><child link=\"a\"/><axis xyz=\"0 1 0\"/>"
		"<limit lower=\"-1\" upper=\"1\" effort=\"1\" velocity=\"1\"/></joint>"
		"<link name=\"a\"><inertial><mass value=\"2\"/>"
		"<inertia ixx=\"0.1\" iyy=\"0.1\" izz=\"0.1\" ixy=\"0\" ixz=\"0\" iyz=\"0\"/></inertial></link>"
		"<joint name=\"j2\" type=\"prismatic\"><parent link=\"a\"/><child link=\"tool\"/><axis xyz=\"1 0 0\"/>"
		"<limit lower=\"-1\" upper=\"1\" effort=\"1\" velocity=\"1\"/></joint><link name=\"tool\"/></robot>";
	struct rneagen_options o = rneagen_options_default();

	o.scene = "want tau,accel.tool";
	order(urdf, sizeof urdf - 1, &o, "a tool without mass");
}
END_TEST

/* It would catch a value that is read before it is made, a row that is lost, or one that is another expression. */
START_TEST(test_random)
{
	struct rneagen_options o = rneagen_options_default();
	int count = 0;

	for (uint64_t seed = 1; seed <= RANDOM_ROBOTS; seed++) {
		struct random_robot_knobs knobs = random_robot_knobs(seed, MOST_LINKS);
		struct rng r = rng_seed(seed);
		char *urdf = random_robot(seed, &knobs), what[80];
		struct most x;

		o.scene = SCENES[rng_below(&r, SCENE_COUNT)];
		o.base = rng_chance(&r, 0.5) ? RNEAGEN_FIXED : RNEAGEN_FLOATING;
		o.precision = rng_chance(&r, 0.5) ? RNEAGEN_F32 : RNEAGEN_MIXED;
		snprintf(what, sizeof what, "seed %llu, scene '%s'", (unsigned long long)seed, o.scene);
		x = order(urdf, strlen(urdf), &o, what);
		count += x.is_other;
		free(urdf);
	}
	ck_assert_msg(count >= RANDOM_ROBOTS / 10, "%d of %d robots have another order", count, RANDOM_ROBOTS);
}
END_TEST

int main(void)
{
	Suite *s = suite_create("order");

	suite_add(s, "fewer", test_fewer, 1, 20);
	suite_add(s, "bias", test_bias, 1, 20);
	suite_add(s, "own", test_own, 1, 20);
	suite_add(s, "early", test_early, 1, 20);
	suite_add(s, "in place", test_in_place, 1, 20);
	suite_add(s, "random", test_random, 1, 20);
	return suite_run(s);
}
