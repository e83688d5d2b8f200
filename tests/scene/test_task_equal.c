/* One thing said in two ways: a freed constant with another value is another URDF, and the parts of the torques make the
   whole. */
#define _POSIX_C_SOURCE 200809L
#include "support/suite.h"
#include "support/task/task.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { ROBOTS = 60, LINKS = 9 };

/* ---- constants, and the URDF that has them ---- */

/* Of an arm of two links with a tool that is fixed to the second. */
struct arm {
	double gravity[3], mass, inertia[6], tool_mass, second_offset;
	const char *extra; /* further elements */
};

static const struct arm PLAIN = {{0, 0, -9.81}, 2, {0.3, 0.01, -0.02, 0.4, 0.03, 0.5}, 1.5, 0, ""};

#define CENTRE "0.1 -0.2 0.3"
#define TURN "0.2 -0.4 1.1"

static char *arm_urdf(const struct arm *a)
{
	char *text = malloc(1 << 13);
	const double *i = a->inertia;

	/* the second joint turns about its z, so that an angle more is a last turn of its origin more */
	snprintf(text, 1 << 13,
		"<robot name='arm'><link name='ground'/>"
		"<link name='first'><inertial><origin xyz='0.1 0.2 -0.1'/><mass value='3'/><inertia ixx='0.2' ixy='0' "
		"ixz='0' iyy='0.3' iyz='0' izz='0.25'/></inertial></link>"
		"<link name='second'><inertial><origin xyz='" CENTRE "' rpy='" TURN "'/><mass value='%.17g'/>"
		"<inertia ixx='%.17g' ixy='%.17g' ixz='%.17g' iyy='%.17g' iyz='%.17g' izz='%.17g'/></inertial></link>"
		"<link name='tool'><inertial><origin xyz='0 0 0.1'/><mass value='%.17g'/><inertia ixx='0.01' ixy='0' "
		"ixz='0' iyy='0.01' iyz='0' izz='0.02'/></inertial></link>"
		"<joint name='j1' type='revolute'><parent link='ground'/><child link='first'/><axis xyz='0 0 "
		"1'/><limit effort='1' velocity='1' lower='-3' upper='3'/></joint>"
		"<joint name='j2' type='revolute'><parent link='first'/><child link='second'/><origin xyz='0.3 0 0.2' "
		"rpy='0 0 %.17g'/><axis xyz='0 0 1'/><limit effort='1' velocity='1' lower='-3' upper='3'/></joint>"
		"<joint name='j3' type='fixed'><parent link='second'/><child link='tool'/><origin xyz='0 0.4 0.1' "
		"rpy='0.3 0.2 0.1'/></joint>%s</robot>",
		a->mass, i[0], i[1], i[2], i[3], i[4], i[5], a->tool_mass, a->second_offset, a->extra);
	return text;
}

/* Torques of the plain arm with `word` freed and fed are those of the other arm's URDF; at the plain arm's own value, its
   own. */
static void compare(const struct arm *other, const char *word, const double *value, int rows)
{
	static struct task_arrays x;
	struct rneagen_options o = rneagen_options_default();
	struct task_case *c = case_new(arm_urdf(&PLAIN), &o, 1);
	char message[256], *text = arm_urdf(other);
	struct reference_options ro = {.gravity = other->gravity};
	struct reference *r = reference_open(text, strlen(text), &ro, message, sizeof message);
	struct scene_model m;
	wide tau[ROWS], size[ROWS];

	ck_assert_msg(r != NULL, "%s", message);
	ck_assert_int_eq(r->nv, 2);
	case_say(c, "free %s\n", word);
	ck_assert_msg(!scene_open(&m, c->urdf, &c->options), "%s", m.error.message);
	ck_assert_int_eq(m.dag.argument_count, 5);
	ck_assert_int_eq(m.dag.arguments[3].rows, rows);
	memcpy(x.in[0], c->q, sizeof x.in[0]);
	memcpy(x.in[1], c->qd, sizeof x.in[1]);
	memcpy(x.in[2], c->qdd, sizeof x.in[2]);
	memcpy(x.in[3], value, (size_t)rows * sizeof *value);
	case_evaluate(&m.dag, TASK_REAL, &x);
	reference_rnea(r, c->q, c->qd, c->qdd, tau);
	reference_magnitude(r, c->q, c->qd, c->qdd, size);
	for (int i = 0; i < 2; i++)
		ck_assert_msg(fabsl(x.out[4][i] - (real)tau[i]) <= 1e-15L * (real)size[i],
			"%s, row %d: %.17Lg, not %.17Lg", word, i, x.out[4][i], (real)tau[i]);
	reference_close(r);
	free(text);
	scene_close(&m);
	case_close(c);
}

