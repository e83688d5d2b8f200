/* A scene's inputs and outputs on random trees, seeds printed, and on robots: what it gives, frees, pushes and asks for,
   each alone and together, against the reference changed in the same way. */
#define _POSIX_C_SOURCE 200809L
#include "support/exhaustive.h"
#include "support/suite.h"
#include "support/task/task.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { LINKS = 12, EACH = 3 };
#define ROBOTS (sanitized() ? 30 : exhaustive() ? 60 : 24) /* random trees */

static void fold(struct task_case *c)
{
	case_draw_folds(c);
}

static void free_nominal(struct task_case *c)
{
	case_draw_frees(c, 1);
}

static void free_other(struct task_case *c)
{
	case_draw_frees(c, 0);
}

static void want(struct task_case *c)
{
	case_draw_wants(c);
}

static void push(struct task_case *c)
{
	case_draw_pushes(c);
}

static void own(struct task_case *c)
{
	case_draw_own(c);
}

/* Any of them together; tips and locks come first, as what follows is of joints that still move. */
static void any(struct task_case *c)
{
	static void (*const draws[])(struct task_case *c) = {case_draw_tips, case_draw_locks, fold, free_other, push, own, want};

	for (size_t i = 0; i < sizeof draws / sizeof *draws; i++)
		if (rng_chance(&c->rng, 0.5))
			draws[i](c);
}

static const struct subject {
	const char *name;
	void (*draw)(struct task_case *c);
	int odd_names;
} SUBJECTS[] = {{"fold", fold, 0}, {"free, as the URDF has it", free_nominal, 0}, {"free", free_other, 0},
	{"want", want, 0}, {"fext", push, 0}, {"armature, damping and friction", own, 0}, {"any", any, 0},
	{"any, of odd names", any, 1}};
enum { SUBJECT_COUNT = sizeof SUBJECTS / sizeof *SUBJECTS };

/* The random robots' joints have no damping and no friction: the seed gives them some. */
static char *with_damping(char *urdf, uint64_t seed)
{
	struct rng rng = rng_seed(seed + 5000);
	size_t length = strlen(urdf), count = 0;
	char *text, *to;

	for (const char *s = urdf; (s = strstr(s, "</joint>")); s++)
		count++;
	text = to = malloc(length + 96 * count + 1);
	for (const char *s = urdf, *next; *s; s = next) {
		next = strstr(s, "</joint>");
		if (!next) {
			strcpy(to, s);
			break;
		}
		memcpy(to, s, (size_t)(next - s));
		to += next - s;
		to += sprintf(to, "<dynamics damping='%.3f' friction='%.3f'/></joint>", rng_uniform(&rng, 0, 3),
			rng_uniform(&rng, 0, 3));
		next += strlen("</joint>");
		*to = '\0';
	}
	free(urdf);
	return text;
}

static void check_drawn(char *urdf, const struct rneagen_options *o, uint64_t seed, const struct subject *s, const char *name)
{
	char what[512];
	struct task_case *c = case_new(urdf, o, seed);

	snprintf(what, sizeof what, "%s, seed %llu, %s", name, (unsigned long long)seed, s->name);
	s->draw(c);
	case_checked(c, what);
	case_close(c);
}

START_TEST(random_trees)
{
	const struct subject *s = &SUBJECTS[_i];
	uint64_t robots = (uint64_t)(s->draw == any ? 4 * ROBOTS : ROBOTS);
	int tried = 0;

	for (uint64_t seed = 1; seed <= robots; seed++) {
		struct task_case *c = case_random(seed, LINKS, s->odd_names ? 0 : NO_ODD_NAMES);

		if (!c)
			continue;
		check_drawn(with_damping(strdup(c->urdf), seed), &c->options, seed, s, "random tree");
		case_close(c);
		tried++;
	}
	printf("%s: %d random trees, seeds 1 to %d\n", s->name, tried, (int)robots);
	ck_assert_int_gt(tried, (int)robots / 2);
}
END_TEST

static void check_robot(const char *path, const char *name, void *context)
{
	struct rneagen_options o = rneagen_options_default();
	int *count = context;
	size_t length;
	char *urdf;

	if (!strncmp(name, "xfail_", 6))
		return;
	urdf = read_file(path, &length);
	for (int i = 0; i < EACH; i++) {
		o.base = i ? RNEAGEN_FIXED : RNEAGEN_FLOATING;
		check_drawn(strdup(urdf), &o, (uint64_t)(100 * *count + i), &SUBJECTS[SUBJECT_COUNT - 1], name);
	}
	free(urdf);
	++*count;
}

START_TEST(robots)
{
	const char *folder = _i ? getenv("RNEAGEN_ROBOTS") : TEST_DIR "/robots";
	int count = 0;

	if (!folder) {
		printf("skipped: further robots; set RNEAGEN_ROBOTS\n");
		return;
	}
	for_each_urdf(folder, check_robot, &count);
	printf("%d robots, seeds 100 i to 100 i + %d\n", count, EACH - 1);
	ck_assert_int_gt(count, 0);
}
END_TEST

int main(void)
{
	Suite *suite = suite_create("task");
	TCase *c = tcase_create("equal");

	setvbuf(stdout, NULL, _IOLBF, 0);
	tcase_set_timeout(c, 300);
	tcase_add_loop_test(c, random_trees, 0, SUBJECT_COUNT);
	tcase_add_loop_test(c, robots, 0, 2);
	suite_add_tcase(suite, c);
	return suite_run(suite);
}
