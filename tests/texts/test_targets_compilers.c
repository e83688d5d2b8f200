/* A few robots by every compiler setting, in every precision, layout and trigonometry mode. */
#define _POSIX_C_SOURCE 200809L
#include "support/suite.h"
#include "target/target_check.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* How texts are compiled, and whether the bits are those of the DAG: they are not where the compiler is free to join
   products and sums as it likes. */
struct setting {
	struct compiler compiler;
	int needs_fma, exact, fused;
};

static const struct setting SETTINGS[] = {
	{{"gcc", {"-O0"}}, 0, 1, 0},
	{{"gcc", {"-O2"}}, 0, 1, 0},
	{{"gcc", {"-O3", "-mfma"}}, 1, 1, 1},
	{{"gcc", {"-O3", "-march=haswell", "-std=gnu11"}}, 1, 0, 0},
	{{"gcc", {"-O1", "-fsanitize=undefined", "-fno-sanitize-recover=all"}}, 0, 1, 0},
	{{"clang", {"-O0"}}, 0, 1, 0},
	{{"clang", {"-O2"}}, 0, 1, 0},
	{{"clang", {"-O3", "-mfma"}}, 1, 0, 0},
};

enum { SETTING_COUNT = sizeof SETTINGS / sizeof *SETTINGS, STATES = 300, SEED = 21 };

static struct worst worst[2];

/* With a word where a setting cannot be tried. */
static int is_possible(const struct setting *s)
{
	const char *why = compiler_lacks(&s->compiler, s->needs_fma);

	if (why)
		printf("skipped: %s %s: %s\n", s->compiler.command, s->compiler.flags[0], why);
	return !why;
}

static void check_text(struct model *m, const struct states *states, const char *urdf, size_t length,
	const struct rneagen_options *o, const struct setting *setting, const char *name)
{
	struct target t;
	struct check c = {.target = &t,
		.model = m,
		.states = states,
		.exact = setting->exact,
		.fused = setting->fused,
		.worst = &worst[o->precision == RNEAGEN_F32]};
	char stem[128];

	snprintf(
		stem, sizeof stem, "by_%s_%d%d%d%d", name, (int)(setting - SETTINGS), o->precision, o->layout, o->trig);
	target_open(&t, urdf, length, o, &setting->compiler, stem);
	check_rnea(&c);
	check_batch(&c);
	check_passes(&c);
	check_nonfinite(&c);
	target_close(&t);
}

struct robot_choice {
	const char *name;
	enum rneagen_base base;
	int all; /* every combination, else two */
};

static void check_options(struct model *m, struct states *states, const char *urdf, size_t length,
	struct rneagen_options *o, const struct setting *setting, const struct robot_choice *choice)
{
	for (int precision = RNEAGEN_F32; precision <= RNEAGEN_F64; precision++)
		for (int layout = RNEAGEN_SOA; layout <= RNEAGEN_AOS; layout++)
			for (int trig = RNEAGEN_ACCURATE; trig <= RNEAGEN_FAST; trig++) {
				struct states *s = &states[precision == RNEAGEN_F32];

				if (!choice->all &&
					(precision == RNEAGEN_F64 ? layout != RNEAGEN_SOA || trig != RNEAGEN_ACCURATE
								  : layout != RNEAGEN_AOS || trig != RNEAGEN_BOUNDED))
					continue;
				o->precision = (enum rneagen_precision)precision;
				o->layout = (enum rneagen_layout)layout;
				o->trig = (enum rneagen_trig)trig;
				s->count = trig == RNEAGEN_ACCURATE ? STATES
								    : STATES - 100; /* the last have large angles */
				check_text(m, s, urdf, length, o, setting, choice->name);
			}
}

static void check_setting(const struct setting *setting, const struct robot_choice *choice)
{
	struct rneagen_options o = rneagen_options_default();
	struct states states[2];
	struct model m;
	size_t length;
	char *urdf = target_robot(choice->name, &length);

	o.target = RNEAGEN_TARGET_C;
	o.base = choice->base;
	model_open(&m, urdf, length, &o, choice->name);
	for (int f32 = 0; f32 < 2; f32++)
		states[f32] = states_new(&m, SEED, STATES, f32, 1);
	check_options(&m, states, urdf, length, &o, setting, choice);
	states_free(&states[0]);
	states_free(&states[1]);
	model_close(&m);
	free(urdf);
}

START_TEST(setting)
{
	static const struct robot_choice robots[] = {{"iiwa14", RNEAGEN_FIXED, 1}, {"hyq", RNEAGEN_FLOATING, 0},
		{"panda", RNEAGEN_FIXED, 0}, {"mimic_chain", RNEAGEN_FLOATING, 0}, {"planar_tilted", RNEAGEN_FIXED, 0},
		{"floating_joint", RNEAGEN_FIXED, 0}, {"prismatic_skew", RNEAGEN_FIXED, 0},
		{"all_zero_torque", RNEAGEN_FIXED, 0}, {"odd_names", RNEAGEN_FIXED, 0}};
	const struct setting *s = &SETTINGS[_i];
	char what[64];

	if (!is_possible(s))
		return;
	for (size_t i = 0; i < sizeof robots / sizeof *robots; i++)
		check_setting(s, &robots[i]);
	snprintf(what, sizeof what, "%s %s %s f64", s->compiler.command, s->compiler.flags[0],
		s->compiler.flags[1] ? s->compiler.flags[1] : "");
	worst_report(&worst[0], what);
	memcpy(strstr(what, "f64"), "f32", 3);
	worst_report(&worst[1], what);
}
END_TEST

int main(void)
{
	Suite *suite = suite_create("compilers");
	TCase *c = tcase_create("settings");

	setvbuf(stdout, NULL, _IOLBF, 0);
	printf("seed %d\n", SEED);
	tcase_set_timeout(c, 1200);
	tcase_add_loop_test(c, setting, 0, SETTING_COUNT);
	suite_add_tcase(suite, c);
	return suite_run(suite);
}
