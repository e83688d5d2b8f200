/* What is given costs nothing: rows and whole inputs that are known or unread are no arguments of the text, nothing costs
   more for being known, and torques at rest are those of gravity. On random trees, seeds printed, and on robots. */
#define _POSIX_C_SOURCE 200809L
#include "support/exhaustive.h"
#include "support/suite.h"
#include "support/task/task.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { LINKS = 10 };
#define ROBOTS (sanitized() ? 20 : exhaustive() ? 80 : 24) /* random trees */

/* Is there an argument of this name? */
static int has(const struct scene_model *m, const char *name)
{
	return dag_find_argument(&m->dag, name) >= 0;
}

static void open_scene(struct task_case *c, struct scene_model *m)
{
	ck_assert_msg(!scene_open(m, c->urdf, &c->options), "%s; scene:\n%s", m->error.message, c->scene);
}

/* ---- arguments ---- */

/* Which of q, qd and qdd what is asked for cannot depend on. */
static const struct {
	enum task_kind kind;
	int no_qd, no_qdd;
} READS[] = {{TASK_GRAVITY, 1, 1}, {TASK_BIAS, 0, 1}, {TASK_TWIST, 0, 1}, {TASK_KINETIC, 0, 1}, {TASK_POTENTIAL, 1, 1}};

START_TEST(unread)
{
	int tried = 0;

	for (uint64_t seed = 1; seed <= (uint64_t)ROBOTS; seed++)
		for (size_t i = 0; i < sizeof READS / sizeof *READS; i++) {
			struct task_case *c = case_random(seed, LINKS, NO_ODD_NAMES);
			struct scene_model m;

			if (!c)
				continue;
			case_want(c, READS[i].kind, case_pick(c, case_moves));
			case_check(c, &m, "unread");
			ck_assert_msg(!READS[i].no_qd || !has(&m, "qd"), "seed %d: %s", (int)seed, c->scene);
			ck_assert_msg(!READS[i].no_qdd || !has(&m, "qdd"), "seed %d: %s", (int)seed, c->scene);
			scene_close(&m);
			case_close(c);
			tried++;
		}
	printf("unread inputs: %d scenes of random trees, seeds 1 to %d\n", tried, ROBOTS);
}
END_TEST

/* Each of q, qd and qdd as one list, as rows of joints, and as one number. */
START_TEST(given_whole)
{
	static const char *const names[] = {"q", "qd", "qdd"};

	for (uint64_t seed = 1; seed <= (uint64_t)ROBOTS; seed++) {
		struct task_case *c = case_random(seed, LINKS, NO_ODD_NAMES);
		int which = (int)(seed % 3), way = (int)(seed / 3 % 3);
		struct scene_model m;

		if (!c)
			continue;
		if (way == 0 || (way == 2 && which == 0))
			case_give_all(c, which, (double)NAN);
		else if (way == 2)
			case_give_all(c, which, 0.375);
		for (int j = 0; j < c->r->nj && way == 1; j++)
			if (case_has_rows(c, j))
				case_give(c, j, which);
		case_check(c, &m, "given");
		ck_assert_msg(!has(&m, names[which]), "seed %d: %s", (int)seed, c->scene);
		scene_close(&m);
		case_close(c);
	}
}
END_TEST

/* What a text reads stays: all of the inputs of an arm, without and with one joint given. */
START_TEST(read_stays)
{
	struct rneagen_options o = rneagen_options_default();
	size_t length;
	struct task_case *c = case_new(read_file(TEST_DIR "/robots/panda.urdf", &length), &o, 1);
	struct scene_model m;

	for (int i = 0; i < 2; i++) {
		case_check(c, &m, "panda");
		ck_assert(has(&m, "q") && has(&m, "qd") && has(&m, "qdd") && has(&m, "tau"));
		ck_assert_int_eq(m.dag.arguments[0].rows, c->r->nq);
		scene_close(&m);
		case_give(c, 3, i);
	}
	case_close(c);
}
END_TEST

/* ---- gravity ---- */

static real torque_at(const struct scene_model *m, const struct task_arrays *x, int row)
{
	return x->out[m->dag.argument_count - 1][row];
}

/* Torques at rest cost what the torques of gravity cost, and are the same to the bit. */
static void compare_rest(char *urdf, const struct rneagen_options *o, uint64_t seed, const char *name)
{
	static struct task_arrays rest, gravity;
	struct task_case *a = case_new(strdup(urdf), o, seed), *b = case_new(urdf, o, seed);
	struct scene_model ma, mb;

	case_give_all(a, 1, 0);
	case_give_all(a, 2, 0);
	case_want(b, TASK_GRAVITY, 0);
	case_check(a, &ma, name);
	case_check(b, &mb, name);
	ck_assert_msg(operation_total(&ma) == operation_total(&mb), "%s, seed %d: %zu operations, not %zu", name, (int)seed,
		operation_total(&ma), operation_total(&mb));
	case_feed(a, &ma, &rest);
	case_feed(b, &mb, &gravity);
	case_evaluate(&ma.dag, TASK_F64, &rest);
	case_evaluate(&mb.dag, TASK_F64, &gravity);
	for (int i = 0; i < a->r->nv; i++)
		ck_assert_msg(torque_at(&ma, &rest, i) == torque_at(&mb, &gravity, i), "%s, seed %d, row %d", name, (int)seed, i);
	scene_close(&ma);
	scene_close(&mb);
	case_close(a);
	case_close(b);
}

