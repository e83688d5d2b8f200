/* What --drop-below leaves out is proved: no state within the ranges, nor their corners, changes an output by more than the
   fraction, by the expressions with all terms in extended precision; and a term that samples miss stays. It would catch a term
   whose effect is not counted, and a magnitude or a derivative that is too small. Seeds are the cases' numbers. */
#define _POSIX_C_SOURCE 200809L
#include "draw/felt.h"
#include "draw/proven.h"
#include "support/rng.h"
#include "support/scene_model.h"
#include "support/suite.h"
#include "support/urdf_text.h"
#include "tell/effect.h"
#include "dag/eval.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { STATES = 600, MOST_ROWS = 400 };

static const struct held {
	const char *robot, *scene, *fraction;
	enum rneagen_base base;
	int saves; /* is anything left out? */
} HELDS[] = {
	{"iiwa14", "range qdd=-20,20", "1e-3", RNEAGEN_FIXED, 1},
	{"iiwa14", "range qdd=-20,20", "0.1", RNEAGEN_FIXED, 1},
	{"iiwa14", "range q=0.2,0.4\nrange qd=-0.1,0.1\nrange qdd=-1,3", "1e-3", RNEAGEN_FIXED, 1},
	{"iiwa14", "range qdd=-20,20", "0.9", RNEAGEN_FIXED, 1},
	{"panda", "range qdd=-20,20\nwant tau,gravity,kinetic,power", "1e-2", RNEAGEN_FIXED, 1},
	{"panda", "range qdd=-20,20\nfree payload.panda_hand,gravity\nrange payload.panda_hand=0,2\nrange gravity=-10,10", "1e-3",
		RNEAGEN_FIXED, 1},
	{"iiwa14", "range qdd=-20,20\nfree inertia.iiwa_link_ee\nrange inertia.iiwa_link_ee=0,2", "1e-3", RNEAGEN_FIXED, 1},
	{"panda", "range qdd=-1,1\nfext panda_hand\nrange fext.panda_hand=-50,50", "1e-2", RNEAGEN_FIXED, 1},
	{"iiwa14", "want M,bias", "1e-2", RNEAGEN_FIXED, 1},
	{"hyq", "range qd=-1,1\nrange qdd=-5,5", "1e-2", RNEAGEN_FLOATING, 1},
	{"mimic_chain", "range q=-1,1\nrange qd=-1,1\nrange qdd=-5,5", "0.1", RNEAGEN_FIXED, 1},
	{"allegro_right", "friction\ndamping\nrange qd=-3,3\nrange qdd=-20,20", "1e-2", RNEAGEN_FIXED, 1},
	{"ur5", "want dtau_dq\nrange qdd=-5,5", "1e-2", RNEAGEN_FIXED, 1},
	{"iiwa14", "want vjp\nrange qdd=-5,5\nrange vjp_v=-1,1", "5e-2", RNEAGEN_FIXED, 1},
};
enum { HELD_COUNT = sizeof HELDS / sizeof *HELDS };

static void open_scene(struct scene_model *m, const struct held *h, const char *fraction)
{
	struct rneagen_options o = rneagen_options_default();
	char scene[1024], *text = robot_text(h->robot);

	snprintf(scene, sizeof scene, "%s%s%s", h->scene, fraction ? "\ndrop-below " : "", fraction ? fraction : "");
	o.scene = scene;
	o.base = h->base;
	ck_assert_msg(!scene_open(m, text, &o), "%s", m->error.message);
	free(text);
}

/* Numbers, not bodies and rotations, go to one end of their range. */
static void go_to_corners(const struct drawn *x, size_t sample, struct rng *r)
{
	for (int i = 0; i < x->count; i++) {
		const struct drawn_array *y = &x->arrays[i];

		for (int k = 0; k < y->rows; k++)
			if (y->ranges[k].kind == DRAW_NUMBER && rng_chance(r, 0.9))
				y->values[sample * (size_t)y->rows + (size_t)k] = rng_chance(r, 0.5) ? y->ranges[k].lower
					: y->ranges[k].upper;
	}
}

