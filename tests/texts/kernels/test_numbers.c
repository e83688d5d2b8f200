/* Constants in a table: each stands at the place by which a statement names it, and kernels find it there; which texts have
   tables. */
#include "launched.h"
#include "support/exhaustive.h"
#include "support/suite.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { COUNT = 300, SEED = 20261128, LIMIT = 4096 };

static const struct subject {
	const char *robot, *scene;
	enum rneagen_layout layout;
	int floating, is_long; /* to compile */
} SUBJECTS[] = {
	{"g1_29dof", "want qdd\n", RNEAGEN_SOA, 0, 0},
	{"atlas", "want qdd\n", RNEAGEN_AOS, 0, 1},
	{"atlas", "want tau,dtau_dq,dtau_dqd\n", RNEAGEN_SOA, 0, 1},
	{"panda", "want qdd,dqdd_dq,dqdd_dqd\n", RNEAGEN_SOA, 0, 1},
	{"hyq", "want tau,dtau_dq,dtau_dqd\n", RNEAGEN_SOA, 1, 1},
};

static void generate(const struct subject *s, enum rneagen_precision precision, enum rneagen_target target, struct target *t)
{
	struct rneagen_options o = rneagen_options_default();

	o.layout = s->layout;
	o.precision = precision;
	o.target = target;
	launched_generate(t, s->robot, s->scene, s->floating, &o);
}

/* A table's numbers; returns how many. *at moves on behind it; 0: there is none. */
static int read_table(const char **at, double *numbers)
{
	const char *head = strstr(*at, "static __constant__ double ");
	int said, count = 0;
	char *end;

	if (!head || !(head = strstr(head, "_numbers[")))
		return 0;
	said = atoi(head + strlen("_numbers["));
	for (const char *x = strchr(head, '{') + 1; count < LIMIT; x = end + strspn(end, ", ")) {
		numbers[count] = strtod(x, &end);
		if (end == x)
			break;
		count++;
	}
	ck_assert_int_eq(count, said);
	*at = strchr(head, '}');
	return count;
}

/* Statements up to the next table, or to the end of the text: returns how many places they name. */
static int check_statements(const char *from, const char *end, const double *numbers, int count)
{
	unsigned char named[LIMIT] = {0};
	int uses = 0;

	for (const char *x = from; (x = strstr(x, "RNEA_NUMBER(")) && x < end; x++) {
		char *comma;
		long place = strtol(x + strlen("RNEA_NUMBER("), &comma, 10);

		if (*comma != ',')
			continue; /* the macro */
		ck_assert_msg(place >= 0 && place < count, "place %ld of %d", place, count);
		ck_assert_msg(strtod(comma + 1, NULL) == numbers[place], "place %ld holds %.17g: %.40s", place, numbers[place], x);
		named[place] = 1;
		uses++;
	}
	for (int i = 0; i < count; i++)
		ck_assert_msg(named[i], "nobody names place %d", i);
	return uses;
}

/* Returns how many uses there are. All tables have room in 64 KB of constant memory, beside what else there is. */
static int check_places(const char *source)
{
	static double numbers[LIMIT];
	const char *at = source, *next;
	int uses = 0, all = 0, count;

	while ((count = read_table(&at, numbers))) {
		all += count;
		next = strstr(at, "\n#undef RNEA_NUMBER");
		uses += check_statements(at, next ? next : at + strlen(at), numbers, count);
	}
	ck_assert_int_le(all, 6144);
	return uses;
}

START_TEST(test_values)
{
	const struct subject *s = &SUBJECTS[_i];
	struct target t;
	struct launch x, y;
	int uses;

	if (s->is_long && !exhaustive())
		return;
	generate(s, RNEAGEN_F64, RNEAGEN_TARGET_CUDA, &t);
	uses = check_places(t.text.source);
	ck_assert_int_gt(uses, 500);
	x = launched_run(launched_open(&t, RNEA_BACKEND_CUDA, 0), COUNT, SEED, s->floating);
	y = launched_run(launched_open(&t, RNEA_BACKEND_HOST, 0), COUNT, SEED, s->floating); /* C, which has no table */
	printf("%s, %d uses: within %.1e, seed %d\n", s->robot, uses, launched_distance(&x, &y, s->robot), SEED);
	ck_assert_double_lt(launched_distance(&x, &y, s->robot), 1e-9);
	launched_free(&x);
	launched_free(&y);
	rneagen_result_free(&t.text);
}
END_TEST

static void expect_none(const char *robot, const char *scene, enum rneagen_precision precision, enum rneagen_target target)
{
	const struct subject s = {robot, scene, RNEAGEN_SOA, 0, 0};
	struct target t;

	generate(&s, precision, target, &t);
	ck_assert_msg(!strstr(t.text.source, "RNEA_NUMBER"), "%s, %s", robot, scene);
	rneagen_result_free(&t.text);
}

/* More constants in all than constant memory has room for: 30 parts of a robot of 75 joints. */
START_TEST(test_room)
{
	struct rneagen_options o = rneagen_options_default();
	struct target t;

	if (!exhaustive())
		return;
	o.precision = RNEAGEN_F64;
	o.parts = 30;
	launched_generate(&t, "chain_75", "want tau,dtau_dq,dtau_dqd\n", 0, &o);
	ck_assert_int_gt(check_places(t.text.source), 10000);
	rneagen_result_free(&t.text);
}
END_TEST

/* Floats, C, torques, a vjp, and few operations. */
START_TEST(test_none)
{
	expect_none("g1_29dof", "want qdd\n", RNEAGEN_F32, RNEAGEN_TARGET_CUDA);
	expect_none("g1_29dof", "want qdd\n", RNEAGEN_F64, RNEAGEN_TARGET_C);
	expect_none("chain_75", "want tau\n", RNEAGEN_F64, RNEAGEN_TARGET_CUDA);
	expect_none("g1_29dof", "want tau,vjp\n", RNEAGEN_F64, RNEAGEN_TARGET_CUDA);
	expect_none("hyq", "want tau,dtau_dq,dtau_dqd\n", RNEAGEN_F64, RNEAGEN_TARGET_CUDA);
}
END_TEST

int main(void)
{
	Suite *s = suite_create("numbers");

	launched_pretend();
	suite_add(s, "values", test_values, sizeof SUBJECTS / sizeof *SUBJECTS, 300);
	suite_add(s, "room", test_room, 1, 300);
	suite_add(s, "none", test_none, 1, 120);
	return suite_run(s);
}
