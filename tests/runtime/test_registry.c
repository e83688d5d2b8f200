/* The registry of algorithms: catches an entry that says other arrays than it builds, a function that a text leaves out of its
   table or that cannot be launched by its name, and a role that the runtime calls by another word. */
#define _POSIX_C_SOURCE 200809L
#include "base/identifier.h"
#include "dynamics/registry.h"
#include "support/suite.h"
#include "urdf.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

#define ROBOT TEST_DIR "/robots/double_pendulum.urdf"

enum { COUNT = 5 };

START_TEST(words)
{
	static const char *const theirs[] = {
#define THEIR_WORD(role, word) word,
		RNEA_ROLES(THEIR_WORD)
#undef THEIR_WORD
	};

	ck_assert_int_eq(RNEA_ROLE_COUNT, ROLE_COUNT);
	for (int i = 0; i < ROLE_COUNT; i++)
		ck_assert_str_eq(role_word((enum role)i), theirs[i]);
}
END_TEST

START_TEST(entries)
{
	for (int i = 0; i < ALGORITHM_COUNT; i++) {
		const struct algorithm *x = ALGORITHMS[i];
		int outputs = 0;

		for (int k = 0; k < i; k++)
			ck_assert_str_ne(ALGORITHMS[k]->name, x->name);
		ck_assert_msg(identifier_is(x->name) && strlen(x->name) < 64, "%s", x->name);
		ck_assert_msg(x->doc && x->brief, "%s: no comment", x->name);
		for (const struct algorithm_array *a = x->arrays; a->name; a++) {
			ck_assert_msg(a->is_output || !outputs, "%s: an input after an output", x->name);
			outputs += a->is_output;
		}
		ck_assert_msg(outputs, "%s: no outputs", x->name);
	}
}
END_TEST

static void check_made_for(struct request k, const char *const *names, int count)
{
	const struct algorithm *found[ALGORITHM_COUNT];

	ck_assert_int_eq(algorithms_for(&k, found), count);
	for (int i = 0; i < count; i++)
		ck_assert_str_eq(found[i]->name, names[i]);
}

/* A text has the functions of what was asked for, its main one first. */
START_TEST(made_for)
{
	static const char *const plain[] = {"rnea", "fpass", "bpass"}, *const scene[] = {"rnea"}, *const forward[] = {"fd"},
		*const motion[] = {"kin"};

	check_made_for((struct request){.is_plain = 1}, plain, 3);
	check_made_for((struct request){.is_plain = 0}, scene, 1);
	check_made_for((struct request){.is_forward = 1}, forward, 1);
	check_made_for((struct request){.is_motion = 1}, motion, 1);
}
END_TEST

/* An algorithm that is not in the list is declared as one that is. */
START_TEST(declared)
{
	static const struct algorithm toy = {.name = "toy", .arrays = {{"q", ROLE_JOINT_POSITION, 0}, {"g", ROLE_GRAVITY, 0},
		{"f", ROLE_BODY_WRENCHES, 0}, {"wrench", ROLE_LINK_WRENCH, 0}, {"energy", ROLE_KINETIC_ENERGY, 1},
		{"tau", ROLE_JOINT_TORQUE, 1}}};
	const struct tree t = {.nq = 8, .nv = 7, .body_count = 2};
	const int rows[] = {8, 3, 12, 6, 1, 7};
	struct arena a;
	struct dag d;

	arena_init(&a, NULL);
	dag_init(&d, &a);
	algorithm_declare(&toy, &d, &t);
	ck_assert_int_eq(d.argument_count, 6);
	for (int i = 0; i < 6; i++) {
		ck_assert_str_eq(d.arguments[i].name, toy.arrays[i].name);
		ck_assert_int_eq(d.arguments[i].rows, rows[i]);
		ck_assert_int_eq(dag_find_role(&d, toy.arrays[i].role, toy.arrays[i].is_output), i);
	}
	ck_assert_int_eq(dag_find_role(&d, ROLE_JOINT_TORQUE, 0), -1);
	arena_free(&a);
}
END_TEST

static void check_function(const struct rnea_robot *robot, const struct algorithm *x, const struct rnea_function *f)
{
	double *arrays[ALGORITHM_ARRAYS] = {0};
	struct rnea_error e;
	size_t n = 0;

	ck_assert_str_eq(f->name, x->name);
	for (; x->arrays[n].name; n++) {
		const struct rnea_argument *a = &f->arguments[n];

		ck_assert_str_eq(a->name, x->arrays[n].name);
		ck_assert_int_eq(a->role, (int)x->arrays[n].role);
		ck_assert(a->scalar == RNEA_F64 && (n >= f->input_count) == x->arrays[n].is_output);
		arrays[n] = malloc(COUNT * a->rows * sizeof(double));
		for (size_t i = 0; i < COUNT * a->rows; i++)
			arrays[n][i] = x->arrays[n].is_output ? (double)NAN : 0.25 * (double)i;
	}
	ck_assert_uint_eq(f->input_count + f->output_count, n);
	ck_assert_uint_eq(rnea_argument_count(robot, x->name), n);
	ck_assert_msg(!rnea_launch_kernel(robot, x->name, (void *const *)arrays, COUNT, NULL, &e), "%s", e.message);
	for (size_t k = 0; k < n; k++)
		for (size_t i = 0; i < COUNT * f->arguments[k].rows; i++)
			ck_assert_msg(!isnan(arrays[k][i]), "%s: %s[%zu] was not written", x->name, f->arguments[k].name, i);
	for (size_t k = 0; k < n; k++)
		free(arrays[k]);
}