START_TEST(gravity_and_mass)
{
	static const struct arm fall = {{1, 2, -3}, 2, {0.3, 0.01, -0.02, 0.4, 0.03, 0.5}, 1.5, 0, ""};
	static const struct arm heavy = {{0, 0, -9.81}, 7.25, {0.3, 0.01, -0.02, 0.4, 0.03, 0.5}, 1.5, 0, ""};
	static const struct arm tool = {{0, 0, -9.81}, 2, {0.3, 0.01, -0.02, 0.4, 0.03, 0.5}, 0.125, 0, ""};
	static const double mass = 7.25, tool_mass = 0.125;

	compare(&fall, "gravity", fall.gravity, 3);
	compare(&heavy, "mass.second", &mass, 1);
	compare(&tool, "mass.tool", &tool_mass, 1);
	compare(&PLAIN, "gravity", PLAIN.gravity, 3);
	compare(&PLAIN, "mass.second", &PLAIN.mass, 1);
	compare(&PLAIN, "mass.tool", &PLAIN.tool_mass, 1);
}
END_TEST

/* An angle more; the random trees have it in followers, too. */
START_TEST(offset)
{
	static const struct arm turned = {{0, 0, -9.81}, 2, {0.3, 0.01, -0.02, 0.4, 0.03, 0.5}, 1.5, 0.625, ""};
	static const double none = 0;

	compare(&turned, "offset.j2", &turned.second_offset, 1);
	compare(&PLAIN, "offset.j2", &none, 1);
}
END_TEST

/* A ball of 2.5 kg at the tool's (0.1, 0.2, -0.3), 0.05 kg m^2 about each axis. */
START_TEST(payload)
{
	static const struct arm loaded = {{0, 0, -9.81}, 2, {0.3, 0.01, -0.02, 0.4, 0.03, 0.5}, 1.5, 0,
		"<link name='ball'><inertial><mass value='2.5'/><inertia ixx='0.05' ixy='0' ixz='0' iyy='0.05' iyz='0' "
		"izz='0.05'/></inertial></link>"
		"<joint name='j4' type='fixed'><parent link='tool'/><child link='ball'/><origin xyz='0.1 0.2 "
		"-0.3'/></joint>"};
	const double m = 2.5, c[3] = {0.1, 0.2, -0.3}, I = 0.05;
	const double value[10] = {m, m * c[0], m * c[1], m * c[2], I + m * (c[1] * c[1] + c[2] * c[2]),
		-m * c[0] * c[1], -m * c[0] * c[2], I + m * (c[0] * c[0] + c[2] * c[2]), -m * c[1] * c[2],
		I + m * (c[0] * c[0] + c[1] * c[1])};
	static const double none[10] = {0};

	compare(&loaded, "payload.tool", value, 10);
	compare(&PLAIN, "payload.tool", none, 10);
}
END_TEST

