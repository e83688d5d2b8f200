/* NAME_rnea_bounded with friction and NAME_fd_bounded, as compiled: the outputs to the bit, each within its bound of the
   reference in quad precision; and --want qdd_bound in the same way. A quotient or a root whose error is forgotten, or bounded by
   too little, would break its bound, as would a product that a compiler joins to a sum where the bound counts on another. */
#define _POSIX_C_SOURCE 200809L
#include "forward_text.h"
#include "support/exhaustive.h"
#include "support/suite.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { SEED = 16, SAMPLES = 20, ROWS = 256 };

/* tau of `tail` is friction alone, whose quotient and root are all that is off. */
static const char rubbing[] =
	"<robot name='rub'><link name='a'/><link name='b'><inertial><origin xyz='.1 .2 .3'/><mass value='0.3'/>"
	"<inertia ixx='.1' iyy='.1' izz='.1' ixy='0' ixz='0' iyz='0'/></inertial></link><link name='c'><inertial><origin xyz='.1 "
	".2 .3'/><mass value='0.7'/>"
	"<inertia ixx='.1' iyy='.1' izz='.1' ixy='0' ixz='0' iyz='0'/></inertial></link><link name='d'/>"
	"<joint name='rub' type='continuous'><parent link='a'/><child link='b'/><dynamics friction='0.7'/></joint>"
	"<joint name='slide' type='prismatic'><parent link='a'/><child link='c'/><axis xyz='0 0.6 0.8'/>"
	"<dynamics friction='0.1'/><limit lower='-1' upper='1' velocity='1' effort='1'/></joint>"
	"<joint name='tail' type='continuous'><parent link='c'/><child link='d'/><axis xyz='1 0 0'/><dynamics "
	"friction='1e-4'/></joint></robot>";

static const struct forward_kind KINDS[] = {
	{"f32", {.precision = RNEAGEN_F32}, {"-O0", "-Dalways_inline=unused", "-ffp-contract=off"}},
	{"f64", {.precision = RNEAGEN_F64}, {"-O0", "-Dalways_inline=unused", "-ffp-contract=off"}},
	{"mixed", {.precision = RNEAGEN_MIXED}, {"-O1", "-Dalways_inline=unused", "-march=native"}},
	{"f32 strict", {.precision = RNEAGEN_F32, .trig = RNEAGEN_BOUNDED, .strict = 1},
		{"-O1", "-Dalways_inline=unused", "-march=native"}},
	{"f64 fused", {.precision = RNEAGEN_F64}, {"-O2", "-march=native", "-ffp-contract=fast"}},
};
enum { KIND_COUNT = sizeof KINDS / sizeof *KINDS };

static const struct scene_case {
	const char *robot; /* NULL: rubbing */
	int floating, friction;
	enum { TORQUES, BOUNDED, WANTED } forward; /* WANTED: qdd_bound instead of --bounded */
	double finite; /* at least so much of the bounds in f64 */
} CASES[] = {{NULL, 0, 1, 0, 1}, {"cartpole", 0, 1, 0, 1}, {"iiwa14", 0, 0, 1, 1}, {"mimic_chain", 1, 0, 1, 1},
	{"cartpole", 0, 1, 1, 1},
	{"hyq", 1, 0, 1, 1}, {"panda", 0, 0, 1, 1}, {"planar_tilted", 0, 0, 1, 1}, {"double_pendulum", 0, 0, 1, 1},
	{"cartpole", 0, 1, WANTED, 1}, {"hyq", 0, 0, WANTED, 1}, {"iiwa14", 0, 0, WANTED, 1}, {"ur5", 0, 0, WANTED, 1},
	{"gantry", 0, 0, WANTED, 1}, {"gantry", 0, 0, WANTED, 1}};
enum { CASE_COUNT = sizeof CASES / sizeof *CASES };

struct fixture {
	const struct scene_case *c;
	struct solved solved;
	struct forward_text text;
	struct rng rng;
	double q[ROWS], qd[ROWS], qdd[ROWS], out[ROWS], bound[ROWS];
	__float128 want[ROWS];
	struct closeness close;
};

