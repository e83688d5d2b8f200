/* The DAG against the independent reference: robots of our own, real ones, random trees; twice as many states and trees where all
   is asked for, and a few states of each under the sanitizers. */
#include "tally.h"
#include "support/exhaustive.h"
#include "support/random_robot.h"
#include "support/suite.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* What the evaluated DAG may be off. A real robot: ||tau - ref|| / ||ref||, worst of the samples. Any robot: each torque
   by the magnitudes that were summed, since small ones can cancel; and never more than the running error bound. */
#define LIMIT_F64 5e-14
#define LIMIT_F32 3e-6

enum { SAMPLES = 200, FEW_SAMPLES = 120, RANDOM_ROBOTS = 80, RANDOM_SAMPLES = 8, MORE = 2 };

static void check_model(struct tally *t, const char *urdf, size_t length, const struct rneagen_options *o, const char *what,
	uint64_t seed, int samples)
{
	struct model_error f64, f32;
	struct model m;

	model_open(&m, urdf, length, o, what);
	f64 = model_error_f64(&m, seed, samples);
	f32 = model_error_f32(&m, seed + 1, samples);
	if (samples >= FEW_SAMPLES)
		printf("%-34s %-8s f64 %.1e rms %.1e, %.2f eps S; f32 %.1e rms %.1e, %.2f eps S\n", what,
			o->base == RNEAGEN_FLOATING ? "floating" : "fixed", f64.max, f64.rms, f64.terms, f32.max, f32.rms,
			f32.terms);
	tally_model(t, what, f64, f32, LIMIT_F64, LIMIT_F32);
	model_close(&m);
}

static int sample_count(void)
{
	return sanitized() ? RANDOM_SAMPLES : exhaustive() ? SAMPLES : FEW_SAMPLES;
}

static void check_robot(const char *path, const char *name, void *context)
{
	struct rneagen_options o = rneagen_options_default();
	size_t length;
	char *urdf;

	if (!strncmp(name, "xfail_", 6))
		return;
	urdf = read_file(path, &length);
	check_model(context, urdf, length, &o, name, 1, sample_count());
	o.base = RNEAGEN_FLOATING;
	check_model(context, urdf, length, &o, name, 3, sample_count());
	free(urdf);
}

static void report(const struct tally *t, const char *what)
{
	printf("%d %s: worst f64 %.2e, f32 %.2e, %.2f eps of the magnitudes summed, %.2f of the running bound\n", t->count, what,
		t->f64, t->f32, t->terms, t->bound);
}

START_TEST(test_own_robots)
{
	struct tally t = {0};

	for_each_urdf(TEST_DIR "/robots", check_robot, &t);
	ck_assert_int_ge(t.count, 2 * 28);
	report(&t, "models of own robots, seeds 1 to 4");
}
END_TEST

START_TEST(test_real_robots)
{
	const char *folder = getenv("RNEAGEN_ROBOTS");
	struct tally t = {.real = 1};

	if (!folder) {
		printf("skipped: RNEAGEN_ROBOTS is not set\n");
		return;
	}
	for_each_urdf(folder, check_robot, &t);
	ck_assert_int_eq(t.count, 2 * 41);
	report(&t, "models of real robots, seeds 1 to 4");
}
END_TEST

START_TEST(test_random_trees)
{
	struct tally t = {0};

	for (uint64_t seed = 1; seed <= (exhaustive() ? MORE * RANDOM_ROBOTS : RANDOM_ROBOTS); seed++) {
		struct random_robot_knobs knobs = random_robot_knobs(seed, 2 + (int)(seed % 24));
		struct rneagen_options o = rneagen_options_default();
		char *urdf = random_robot(seed, &knobs), what[64];

		snprintf(what, sizeof what, "random robot, seed %llu", (unsigned long long)seed);
		o.base = seed % 3 ? RNEAGEN_FIXED : RNEAGEN_FLOATING;
		o.mimic = seed % 5 ? RNEAGEN_MIMIC_HONOUR : RNEAGEN_MIMIC_INDEPENDENT;
		o.gravity[0] = seed % 2 ? 0 : 1.5;
		check_model(&t, urdf, strlen(urdf), &o, what, seed, RANDOM_SAMPLES);
		free(urdf);
	}
	report(&t, "random trees, seeds from 1");
}
END_TEST

int main(void)
{
	Suite *suite = suite_create("rnea");
	TCase *c = tcase_create("reference");

	setvbuf(stdout, NULL, _IOLBF, 0);
	tcase_set_timeout(c, 600);
	tcase_add_test(c, test_own_robots);
	tcase_add_test(c, test_real_robots);
	tcase_add_test(c, test_random_trees);
	suite_add_tcase(suite, c);
	return suite_run(suite);
}
