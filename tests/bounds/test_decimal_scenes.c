/* Bounds against decimals that stand in a scene: joints held, inputs folded, gravity and what joints take for themselves. The
   reference knows no scenes: it is given the same robot written out, or the same numbers as inputs, in quad precision. */
#include "passes/analysis.h"
#include "dag/eval.h"
#include "emit/number_type.h"
#include "hard/quad.h"
#include "support/rng.h"
#include "support/suite.h"
#include <math.h>
#include <quadmath.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { SEED = 3, SAMPLES = 200, ROWS = 3 };

#define LINK(name, mass, com)                                                                                          \
	"<link name='" name "'><inertial><origin xyz='" com "' rpy='0.1 0.2 0.3'/><mass value='" mass "'/>"            \
	"<inertia ixx='0.3' iyy='0.4' izz='0.6' ixy='0.01' ixz='-0.02' iyz='0.03'/></inertial></link>"
#define JOINT(name, type, parent, child, xyz, rpy, rest)                                                               \
	"<joint name='" name "' type='" type "'><origin xyz='" xyz "' rpy='" rpy "'/><parent link='" parent "'/>"       \
	"<child link='" child "'/><limit lower='-9' upper='9' effort='1' velocity='1'/>" rest "</joint>"
#define TURN JOINT("j2", "revolute", "a", "b", "0.1 0.2 0.3", "0 0 0", "<axis xyz='1 0 0'/>")
#define SLIDE JOINT("j3", "prismatic", "b", "c", "0.2 0 0.3", "0 0 0", "<axis xyz='0 1 0'/>")
#define MIMIC                                                                                                          \
	JOINT("j3", "prismatic", "b", "c", "0.2 0 0.3", "0 0 0",                                                       \
		"<axis xyz='0 1 0'/><mimic joint='j2' multiplier='0.1' offset='0.2'/>")
#define FIRST \
	JOINT("j1", "revolute", "world", "a", "0 0 0", "0 0 0", "<axis xyz='0 1 0'/><dynamics damping='0.7' friction='0.4'/>")
#define ROBOT(second, third)                                                                                           \
	"<robot name='r'><link name='world'/>" LINK("a", "0.7", "0.1 -0.2 0.3") LINK("b", "0.1", "0.3 0.1 -0.7")        \
	LINK("c", "0.3", "-0.1 0.1 0.2") FIRST second third "</robot>"
/* What joints take for themselves, alone */
#define BARE "<robot name='r'><link name='world'/><link name='a'/><link name='b'/><link name='c'/>" FIRST TURN SLIDE "</robot>"

/* What a scene says, and what says the same. Rows that the reference has, and where they stand in the scene's. */
static const struct scene_case {
	const char *name, *scene, *urdf, *same;
	__float128 q2, qd2, qdd1; /* where `given` */
	int given, own_gravity;
	__float128 gravity[3], armature, damping, friction, width;
} cases[] = {
	{.name = "lock, nearly a half turn", .scene = "lock j2=3.14159", .urdf = ROBOT(TURN, SLIDE),
		.same = ROBOT(JOINT("j2", "fixed", "a", "b", "0.1 0.2 0.3", "3.14159 0 0", ""), SLIDE)},
	{.name = "lock", .scene = "lock j2=0.3\nlock j3=0.1", .urdf = ROBOT(TURN, SLIDE),
		.same = ROBOT(JOINT("j2", "fixed", "a", "b", "0.1 0.2 0.3", "0.3 0 0", ""),
			JOINT("j3", "fixed", "b", "c", "0.2 0.1 0.3", "0 0 0", ""))},
	{.name = "lock a leader", .scene = "lock j2=0.3", .urdf = ROBOT(TURN, MIMIC),
		.same = ROBOT(JOINT("j2", "fixed", "a", "b", "0.1 0.2 0.3", "0.3 0 0", ""),
			JOINT("j3", "fixed", "b", "c", "0.2 0.23 0.3", "0 0 0", ""))},
	{.name = "fold", .scene = "fold q.j2=3.14159\nfold qd.j2=0.7\nfold qdd.j1=-0.1", .urdf = ROBOT(TURN, SLIDE),
		.same = ROBOT(TURN, SLIDE), .given = 1, .q2 = 3.14159Q, .qd2 = 0.7Q, .qdd1 = -0.1Q},
	{.name = "gravity", .scene = "fold gravity=0.1,-0.2,-1.62", .urdf = ROBOT(TURN, SLIDE), .same = ROBOT(TURN, SLIDE),
		.own_gravity = 1, .gravity = {0.1Q, -0.2Q, -1.62Q}},
	{.name = "armature", .scene = "armature j1=0.3", .urdf = BARE, .same = BARE, .armature = 0.3Q},
	{.name = "damping and friction", .scene = "damping\nfriction 0.03", .urdf = BARE, .same = BARE, .damping = 0.7Q,
		.friction = 0.4Q, .width = 0.03Q},
	{.name = "damping", .scene = "damping", .urdf = BARE, .same = BARE, .damping = 0.7Q},
	{.name = "friction, its width by default", .scene = "friction", .urdf = ROBOT(TURN, SLIDE), .same = ROBOT(TURN, SLIDE),
		.friction = 0.4Q, .width = 0.01Q},
};