/* All outputs of one sample, by argument and row. */
static void evaluate(const struct dag *d, const struct drawn *x, size_t sample, real (*out)[MOST_ROWS])
{
	static real in[DAG_ARGUMENTS][MOST_ROWS];
	const real *ins[DAG_ARGUMENTS] = {NULL};
	real *outs[DAG_ARGUMENTS] = {NULL};

	for (int i = 0; i < d->argument_count; i++) {
		const double *rows = draw_rows(x, &d->arguments[i], sample);

		ck_assert_int_le(d->arguments[i].rows, MOST_ROWS);
		for (int k = 0; rows && k < d->arguments[i].rows; k++)
			in[i][k] = (real)rows[k];
		ins[i] = in[i];
		outs[i] = out[i];
	}
	ck_assert(eval_real(d, ins, outs, NULL));
}

static void note_largest(const struct dag *d, const struct drawn *x, double (*largest)[MOST_ROWS])
{
	static real out[DAG_ARGUMENTS][MOST_ROWS];

	for (size_t s = 0; s < x->samples; s++) {
		evaluate(d, x, s, out);
		for (int i = 0; i < d->argument_count; i++)
			for (int k = 0; k < d->arguments[i].rows && d->arguments[i].is_output; k++)
				largest[i][k] = fmax(largest[i][k], fabs((double)out[i][k]));
	}
}

static double largest_of(const double *rows, int count)
{
	double most = 0;

	for (int k = 0; k < count; k++)
		most = fmax(most, rows[k]);
	return most;
}

/* The largest change as a part of what is allowed, but for what extended precision rounds away. */
static double worst_change(const struct dag *with, const struct dag *without, const struct drawn *x, double fraction, double most,
	double (*largest)[MOST_ROWS])
{
	static real y[DAG_ARGUMENTS][MOST_ROWS], z[DAG_ARGUMENTS][MOST_ROWS];
	double worst = 0;

	for (size_t s = 0; s < x->samples; s++) {
		evaluate(with, x, s, y);
		evaluate(without, x, s, z);
		for (int i = 0; i < with->argument_count; i++)
			for (int k = 0; k < with->arguments[i].rows && with->arguments[i].is_output; k++) {
				double off = fabs((double)(y[i][k] - z[i][k])), allowed = fmin(most, fraction * largest[i][k]);

				worst = off > 1e-16 * largest_of(largest[i], with->arguments[i].rows) ? fmax(worst, off / allowed)
					: worst;
			}
	}
	return worst;
}

START_TEST(held)
{
	static double largest[DAG_ARGUMENTS][MOST_ROWS];
	const struct held *h = &HELDS[_i];
	struct rng r = rng_seed((uint64_t)_i + 1);
	struct scene_model whole, m;
	struct drawn felt, x;
	double worst;

	open_scene(&whole, h, NULL);
	open_scene(&m, h, h->fraction);
	memset(largest, 0, sizeof largest);
	ck_assert(draw_inputs(&felt, &whole.tree, &whole.analysis.request, &FELT_SAMPLES, &whole.arena));
	ck_assert(draw_inputs(&x, &m.tree, &m.analysis.request, &(struct draw_options){.seed = 77, .count = STATES, .each = 1},
		&m.arena));
	for (size_t s = 0; s < STATES; s += 2)
		go_to_corners(&x, s, &r);
	note_largest(&whole.dag, &felt, largest);
	worst = worst_change(&m.dag, &whole.dag, &x, strtod(h->fraction, NULL), m.analysis.dropped.change, largest);
	printf("%s %s: %zu of %zu operations, change %.2g of what is proved\n", h->robot, h->fraction, operation_total(&m),
		operation_total(&whole), worst);
	ck_assert_msg(worst <= 1 + 1e-9, "%s, case %d: %g of what is allowed", h->robot, _i, worst);
	ck_assert(m.analysis.dropped.share <= strtod(h->fraction, NULL) * (1 + 1e-12));
	ck_assert(!h->saves || operation_total(&m) < operation_total(&whole));
	scene_close(&whole);
	scene_close(&m);
}
END_TEST