static void fixture_open(struct fixture *x, const struct scene_case *c, const struct forward_kind *kind)
{
	struct rneagen_options o = rneagen_options_default();
	size_t length;
	char *urdf = c->robot ? target_robot(c->robot, &length) : strdup(rubbing), scene[64], what[64];

	*x = (struct fixture){.c = c, .rng = rng_seed(SEED)};
	snprintf(scene, sizeof scene, "%s%s", c->friction ? "friction 0.25\n" : "",
		c->forward == WANTED ? "want qdd,qdd_bound\n" : c->forward ? "want qdd\n" : "");
	snprintf(what, sizeof what, "%s%s%s", c->robot ? c->robot : "rub", c->friction ? " friction" : "",
		c->forward == WANTED ? " qdd_bound" : c->forward ? " qdd" : "");
	o.base = c->floating ? RNEAGEN_FLOATING : RNEAGEN_FIXED;
	o.scene = scene;
	o.bounded = c->forward != WANTED;
	solved_open(&x->solved, urdf, c->floating, c->friction ? 0.25Q : 0, 0, what);
	forward_text_open(&x->text, urdf, &o, kind, 
		c->forward == WANTED ? "fd" : c->forward ? "fd_bounded" : "rnea_bounded", c->forward == WANTED ? NULL : c->forward
			? "fd" : "rnea", what);
	free(urdf);
}

static void fixture_close(struct fixture *x)
{
	solved_close(&x->solved);
	forward_text_close(&x->text);
}

/* Rates of all sizes, zero too; torques of accelerations that the file's states have. */
static void check_sample(struct fixture *x, int sample)
{
	struct solved *s = &x->solved;

	solved_draw(s, &x->rng, x->q, x->qd, x->qdd);
	for (int i = 0; i < s->nv && x->c->friction; i++)
		x->qd[i] = sample == 0 ? 0 : (double)(float)(x->qd[i] * exp2(-rng_uniform(&x->rng, 0, 40)));
	solved_torques(s, x->q, x->qd, x->qdd, x->want);
	for (int i = 0; i < s->nv && x->c->forward; i++)
		x->qdd[i] = (double)(float)x->want[i];
	if (x->c->forward)
		solved_accelerations(s, x->q, x->qd, x->qdd, x->want);
	forward_text_run(&x->text, (const double *[]){x->q, x->qd, x->qdd}, (int[]){s->nq, s->nv, s->nv}, x->out, x->bound);
	closeness_add(&x->close, &x->text, s->nv, x->out, x->bound, x->want);
}

/* A kind for each robot in turn, or half of them. */
START_TEST(bounds_hold)
{
	const struct scene_case *c = &CASES[_i / KIND_COUNT];
	const struct forward_kind *kind = &KINDS[_i % KIND_COUNT];
	struct fixture *x;

	if (exhaustive() ? (_i % KIND_COUNT + _i / KIND_COUNT) % 2 : _i % KIND_COUNT != _i / KIND_COUNT % KIND_COUNT)
		return;
	x = calloc(1, sizeof *x);
	ck_assert_ptr_nonnull(x);
	fixture_open(x, c, kind);
	for (int k = 0; k < SAMPLES; k++)
		check_sample(x, k);
	closeness_print(&x->close, &x->text);
	if (kind->options.precision == RNEAGEN_F64)
		ck_assert_msg((double)x->close.finite >= c->finite * (double)x->close.count, "%s: too few bounds are finite",
			x->text.target.what);
	fixture_close(x);
	free(x);
}
END_TEST

/* What is not finite, or overflows, has no bound. */
START_TEST(no_bound)
{
	struct fixture *x = calloc(1, sizeof *x);

	ck_assert_ptr_nonnull(x);
	fixture_open(x, &CASES[2], &KINDS[_i]);
	for (int k = 0; k < 2; k++) {
		solved_draw(&x->solved, &x->rng, x->q, x->qd, x->qdd);
		x->qd[1] = k ? (double)NAN : x->text.target.f32 ? 1e30 : 1e200;
		forward_text_run(&x->text, (const double *[]){x->q, x->qd, x->qdd}, (int[]){7, 7, 7}, x->out, x->bound);
		for (int i = 0; i < 7; i++)
			ck_assert_msg(!isfinite(x->bound[i]), "%s: bound %d is %g", x->text.target.what, i, x->bound[i]);
	}
	fixture_close(x);
	free(x);
}
END_TEST

int main(void)
{
	Suite *suite = suite_create("bounded_forward");

	setvbuf(stdout, NULL, _IOLBF, 0);
	printf("quotients and roots within their bounds, seed %d, %d states each\n", SEED, SAMPLES);
	suite_add(suite, "bounds_hold", bounds_hold, CASE_COUNT * KIND_COUNT, 120);
	suite_add(suite, "no_bound", no_bound, 2, 60);
	return suite_run(suite);
}
