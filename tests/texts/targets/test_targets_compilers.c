/* A few robots by every compiler setting, in every precision, layout and trigonometry mode: each pair of a setting and an option,
   and where all is asked for of a robot and each of these too. Once found: what a compiler in its own dialect joins. */
#define _POSIX_C_SOURCE 200809L
#include "support/pairs.h"
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

enum { SETTING_COUNT = sizeof SETTINGS / sizeof *SETTINGS, STATES = 300, SEED = 21, ROBOT_COUNT = 9 };
enum { SETTING, PRECISION, LAYOUT, TRIG, COLUMNS }; /* columns of the table */

static struct worst worst[2];

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
};

static const struct robot_choice ROBOTS[ROBOT_COUNT] = {{"iiwa14", RNEAGEN_FIXED}, {"hyq", RNEAGEN_FLOATING},
	{"panda", RNEAGEN_FIXED}, {"mimic_chain", RNEAGEN_FLOATING}, {"planar_tilted", RNEAGEN_FIXED},
	{"floating_joint", RNEAGEN_FIXED}, {"prismatic_skew", RNEAGEN_FIXED}, {"all_zero_torque", RNEAGEN_FIXED},
	{"odd_names", RNEAGEN_FIXED}};

/* Compilers take long to optimise the texts of these two: of others, in turn, but at
   -O0. */
static const struct robot_choice *robot_of(const struct pairs *p, int i)
{
	const char *level = SETTINGS[p->rows[i][SETTING]].compiler.flags[0];
	int is_quick = !strcmp(level, "-O0"), robot = i % ROBOT_COUNT;

	return &ROBOTS[is_quick ? robot : robot == 1 ? 3 : robot == 8 ? 7 : robot];
}

static void check_row(const struct setting *setting, const int *row, const struct robot_choice *choice)
{
	struct rneagen_options o = rneagen_options_default();
	struct states states;
	struct model m;
	size_t length;
	char *urdf = target_robot(choice->name, &length);

	o.target = RNEAGEN_TARGET_C;
	o.base = choice->base;
	o.precision = row[PRECISION] ? RNEAGEN_F32 : RNEAGEN_F64;
	o.layout = (enum rneagen_layout)row[LAYOUT];
	o.trig = (enum rneagen_trig)row[TRIG];
	model_open(&m, urdf, length, &o, choice->name);
	states = states_new(&m, SEED, STATES, row[PRECISION], 1);
	if (o.trig != RNEAGEN_ACCURATE)
		states.count -= 100; /* the last have large angles */
	check_text(&m, &states, urdf, length, &o, setting, choice->name);
	states_free(&states);
	model_close(&m);
	free(urdf);
}

START_TEST(setting)
{
	struct pairs p = {.factors = COLUMNS, .levels = {SETTING_COUNT, 2, 2, 3}};
	const struct setting *s = &SETTINGS[_i];
	char what[64];

	if (!compiler_serves(&s->compiler, s->needs_fma))
		return;
	pairs_draw(&p, SEED);
	for (int i = 0; i < p.count; i++)
		if (p.rows[i][SETTING] == _i)
			check_row(s, p.rows[i], robot_of(&p, i));
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