/* ---- what samples miss ---- */

/* tau_0 = qdd_0 + factor qd_0 ... qd_6 */
static void rare_term(struct dag *d, double factor, struct arena *a)
{
	struct ref term = {0};
	int qd, qdd, tau;

	dag_init(d, a);
	qd = dag_argument_of(d, (struct argument){.name = "qd", .rows = 7, .role = ROLE_JOINT_VELOCITY});
	qdd = dag_argument_of(d, (struct argument){.name = "qdd", .rows = 7, .role = ROLE_JOINT_ACCELERATION});
	tau = dag_argument_of(d, (struct argument){.name = "tau", .rows = 7, .is_output = 1, .role = ROLE_JOINT_TORQUE});
	term = dag_const(d, (real)factor);
	for (int i = 0; i < 7; i++)
		term = dag_mul(d, term, dag_input(d, qd, i));
	dag_output(d, tau, 0, dag_add(d, dag_input(d, qdd, 0), term));
	ck_assert(!d->failed);
}

static int is_dropped(const unsigned char *out, const struct dag *d)
{
	return out[d->outputs[0].value.i] != 0;
}

/* All seven velocities are near their limits in no sample: a term of 0.05 there is below 0.01 in all of them. */
START_TEST(rare_corner)
{
	static const struct held all = {"iiwa14", "range qd=-1,1\nrange qdd=-1,1", NULL, RNEAGEN_FIXED, 0};
	struct scene_model m;
	struct rneagen_error e = {0};
	struct proven told;
	struct dag rare, small;
	const unsigned char *out;

	open_scene(&m, &all, NULL);
	rare_term(&rare, 0.05, &m.arena);
	rare_term(&small, 0.005, &m.arena);
	out = felt_find(&rare, &m.tree, &m.analysis.request, 0.01, &m.arena);
	ck_assert_msg(is_dropped(out, &rare), "samples see it");
	out = proven_find(&told, &rare, &m.tree, &m.analysis.request, 0.01, &m.arena, &e);
	ck_assert_msg(out && !is_dropped(out, &rare), "the corner is left out: %s", e.message);
	out = proven_find(&told, &small, &m.tree, &m.analysis.request, 0.01, &m.arena, &e);
	ck_assert(out && is_dropped(out, &small) && told.change >= 0.005 && told.change < 0.00501);
	scene_close(&m);
}
END_TEST

/* Terms that are each below the fraction, and together above it: samples leave out all, the proof as many as there is room
   for. */
START_TEST(together)
{
	static const struct held all = {"iiwa14", "range qd=-1,1\nrange qdd=-1,1", NULL, RNEAGEN_FIXED, 0};
	struct scene_model m;
	struct rneagen_error e = {0};
	struct proven told;
	struct dag d;
	struct ref sum;
	const unsigned char *felt, *proven;
	int dropped[2] = {0};

	open_scene(&m, &all, NULL);
	dag_init(&d, &m.arena);
	dag_argument_of(&d, (struct argument){.name = "qd", .rows = 7, .role = ROLE_JOINT_VELOCITY});
	dag_argument_of(&d, (struct argument){.name = "qdd", .rows = 7, .role = ROLE_JOINT_ACCELERATION});
	dag_argument_of(&d, (struct argument){.name = "tau", .rows = 7, .is_output = 1, .role = ROLE_JOINT_TORQUE});
	sum = dag_input(&d, 1, 0);
	for (int i = 0; i < 6; i++)
		sum = dag_add(&d, sum, dag_mul(&d, dag_const(&d, 0.004L), dag_input(&d, 0, i)));
	dag_output(&d, 2, 0, sum);
	felt = felt_find(&d, &m.tree, &m.analysis.request, 0.01, &m.arena);
	proven = proven_find(&told, &d, &m.tree, &m.analysis.request, 0.01, &m.arena, &e);
	ck_assert(felt && proven);
	for (size_t i = 0; i < d.count; i++)
		for (int k = 0; k < 2; k++) {
			dropped[0] += felt[i] >> k & 1;
			dropped[1] += proven[i] >> k & 1;
		}
	ck_assert_msg(dropped[0] == 6 && dropped[1] == 2, "%d by samples, %d proved", dropped[0], dropped[1]);
	ck_assert(told.change >= 0.008 && told.change < 0.00801 && told.share <= 0.01);
	scene_close(&m);
}
END_TEST

