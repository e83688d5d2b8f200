/* Texts for target C, compiled and run: against the independent reference, the evaluated DAG and themselves.
   Own robots and real ones (RNEAGEN_ROBOTS); fixed and floating; both precisions and layouts; all trigonometry modes;
   whole and in short segments: each robot in one text, or our own in two where all is asked for, and each pair of
   options in some text. Once found: a sign of zero (DAG and text), an input that is not finite and reaches another
   sample of its batch. */
#define _POSIX_C_SOURCE 200809L
#include "support/exhaustive.h"
#include "support/pairs.h"
#include "support/suite.h"
#include "target/target_check.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Compilers take long over the texts of robots with this many bodies; of the others every third is optimised, or every
   second where all is asked for. */
enum { STATES = 300, LARGE = 100, SEED = 7, DEEP = 40, SHORT = 40 };
enum { PRECISION, LAYOUT, TRIG, BASE, SEGMENTS, OPTIONS }; /* columns of the table */

struct session {
	struct worst worst[2]; /* f64, f32 */
	int real, robots, turn;
	struct pairs pairs;
};

static int is_legged(const char *name)
{
	static const char *const legged[] = {"anymal_kinova", "atlas", "g1_29dof", "g1_brainco", "go1", "go2", "hyq",
		"jvrc1", "mini_cheetah", "romeo", "simple_humanoid", "solo12", "spot", "upkie"};

	for (size_t i = 0; i < sizeof legged / sizeof *legged; i++)
		if (!strncmp(name, legged[i], strlen(legged[i])) && !strcmp(name + strlen(legged[i]), ".urdf"))
			return 1;
	return 0;
}

static void check_text(int is_real, int optimise, struct worst *worst, struct model *m, const struct states *states,
	const char *urdf, size_t length, const struct rneagen_options *o, const char *stem)
{
	static const struct compiler optimising = {"gcc", {"-O1"}}, slow = {"gcc", {"-O0", "-Dalways_inline=unused"}},
				     quick = {"clang", {"-O0", "-Dalways_inline=unused"}};
	const int deep = exhaustive() ? DEEP : DEEP / 2;
	struct target t;
	struct check c = {.target = &t, .model = m, .states = states, .real = is_real, .exact = 1, .worst = worst};

	target_open(&t, urdf, length, o,
		m->tree.body_count < deep && optimise ? &optimising
		: compiler_lacks(&quick, 0)	      ? &slow
						      : &quick,
		stem);
	check_rnea(&c);
	check_batch(&c);
	check_passes(&c);
	check_nonfinite(&c);
	target_close(&t);
}

static void check_options(struct session *s, const char *urdf, size_t length, const char *name, const int *row)
{
	struct rneagen_options o = rneagen_options_default();
	int f32 = row[PRECISION];
	struct worst worst = {0};
	struct states states;
	struct model m;
	char stem[256];

	o.target = RNEAGEN_TARGET_C;
	o.base = row[BASE] && (!s->real || is_legged(name)) ? RNEAGEN_FLOATING : RNEAGEN_FIXED;
	o.precision = f32 ? RNEAGEN_F32 : RNEAGEN_F64;
	o.layout = (enum rneagen_layout)row[LAYOUT];
	o.trig = (enum rneagen_trig)row[TRIG];
	o.segments = row[SEGMENTS] ? SHORT : RNEAGEN_SEGMENTS_AUTO;
	model_open(&m, urdf, length, &o, name);
	states = states_new(&m, SEED, STATES, f32, !s->real);
	states.count = o.trig == RNEAGEN_ACCURATE ? STATES : STATES - LARGE; /* the last have large angles */
	snprintf(stem, sizeof stem, "%s_%.*s_%d%d", s->real ? "real" : "own", (int)(strlen(name) - 5), name, o.base, s->turn);
	check_text(s->real, s->turn % (exhaustive() ? 2 : 3) == 0, &worst, &m, &states, urdf, length, &o, stem);
	printf("%-34s %-8s %s %.1e\n", name, o.base ? "floating" : "fixed", f32 ? "f32" : "f64", worst.norm);
	worst_merge(&s->worst[f32], &worst);
	states_free(&states);
	model_close(&m);
}

static void check_robot(const char *path, const char *name, void *context)
{
	struct session *s = context;
	int texts = exhaustive() && !s->real ? 2 : 1;
	size_t length;
	char *urdf;

	if (!strncmp(name, "xfail_", 6))
		return;
	urdf = read_file(path, &length);
	ck_assert_msg(urdf != NULL, "%s cannot be read", path);
	for (int i = 0; i < texts; i++, s->turn++)
		check_options(s, urdf, length, name, s->pairs.rows[s->turn % s->pairs.count]);
	s->robots++;
	free(urdf);
}

static void session_begin(struct session *s)
{
	s->pairs = (struct pairs){.factors = OPTIONS,
		.levels = {[PRECISION] = 2, [LAYOUT] = 2, [TRIG] = 3, [BASE] = 2, [SEGMENTS] = 2}};
	pairs_draw(&s->pairs, SEED);
}

static void report(const struct session *s)
{
	printf("%d texts of %d %s robots, %d states a text, seed %d\n", s->turn, s->robots,
		s->real ? "real" : "own", STATES, SEED);
	worst_report(&s->worst[0], "c f64");
	worst_report(&s->worst[1], "c f32");
}

START_TEST(own_robots)
{
	struct session s = {0};

	session_begin(&s);
	for_each_urdf(TEST_DIR "/robots", check_robot, &s);
	ck_assert_int_ge(s.robots, 32);
	report(&s);
}
END_TEST

START_TEST(real_robots)
{
	const char *folder = getenv("RNEAGEN_ROBOTS");
	struct session s = {.real = 1};

	if (!folder) {
		printf("skipped: RNEAGEN_ROBOTS is not set\n");
		return;
	}
	session_begin(&s);
	for_each_urdf(folder, check_robot, &s);
	ck_assert_int_gt(s.robots, 0);
	report(&s);
}
END_TEST

int main(void)
{
	Suite *suite = suite_create("targets");

	setvbuf(stdout, NULL, _IOLBF, 0);
	suite_add(suite, "own", own_robots, 1, 1200);
	suite_add(suite, "real", real_robots, 1, 1200);
	return suite_run(suite);
}