/* The functions of a text in the order of the registry, the first of them `first`; returns how many there are. */
static int check_text(const char *scene, int first)
{
	struct rneagen_options g = rneagen_options_default();
	struct rnea_options o = {.backend = RNEA_BACKEND_HOST, .cache = ""};
	struct rnea_robot *robot;
	struct rnea_error e;
	int count;

	g.precision = RNEAGEN_F64;
	g.scene = scene;
	ck_assert_msg(!rnea_open_urdf(ROBOT, &g, &o, &robot, &e), "%s", e.message);
	count = (int)rnea_info(robot)->function_count;
	ck_assert_int_eq(rnea_bind_role(robot, ALGORITHMS[first]->name, RNEA_ROLE_JOINT_POSITION, NULL), rnea_bind(robot, "q"));
	ck_assert_int_eq(rnea_bind_role(robot, ALGORITHMS[first]->name, RNEA_ROLE_JOINT_VELOCITY, NULL), rnea_bind(robot, "qd"));
	ck_assert_int_eq(rnea_bind_role(robot, ALGORITHMS[first]->name, RNEA_ROLE_JOINT_ACCELERATION, NULL),
		rnea_bind(robot, "qdd"));
	for (int i = 0; i < count; i++)
		check_function(robot, ALGORITHMS[first + i], &rnea_info(robot)->functions[i]);
	rnea_close(robot);
	return count;
}

/* Every function of the registry is in a text without a scene, or in one that wants qdd, or a place alone, in its
   table, and can be launched. */
START_TEST(launched)
{
	int inverse = check_text(NULL, ALGORITHM_rnea), forward = check_text("want qdd\n", ALGORITHM_fd);
	int motion = check_text("want com\n", ALGORITHM_kin);

	ck_assert_int_eq(inverse + forward + motion, ALGORITHM_COUNT);
}
END_TEST

/* A scene's arrays are found by what they mean and what they are of. */
START_TEST(bound)
{
	struct rneagen_options g = rneagen_options_default();
	struct rnea_options o = {.backend = RNEA_BACKEND_HOST, .cache = ""};
	struct rnea_robot *robot;
	struct rnea_error e;

	g.scene = "free gravity,payload.lower,offset.elbow\nwant tau,M,dtau_dq,dtau_dpayload.lower,twist.upper,jvp,regressor\n"
		  "fext lower\n";
	ck_assert_msg(!rnea_open_urdf(ROBOT, &g, &o, &robot, &e), "%s", e.message);
	ck_assert_uint_eq(rnea_info(robot)->function_count, 1);
	const struct {
		enum rnea_role role;
		const char *of, *name;
	} found[] = {{RNEA_ROLE_JOINT_POSITION, NULL, "q"}, {RNEA_ROLE_GRAVITY, "", "gravity"},
		{RNEA_ROLE_LINK_PAYLOAD, "lower", "payload_lower"}, {RNEA_ROLE_JOINT_OFFSET, "elbow", "offset_elbow"},
		{RNEA_ROLE_LINK_WRENCH, NULL, "fext_lower"}, {RNEA_ROLE_TANGENT, NULL, "jvp_v"},
		{RNEA_ROLE_JOINT_TORQUE, NULL, "tau"}, {RNEA_ROLE_MASS_MATRIX, NULL, "M"},
		{RNEA_ROLE_DTAU_DQ, NULL, "dtau_dq"}, {RNEA_ROLE_JVP, NULL, "jvp"},
		{RNEA_ROLE_REGRESSOR, NULL, "regressor"},
		{RNEA_ROLE_DTAU_DFREED, "payload.lower", "dtau_dpayload_lower"},
		{RNEA_ROLE_LINK_TWIST, "upper", "twist_upper"}};
	for (size_t i = 0; i < sizeof found / sizeof *found; i++)
		ck_assert_msg(rnea_bind_role(robot, "rnea", found[i].role, found[i].of) == rnea_bind(robot, found[i].name) &&
			rnea_bind(robot, found[i].name) >= 0, "%s", found[i].name);
	ck_assert_int_eq(rnea_bind_role(robot, "rnea", RNEA_ROLE_LINK_PAYLOAD, "upper"), -1);
	ck_assert_int_eq(rnea_bind_role(robot, "rnea", RNEA_ROLE_POWER, NULL), -1);
	rnea_close(robot);
}
END_TEST

int main(void)
{
	Suite *s = suite_create("registry");
	TCase *c = tcase_create("registry");

	tcase_set_timeout(c, 60);
	tcase_add_test(c, words);
	tcase_add_test(c, entries);
	tcase_add_test(c, made_for);
	tcase_add_test(c, declared);
	tcase_add_test(c, launched);
	tcase_add_test(c, bound);
	suite_add_tcase(s, c);
	return suite_run(s);
}