struct tour {
	int seen, count;
};

/* Every second robot, or all where all is asked for. */
static void rest_of(const char *path, const char *name, void *context)
{
	struct rneagen_options o = rneagen_options_default();
	struct tour *tour = context;
	size_t length;

	if (strncmp(name, "xfail_", 6) && (tour->seen++ % 2 == 0 || exhaustive())) {
		compare_rest(read_file(path, &length), &o, 1, name);
		tour->count++;
	}
}

START_TEST(at_rest)
{
	const char *folder = getenv("RNEAGEN_ROBOTS");
	struct tour tour = {0};

	for (uint64_t seed = 1; seed <= (uint64_t)ROBOTS; seed++) {
		struct task_case *c = case_random(seed, LINKS, NO_ODD_NAMES);

		if (c) {
			compare_rest(strdup(c->urdf), &c->options, seed, "random tree");
			case_close(c);
		}
	}
	for_each_urdf(TEST_DIR "/robots", rest_of, &tour);
	if (folder)
		for_each_urdf(folder, rest_of, &tour);
	else
		printf("skipped: further robots; set RNEAGEN_ROBOTS\n");
	printf("at rest: random trees, seeds 1 to %d, and %d robots\n", ROBOTS, tour.count);
}
END_TEST

/* ---- cost ---- */

/* By the URDF's constants: what a search for others finds for a task may cost more than what it finds for a larger one. */
static size_t cost(struct task_case *c)
{
	char *end = c->scene + strlen(c->scene);
	struct scene_model m;
	size_t n;

	strcpy(end, "params urdf\n");
	open_scene(c, &m);
	n = operation_total(&m);
	scene_close(&m);
	*end = '\0';
	return n;
}

/* One more thing given, then another on top: never dearer. */
static int never_rises(struct task_case *c, const char *name)
{
	char *before = c->scene + strlen(c->scene);
	size_t least = cost(c);
	int folds = 0;

	for (int j = 0; j < c->r->nj; j++)
		for (int which = 0; which < 3 && case_has_rows(c, j); which++, folds++) {
			size_t n;

			case_give(c, j, which);
			n = cost(c);
			ck_assert_msg(n <= least, "%s: %zu operations, more than %zu; scene:\n%s", name, n, least, c->scene);
			if (rng_chance(&c->rng, 0.5))
				*before = '\0';
			else
				least = n;
			before = c->scene + strlen(c->scene);
		}
	return folds;
}

static void cost_of(const char *path, const char *name, void *context)
{
	struct rneagen_options o = rneagen_options_default();
	struct task_case *c;
	int *count = context;
	size_t length;

	if (!strncmp(name, "xfail_", 6))
		return;
	c = case_new(read_file(path, &length), &o, 1);
	*count += never_rises(c, name);
	case_close(c);
}

START_TEST(no_dearer)
{
	int folds = 0;

	for (uint64_t seed = 1; seed <= (uint64_t)ROBOTS; seed++) {
		struct task_case *c = case_random(seed, LINKS, NO_ODD_NAMES);
		char name[64];

		if (!c)
			continue;
		snprintf(name, sizeof name, "random tree, seed %d", (int)seed);
		case_draw_wants(c);
		folds += never_rises(c, name);
		case_close(c);
	}
	for_each_urdf(TEST_DIR "/robots", cost_of, &folds);
	printf("%d folds, none of them dearer\n", folds);
	ck_assert_int_gt(folds, 1000);
}
END_TEST

/* A constant is no dearer than the same thing as an input. */
START_TEST(free_is_dearer)
{
	for (uint64_t seed = 1; seed <= (uint64_t)ROBOTS; seed++) {
		struct task_case *c = case_random(seed, LINKS, NO_ODD_NAMES);
		size_t constant, freed;

		if (!c)
			continue;
		constant = cost(c);
		case_draw_frees(c, 1);
		freed = cost(c);
		ck_assert_msg(constant <= freed, "seed %d: %zu operations, more than %zu; scene:\n%s", (int)seed, constant,
			freed, c->scene);
		case_close(c);
	}
}
END_TEST

int main(void)
{
	Suite *suite = suite_create("task_fold");
	TCase *c = tcase_create("fold");

	setvbuf(stdout, NULL, _IOLBF, 0);
	tcase_set_timeout(c, 300);
	tcase_add_test(c, unread);
	tcase_add_test(c, given_whole);
	tcase_add_test(c, read_stays);
	tcase_add_test(c, at_rest);
	tcase_add_test(c, no_dearer);
	tcase_add_test(c, free_is_dearer);
	suite_add_tcase(suite, c);
	return suite_run(suite);
}