/* The tool's ten parameters as those of a ball at (0.1, 0.2, -0.3) in its place: the URDF's tool has no mass, a ball has. */
START_TEST(inertia)
{
	static const struct arm other = {{0, 0, -9.81}, 2, {0.3, 0.01, -0.02, 0.4, 0.03, 0.5}, 0, 0,
		"<link name='ball'><inertial><mass value='2.5'/><inertia ixx='0.05' ixy='0' ixz='0' iyy='0.05' iyz='0' "
		"izz='0.05'/></inertial></link>"
		"<joint name='j4' type='fixed'><parent link='tool'/><child link='ball'/><origin xyz='0.1 0.2 "
		"-0.3'/></joint>"};
	/* x, z: the tool's, which stay in the URDF */
	const double m = 2.5, c[3] = {0.1, 0.2, -0.3}, I = 0.05, x = 0.01, z = 0.02;
	const double value[10] = {m, m * c[0], m * c[1], m * c[2], x + I + m * (c[1] * c[1] + c[2] * c[2]), -m * c[0] * c[1],
		-m * c[0] * c[2], x + I + m * (c[0] * c[0] + c[2] * c[2]), -m * c[1] * c[2],
		z + I + m * (c[0] * c[0] + c[1] * c[1])};

	compare(&other, "inertia.tool", value, 10);
}
END_TEST

/* ---- parts of the torques ---- */

static void scale(const struct scene_model *m, struct task_arrays *x, const char *name, double factor)
{
	int k = dag_find_argument(&m->dag, name);

	for (int i = 0; i < ROWS && k >= 0; i++)
		x->in[k][i] *= factor;
}

static void near_to(real got, real want, wide size, uint64_t seed, const char *what)
{
	ck_assert_msg(fabsl(got - want) <= 1e-14L * (real)size, "seed %d, %s: %.17Lg, not %.17Lg", (int)seed, what, got, want);
}

/* tau = gravity + Coriolis + inertial: bias - gravity goes with the square of qd, tau - bias with qdd. */
static void check_parts(struct task_case *c, const struct scene_model *m, uint64_t seed)
{
	static struct task_arrays once, x;
	int tau = dag_find_argument(&m->dag, "tau"), bias = dag_find_argument(&m->dag, "tau_bias"),
	    gravity = dag_find_argument(&m->dag, "tau_gravity");
	struct task_expected expected;

	case_expect(c, &c->out[0], &expected);
	case_feed(c, m, &once);
	x = once;
	case_evaluate(&m->dag, TASK_REAL, &once);
	scale(m, &x, "qd", 2);
	scale(m, &x, "qdd", -3);
	case_evaluate(&m->dag, TASK_REAL, &x);
	for (int i = 0; i < c->r->nv; i++) {
		real g = once.out[gravity][i], coriolis = once.out[bias][i] - g, inertial = once.out[tau][i] - once.out[bias][i];
		wide size = 10 * expected.size[i];

		near_to(x.out[gravity][i], g, size, seed, "gravity");
		near_to(x.out[bias][i], g + 4 * coriolis, size, seed, "bias");
		near_to(x.out[tau][i], g + 4 * coriolis - 3 * inertial, size, seed, "tau");
	}
}

START_TEST(parts)
{
	for (uint64_t seed = 1; seed <= ROBOTS; seed++) {
		struct task_case *c = case_random(seed, LINKS, NO_ODD_NAMES);
		struct scene_model m;

		if (!c)
			continue;
		case_want(c, TASK_TAU, 0);
		case_want(c, TASK_BIAS, 0);
		case_want(c, TASK_GRAVITY, 0);
		case_check(c, &m, "parts");
		check_parts(c, &m, seed);
		scene_close(&m);
		case_close(c);
	}
	printf("parts of torques: random trees, seeds 1 to %d\n", ROBOTS);
}
END_TEST

int main(void)
{
	Suite *suite = suite_create("task_equal");
	TCase *c = tcase_create("equal");

	setvbuf(stdout, NULL, _IOLBF, 0);
	tcase_set_timeout(c, 300);
	tcase_add_test(c, gravity_and_mass);
	tcase_add_test(c, offset);
	tcase_add_test(c, payload);
	tcase_add_test(c, inertia);
	tcase_add_test(c, parts);
	suite_add_tcase(suite, c);
	return suite_run(suite);
}
