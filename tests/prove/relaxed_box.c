#include "prove/relaxed_box.h"
#include "dag/eval.h"
#include "support/suite.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

static const struct {
	const char *name, *scene;
} ROBOTS[] = {
	{"double_pendulum", "range qdd=-5,9\nrange q=-3,3\nrange qd=-2,5"},
	{"prismatic_skew", "range qdd=-5,9\nrange q=-1,2\nrange qd=-2,5"},
	{"gantry", "range qdd=-5,9\nrange q=-1,2\nrange qd=-2,5"},
	{"skew_axis", "range qdd=-5,9\nrange q=-1,2\nrange qd=-2,5"},
	{"hyq", "range qdd=-20,20"},
	{"ur5", "range qdd=-20,20"},
	{"iiwa14", "range qdd=-20,20\ndamping"},
	{"panda", "range qdd=-20,20\nwant gravity,bias"},
	{"cartpole", "range qdd=-5,9\nrange qd=-2,5\nrange q=-1,1\nfriction\ndamping"},
	{"planar_tilted", "range q=-1,1\nrange qdd=-5,9\nrange qd=-2,5"},
	{"mimic_chain", "range qdd=-5,9\nrange qd=-2,5"},
	{"mimic:double_pendulum", "range qdd=-5,9\nrange qd=-2,5\nrange q=-3,3"},
	{"floating_joint", "range q=-1,1\nrange qdd=-5,9\nrange qd=-2,5"},
	{"floating:double_pendulum", "range q=-1,1\nrange qdd=-5,9\nrange qd=-2,5"},
	{"double_pendulum",
		"free payload.lower,gravity,offset.elbow\nrange payload.lower=0,2\nrange gravity=-9,9\nrange offset.elbow=-1,1\n"
		"range q=-1,1\nrange qdd=-5,9\nrange qd=-2,5"},
};
_Static_assert(sizeof ROBOTS / sizeof *ROBOTS == RELAXED_BOX_CASES, "tests take them by their number");

void relaxed_box_open(struct relaxed_box *s, const char *name, const char *scene)
{
	robot_box_open(&s->x, name, scene, 0);
	ck_assert_msg(!relax(&s->relaxed, &s->x.analysis, s->x.box.rows, &s->x.arena, &s->x.error), "%s", s->x.error.message);
	memcpy(s->box.rows, s->relaxed.rows, sizeof s->box.rows);
	for (int i = 0; i < s->relaxed.view.dag.argument_count; i++)
		s->in[i] = arena_alloc(&s->x.arena, (size_t)s->relaxed.view.dag.arguments[i].rows, sizeof *s->in[i]);
	s->count = field_split(&s->fields, &s->relaxed, &s->x.arena, &s->x.error);
	ck_assert_msg(s->count > 0, "%s: %s", name, s->x.error.message);
}

void relaxed_box_case(struct relaxed_box *s, int number)
{
	relaxed_box_open(s, ROBOTS[number].name, ROBOTS[number].scene);
}

void relaxed_box_see(struct relaxed_box *s)
{
	const struct dag *d = &s->x.analysis.dag, *of = &s->relaxed.view.dag;
	double *v = calloc(d->count, sizeof *v);

	for (size_t k = 0; k < d->count; k++)
		v[k] = d->nodes[k].op == OP_INPUT ? s->x.in[d->nodes[k].arg[0].i][d->nodes[k].arg[1].i]
			: eval_node(&d->nodes[k], v);
	for (size_t k = 0; k < of->count; k++) {
		const struct node *n = &of->nodes[k];
		uint32_t argument = n->arg[0].i, row = n->arg[1].i;
		struct interval r;
		double *x;

		if (n->op != OP_INPUT)
			continue;
		x = &s->in[argument][row];
		r = s->box.rows[argument][row];
		*x = s->relaxed.source[k] ? v[s->relaxed.source[k] - 1] : s->x.in[argument][row];
		ck_assert(r.upper - r.lower >= 6.28 || (*x >= r.lower - 1e-12 && *x <= r.upper + 1e-12));
	}
	for (int b = 0; b < s->relaxed.ball_count; b++) {
		const struct relaxed_ball *ball = &s->relaxed.balls[b];
		const double *drives = s->in[s->relaxed.drives] + ball->first;
		double sum = 0, length;

		for (int k = 0; k < ball->count; k++)
			sum += drives[k] * drives[k];
		length = sqrt(sum);
		ck_assert_msg(length <= ball->radius && (ball->count < 3 || length >= 0.99 * ball->radius), "%g, not %g", length,
			ball->radius);
	}
	free(v);
}

void relaxed_box_values(struct relaxed_box *s, struct rng *r, double *v)
{
	const struct dag *d = &s->relaxed.view.dag;

	robot_box_draw(&s->x, r, 0, 0);
	relaxed_box_see(s);
	for (size_t k = 0; k < d->count; k++)
		v[k] = d->nodes[k].op == OP_INPUT ? s->in[d->nodes[k].arg[0].i][d->nodes[k].arg[1].i]
			: eval_node(&d->nodes[k], v);
}