/* ---- what is said ---- */

static const struct refused {
	const char *robot, *scene, *part;
} REFUSED[] = {
	{"iiwa14", "", "no limit is known of qdd: give --range"},
	{"iiwa14", "range qdd.iiwa_joint_2=-1,1", "known of qdd.iiwa_joint_1, qdd.iiwa_joint_3, "},
	{"double_pendulum", "range qdd=-1,1\nrange qd[0]=-1,1", "known of qd."},
	{"panda", "range qdd=-1,1\nfree payload.panda_hand", "known of payload.panda_hand:"},
	{"panda", "range qdd=-1,1\nfree gravity\nrange gravity[2]=-10,-9", "known of gravity[0], gravity[1]:"},
	{"panda", "range qdd=-1,1\nfext panda_hand", "known of fext.panda_hand:"},
};

START_TEST(refused)
{
	struct rneagen_options o = rneagen_options_default();
	struct scene_model m;
	char scene[512], *text = robot_text(REFUSED[_i].robot);

	snprintf(scene, sizeof scene, "%s\ndrop-below 1e-3", REFUSED[_i].scene);
	o.scene = scene;
	ck_assert_int_eq(scene_open(&m, text, &o), RNEAGEN_SCENE);
	ck_assert_msg(strstr(m.error.message, REFUSED[_i].part) && strstr(m.error.message, "drop-below: "), "%s",
		m.error.message);
	scene_close(&m);
	strcat(scene, ":sampled");
	ck_assert(!scene_open(&m, text, &o));
	scene_close(&m);
	free(text);
}
END_TEST

/* Heads say which it is. */
START_TEST(told)
{
	static const struct held all = {"hyq", "range qdd=-5,5", NULL, RNEAGEN_FIXED, 0};

	for (int sampled = 0; sampled < 2; sampled++) {
		struct scene_model m;
		struct text out;

		open_scene(&m, &all, sampled ? "1e-3:sampled" : "1e-3");
		ck_assert(!effect_measure(&m.effects, &m.analysis));
		text_init(&out, &m.arena);
		effect_put_comment(&m.effects, &m.analysis, &out);
		ck_assert_msg((strstr(text_string(&out), "proved for all states within the ranges below") != NULL) == !sampled,
			"%s", text_string(&out));
		ck_assert((strstr(text_string(&out), "chosen by samples, and nothing is proved") != NULL) == sampled);
		ck_assert(sampled || (m.effects.of[0].most.share > 0 && m.effects.of[0].most.share <= 1e-3 &&
						     m.effects.of[0].change <= m.effects.of[0].most.change));
		scene_close(&m);
	}
}
END_TEST

int main(void)
{
	Suite *suite = suite_create("drop, proved");

	setvbuf(stdout, NULL, _IOLBF, 0);
	suite_add(suite, "held", held, HELD_COUNT, 120);
	suite_add(suite, "rare corner", rare_corner, 1, 60);
	suite_add(suite, "together", together, 1, 60);
	suite_add(suite, "refused", refused, sizeof REFUSED / sizeof *REFUSED, 60);
	suite_add(suite, "told", told, 1, 60);
	return suite_run(suite);
}
