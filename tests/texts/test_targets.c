/* Texts for target C, compiled and run: against the independent reference, the evaluated DAG and themselves.
   Own robots and real ones (RNEAGEN_ROBOTS); fixed and floating; both precisions and layouts; all trigonometry modes.
 */
#define _POSIX_C_SOURCE 200809L
#include "support/suite.h"
#include "target/target_check.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Compilers take long over the texts of robots with this many bodies. */
enum { STATES = 1000, SMALL_STATES = 900, SEED = 7, DEEP = 40 };

struct session {
	struct worst worst[2]; /* f64, f32 */
	int real, robots;
};

/* One text. Robots with many bodies have the first two alone. */
struct variant {
	enum rneagen_precision precision;
	enum rneagen_layout layout;
	enum rneagen_trig trig;
};

static const struct variant FIXED[] = {{RNEAGEN_F64, RNEAGEN_SOA, RNEAGEN_ACCURATE},
	{RNEAGEN_F32, RNEAGEN_AOS, RNEAGEN_ACCURATE}, {RNEAGEN_F64, RNEAGEN_AOS, RNEAGEN_BOUNDED},
	{RNEAGEN_F32, RNEAGEN_SOA, RNEAGEN_FAST}};
static const struct variant FLOATING[] = {{RNEAGEN_F64, RNEAGEN_AOS, RNEAGEN_ACCURATE},
	{RNEAGEN_F32, RNEAGEN_SOA, RNEAGEN_BOUNDED}, {RNEAGEN_F64, RNEAGEN_SOA, RNEAGEN_FAST}};

static int is_legged(const char *name)
{
	static const char *const legged[] = {"anymal_kinova", "atlas", "g1_29dof", "g1_brainco", "go1", "go2", "hyq",
		"jvrc1", "mini_cheetah", "romeo", "simple_humanoid", "solo12", "spot", "upkie"};

	for (size_t i = 0; i < sizeof legged / sizeof *legged; i++)
		if (!strncmp(name, legged[i], strlen(legged[i])) && !strcmp(name + strlen(legged[i]), ".urdf"))
			return 1;
	return 0;
}

static void check_text(int is_real, struct worst *worst, struct model *m, const struct states *states, const char *urdf,
	size_t length, const struct rneagen_options *o, const char *stem)
{
	static const struct compiler optimising = {"gcc", {"-O1"}}, quick = {"gcc", {"-O0"}};
	struct target t;
	struct check c = {.target = &t, .model = m, .states = states, .real = is_real, .exact = 1, .worst = worst};

	target_open(&t, urdf, length, o, m->tree.body_count < DEEP ? &optimising : &quick, stem);
	check_rnea(&c);
	check_batch(&c);
	check_passes(&c);
	check_nonfinite(&c);
	target_close(&t);
}

static void check_base(struct session *s, const char *urdf, size_t length, const char *name, enum rneagen_base base)
{
	const struct variant *variants = base == RNEAGEN_FIXED ? FIXED : FLOATING;
	size_t count = base == RNEAGEN_FIXED ? sizeof FIXED / sizeof *FIXED : sizeof FLOATING / sizeof *FLOATING;
	struct rneagen_options o = rneagen_options_default();
	struct worst worst[2] = {0};
	struct states states[2];
	struct model m;
	char stem[256];

	o.target = RNEAGEN_TARGET_C;
	o.base = base;
	model_open(&m, urdf, length, &o, name);
	for (int f32 = 0; f32 < 2; f32++)
		states[f32] = states_new(&m, SEED, STATES, f32, !s->real);
	for (size_t i = 0; i < count && (i < 2 || m.tree.body_count < DEEP); i++) {
		o.precision = variants[i].precision;
		o.layout = variants[i].layout;
		o.trig = variants[i].trig;
		states[0].count = states[1].count = o.trig == RNEAGEN_ACCURATE ? STATES : SMALL_STATES;
		snprintf(stem, sizeof stem, "%s_%.*s_%d%zu", s->real ? "real" : "own", (int)(strlen(name) - 5), name,
			base, i);
		check_text(s->real, &worst[o.precision == RNEAGEN_F32], &m, &states[o.precision == RNEAGEN_F32], urdf,
			length, &o, stem);
	}
	printf("%-34s %-8s f64 %.1e, f32 %.1e\n", name, base ? "floating" : "fixed", worst[0].norm, worst[1].norm);
	for (int f32 = 0; f32 < 2; f32++) {
		worst_merge(&s->worst[f32], &worst[f32]);
		states_free(&states[f32]);
	}
	model_close(&m);
}

static void check_robot(const char *path, const char *name, void *context)
{
	struct session *s = context;
	size_t length;
	char *urdf;

	if (!strncmp(name, "xfail_", 6))
		return;
	urdf = read_file(path, &length);
	ck_assert_msg(urdf != NULL, "%s cannot be read", path);
	check_base(s, urdf, length, name, RNEAGEN_FIXED);
	if (!s->real || is_legged(name))
		check_base(s, urdf, length, name, RNEAGEN_FLOATING);
	s->robots++;
	free(urdf);
}

static void report(const struct session *s)
{
	printf("%d %s robots, %d states a text, seed %d\n", s->robots, s->real ? "real" : "own", STATES, SEED);
	worst_report(&s->worst[0], "c f64");
	worst_report(&s->worst[1], "c f32");
}

START_TEST(own_robots)
{
	struct session s = {0};

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