struct fixture {
	const struct scene_case *c;
	struct analysis a;
	struct quad *quad;
	double state[3][ROWS], bound[ROWS], tau[ROWS];
	__float128 exact[ROWS];
	double share;
};

static void fixture_open(struct fixture *x, const struct scene_case *c)
{
	struct rneagen_options o = rneagen_options_default();
	struct rneagen_error e;
	char message[256];

	*x = (struct fixture){.c = c};
	o.scene = c->scene;
	o.gravity[2] = -9.81;
	ck_assert_msg(!analysis_open(&x->a, c->urdf, strlen(c->urdf), &o, &e), "%s: %s", c->name, e.message);
	x->quad = quad_open(c->same, strlen(c->same), 0, 0, QUAD_DECIMALS, o.gravity, NULL, message, sizeof message);
	ck_assert_msg(x->quad != NULL, "%s: %s", c->name, message);
	quad_set_gravity(x->quad, c->own_gravity ? c->gravity : (__float128[]){0, 0, -9.81Q});
}

static void fixture_close(struct fixture *x)
{
	analysis_free(&x->a);
	quad_close(x->quad);
}

/* Floats, so that every precision takes the same. In turn all of a size, rates of the friction's width, at rest, and at zero. */
static void next_state(struct fixture *x, struct rng *rng, int sample)
{
	static const double sizes[4][3] = {{3, 3, 3}, {3, 0.01, 1}, {3, 0, 0}, {0, 0, 0}};

	for (int k = 0; k < 3; k++)
		for (int i = 0; i < ROWS; i++)
			x->state[k][i] = (double)(float)(rng_uniform(rng, -1, 1) * sizes[sample % 4][k]);
}

static void refer(struct fixture *x)
{
	const struct scene_case *c = x->c;
	__float128 in[3][ROWS], v;

	for (int k = 0; k < 3; k++)
		for (int i = 0; i < ROWS; i++)
			in[k][i] = (__float128)x->state[k][i];
	if (c->given) {
		in[0][1] = c->q2;
		in[1][1] = c->qd2;
		in[2][0] = c->qdd1;
	}
	v = in[1][0];
	quad_rnea_wide(x->quad, in[0], in[1], in[2], x->exact);
	x->exact[0] += c->armature * in[2][0] + c->damping * v;
	if (c->friction > 0)
		x->exact[0] += c->friction * v / sqrtq(v * v + c->width * c->width);
}

/* The arrays of the scene's DAG, by name, of which some may not be read. */
static void point(const struct dag *d, struct fixture *x, const double **in, double **out)
{
	static const char *const names[] = {"q", "qd", "qdd"};

	for (int k = 0; k < d->argument_count; k++) {
		in[k] = NULL;
		out[k] = NULL;
		for (int i = 0; i < 3; i++)
			if (!strcmp(d->arguments[k].name, names[i]))
				in[k] = x->state[i];
		if (d->arguments[k].is_output)
			out[k] = x->tau;
	}
}

static void judge(struct fixture *x, const char *how)
{
	for (int i = 0; i < x->a.tree.nv; i++) {
		double error = (double)fabsq((__float128)x->tau[i] - x->exact[i]);

		ck_assert_msg(error <= x->bound[i], "%s, %s: torque %d is off by %g, bound %g", x->c->name, how, i,
			error, x->bound[i]);
		if (x->bound[i] > 0)
			x->share = fmax(x->share, error / x->bound[i]);
	}
}

static void check_state(struct fixture *x)
{
	const struct rneagen_options f64 = {.precision = RNEAGEN_F64}, mixed = {.precision = RNEAGEN_MIXED};
	const struct eval_model m = eval_model_of(&f64, 0), stored = eval_model_of(&mixed, 0);
	const struct dag *d = &x->a.dag;
	const double *in[DAG_ARGUMENTS];
	double *out[DAG_ARGUMENTS], *bound[DAG_ARGUMENTS];

	point(d, x, in, out);
	for (int k = 0; k < d->argument_count; k++)
		bound[k] = out[k] ? x->bound : NULL;
	refer(x);
	ck_assert(eval_f64(d, in, out, NULL) && eval_bound(d, &m, in, bound));
	judge(x, "f64");
	for (int i = 0; i < x->a.tree.nv; i++)
		x->tau[i] = (double)(float)x->tau[i];
	ck_assert(eval_bound(d, &stored, in, bound));
	judge(x, "mixed");
}

START_TEST(scenes)
{
	struct rng rng = rng_seed(SEED);
	struct fixture x;

	fixture_open(&x, &cases[_i]);
	for (int i = 0; i < SAMPLES; i++) {
		next_state(&x, &rng, i);
		check_state(&x);
	}
	printf("%-32s error at most %.2g of a bound\n", cases[_i].name, x.share);
	fixture_close(&x);
}
END_TEST

int main(void)
{
	Suite *suite = suite_create("decimals of scenes");

	setvbuf(stdout, NULL, _IOLBF, 0);
	printf("bounds against the decimals of scenes, seed %d\n", SEED);
	suite_add(suite, "scenes", scenes, sizeof cases / sizeof *cases, 60);
	return suite_run(suite);
}
