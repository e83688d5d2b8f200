/* Friction, smooth: c v / sqrt(v^2 + w^2) on the joint's own axis, beside the reference's torques; quotients and roots in
   the evaluator, with their bounds. */
#include "support/model.h"
#include "support/suite.h"
#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { JOINTS = 3, STATES = 2000 };

/* `lead` turns, `tail` turns by -2 lead, `slide` slides. */
static const char urdf[] =
	"<robot name='rub'><link name='a'/>"
	"<joint name='lead' type='continuous'><parent link='a'/><child link='b'/><axis xyz='0 0 1'/><dynamics friction='0.7'/></joint>"
	"<link name='b'><inertial><origin xyz='.1 .2 .3'/><mass value='2'/>"
	"<inertia ixx='1' iyy='1' izz='1' ixy='0' ixz='0' iyz='0'/></inertial></link>"
	"<joint name='tail' type='continuous'><parent link='b'/><child link='c'/><origin xyz='.5 0 0'/><axis xyz='0 1 0'/>"
	"<dynamics friction='0.3'/><mimic joint='lead' multiplier='-2'/></joint>"
	"<link name='c'><inertial><mass value='1'/><inertia ixx='1' iyy='1' izz='1' ixy='0' ixz='0' iyz='0'/></inertial></link>"
	"<joint name='slide' type='prismatic'><parent link='c'/><child link='d'/><axis xyz='1 0 0'/><dynamics friction='5'/>"
	"<limit lower='-1' upper='1' velocity='1' effort='1'/></joint>"
	"<link name='d'><inertial><mass value='.5'/>"
	"<inertia ixx='1' iyy='1' izz='1' ixy='0' ixz='0' iyz='0'/></inertial></link></robot>";

static wide rub(wide c, wide v, wide width)
{
	return c * v / sqrtl(v * v + width * width);
}

struct state {
	double q[2], qd[2], qdd[2];
	wide tau[2];
};

/* Velocities of all sizes, zero too. */
static struct state draw(struct reference *r, struct rng *rng, wide width, int k)
{
	struct state s;

	for (int i = 0; i < 2; i++) {
		s.q[i] = (float)rng_uniform(rng, -1, 1);
		s.qd[i] = k == 0 ? 0 : (float)(rng_uniform(rng, -1, 1) * exp2(-rng_uniform(rng, 0, 40)));
		s.qdd[i] = (float)rng_uniform(rng, -1, 1);
	}
	reference_rnea(r, s.q, s.qd, s.qdd, s.tau);
	s.tau[0] += rub((wide)0.7, s.qd[0], width) - 2 * rub((wide)0.3, -2 * (wide)s.qd[0], width);
	s.tau[1] += rub(5, s.qd[1], width);
	return s;
}

static void check(const struct dag *d, const struct state *s)
{
	double tau[2], size[2], bound[2];
	float q[2], qd[2], qdd[2], tau_f32[2];
	double bound_f32[2];

	ck_assert(eval_f64(d, (const double *[]){s->q, s->qd, s->qdd, NULL}, (double *[]){NULL, NULL, NULL, tau},
		&(struct eval_terms){size, bound}));
	for (int i = 0; i < 2; i++) {
		q[i] = (float)s->q[i];
		qd[i] = (float)s->qd[i];
		qdd[i] = (float)s->qdd[i];
	}
	ck_assert(eval_f32(d, (const float *[]){q, qd, qdd, NULL}, (float *[]){NULL, NULL, NULL, tau_f32},
		&(struct eval_terms){NULL, bound_f32}));
	for (size_t i = 0; i < d->output_count; i++) {
		int row = d->outputs[i].row;
		double off = (double)fabsl(tau[row] - s->tau[row]), off_f32 = (double)fabsl(tau_f32[row] - s->tau[row]);

		ck_assert_msg(off <= 8 * DBL_EPSILON * size[i], "row %d, qd %g: %g off, of %g", row, s->qd[row], off, size[i]);
		ck_assert_msg(off <= bound[i], "row %d, qd %g: %g off, bound %g", row, s->qd[row], off, bound[i]);
		ck_assert_msg(off_f32 <= bound_f32[i], "row %d, qd %g: f32 %g off, bound %g", row, s->qd[row],
			off_f32, bound_f32[i]);
		ck_assert_msg(bound[i] <= 1e-12 && bound_f32[i] <= 1e-3, "bounds %g, %g say nothing", bound[i], bound_f32[i]);
	}
}

static void check_width(const char *scene, wide width)
{
	struct rneagen_options o = rneagen_options_default();
	struct model m;
	struct rng rng = rng_seed(8);

	o.scene = scene;
	model_open(&m, urdf, strlen(urdf), &o, "rub");
	for (int k = 0; k < STATES; k++) {
		struct state s = draw(m.reference, &rng, width, k);

		check(&m.dag[ALGORITHM_rnea], &s);
	}
	model_close(&m);
}

START_TEST(test_width)
{
	check_width("friction\n", (wide)0.01);
	check_width("friction 0.5\n", (wide)0.5);
}
END_TEST

/* The message of a scene that is refused. */
static void refuse(const char *scene, const char *text)
{
	struct rneagen_options o = rneagen_options_default();
	struct rneagen_result r;
	struct rneagen_error e;

	o.scene = scene;
	o.target = RNEAGEN_TARGET_C;
	ck_assert(rneagen_generate(urdf, strlen(urdf), &o, &r, &e));
	ck_assert_msg(strstr(e.message, text) != NULL, "%s", e.message);
}

START_TEST(test_refused)
{
	refuse("friction 0\n", "friction must be smooth");
	refuse("friction wide\n", "takes a finite number");
}
END_TEST

int main(void)
{
	Suite *s = suite_create("friction");
	TCase *c = tcase_create("friction");

	tcase_add_test(c, test_width);
	tcase_add_test(c, test_refused);
	suite_add_tcase(s, c);
	return suite_run(s);
}
