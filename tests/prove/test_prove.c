/* What rnearun prove proves holds in states drawn over the box and at its corners, in quad precision, and for texts in f32 and
   f64; a proof of another robot, of fewer roundings, or of a smaller box is seen not to hold. RNEAGEN_ALL: 64 000 states. */
#include "dag/eval.h"
#include "emit/number_type.h"
#include "prove/robot_box.h"
#include "prove/rounding.h"
#include "support/exhaustive.h"
#include "support/suite.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

enum { SEED = 22, FEW = 300, MANY = 4000 };
/* How far a state's bound of the error may be above a box's: that goes by lengths of vectors, where a state's goes by terms. */
static const double ABOVE = 1.005;

static const struct proof_case {
	const char *name, *scene;
	double slack; /* of ranges, reached sooner or later; 0: any */
	int is_long;  /* others are nearly the same: where all is asked for */
} CASES[] = {
	{"pendulum", "range qdd=-5,5\nrange qd=-3,3\nrange q=-3,3", 1.02, 0},
	{"double_pendulum", "range qdd=-5,9\nrange q=-3,3\nrange qd=-2,5", 1.1, 0},
	{"double_pendulum", "range q=0.25,0.25\nrange qd=1,1\nrange qdd=2,2", 1 + 1e-6, 0},
	{"cartpole", "range qdd=-5,9\nrange qd=-2,5\nrange q=-1,1", 1.1, 0},
	{"prismatic_skew", "range qdd=-5,9\nrange q=-1,2\nrange qd=-2,5", 2, 0},
	{"skew_axis", "range qdd=-5,9\nrange q=-1,2\nrange qd=-2,5", 2, 0},
	{"negative_axes", "range qdd=-5,9\nrange q=-1,2\nrange qd=-2,5", 2, 1},
	{"hyq", "range qdd=-20,20", 0, 0},
	{"ur5", "range qdd=-20,20", 0, 1},
	{"iiwa14", "range qdd=-20,20", 0, 1},
	{"iiwa14", "range q=0.25,0.25\nrange q.iiwa_joint_4=-2,2\nrange qdd=-20,20", 1.3, 0},
	{"iiwa14", "range q=0.3,0.7\nrange qd=0.1,0.5\nrange qdd=1,1", 0, 1},
	{"iiwa14", "want gravity,bias", 0, 0},
	{"panda", "range qdd=-20,20", 0, 1},
	{"panda", "want M", 0, 0},
	{"fetch", "range qdd=-20,20\nrange qd=-1,1", 0, 1},
	{"cartpole", "range qdd=-5,9\nrange qd=-2,5\nrange q=-1,1\nfriction\ndamping", 1.05, 0},
	{"cartpole", "range qdd=0,0\nrange qd=0.125,0.125\nrange q=0,0\nfriction", 1 + 1e-6, 0},
	{"panda", "range qdd=-20,20\nfriction\ndamping", 0, 1},
	{"mimic:double_pendulum", "range qdd=-20,20\nrange qd=-2,2\nrange q=-3,3", 1.1, 0},
	{"planar_joint", "range qdd=-20,20\nrange qd=-2,2", 1.05, 0},
	{"planar_tilted", "range q=-1,1\nrange qdd=-20,20\nrange qd=-2,2", 0, 0},
	{"mimic_chain", "range qdd=-20,20\nrange qd=-2,2", 0, 0},
	{"robotiq_2f_85", "range qdd=-20,20\nrange qd=-2,2", 0, 1},
	{"floating_joint", "range q=-1,1\nrange qdd=-20,20\nrange qd=-2,2", 0, 0},
	{"floating:hyq", "range qdd=-20,20\nrange qd=-2,2", 0, 0},
	{"floating:double_pendulum", "range qdd=-20,20\nrange qd=-2,2\nrange q=-1,1\nwant gravity", 1.05, 0},
	{"double_pendulum",
		"free payload.lower,mass.upper\nrange payload.lower=0,2\nrange mass.upper=1,2\nrange q=-1,1\nrange qdd=-2,2\nrange qd=-2,2",
		1.1, 0},
	{"double_pendulum",
		"free inertia.lower,gravity,offset.elbow\nrange inertia.lower=1,2\nrange gravity=-9,9\nrange offset.elbow=-1,1\nrange q=-1,1\n"
		"range qdd=-2,2\nrange qd=-2,2",
		0, 0},
};
enum { CASE_COUNT = sizeof CASES / sizeof *CASES };

static const struct prove_options QUICK = {{RNEAGEN_F32, RNEAGEN_F64}, 2, 0.5, 2, 0, NULL, NULL};

static struct proof proof_of(const struct robot_box *x, struct prove_options o)
{
	struct progress silent = {0};
	struct rneagen_error e = {0};
	struct proof p;

	ck_assert_msg(!prove(&p, &x->analysis, &x->box, &o, &silent, &e), "%s", e.message);
	return p;
}

/* How many outputs of so many states are out of the proved range, or further off than is proved. */
static int broken(struct robot_box *x, const struct proof *p, int states, double wider, struct rng *r)
{
	int count = 0;

	for (int i = 0; i < states; i++) {
		int is_float = i % 2 == 0;

		robot_box_draw(x, r, is_float, wider);
		robot_box_evaluate(x);
		for (size_t o = 0; o < x->analysis.dag.output_count; o++) {
			const struct prove_row *row = &p->rows[o];
			double value = robot_box_value(x, o);

			count += !(value >= row->low && value <= row->high);
			if (i % 8 < 2 && o == (size_t)(i / 8) % x->analysis.dag.output_count)
				count += !(robot_box_error(x, o, is_float) <= row->error_bound[is_float ? 0 : 1]);
		}
	}
	return count;
}

static int has_slack(const struct proof *p, size_t count, double slack)
{
	int has = slack == 0 || sanitized();

	for (size_t o = 0; o < count && !has; o++) {
		const struct prove_row *r = &p->rows[o];

		if (fmax(fabs(r->low), fabs(r->high)) > slack * fmax(fabs(r->found_low), fabs(r->found_high)) + 1e-12)
			return 0;
	}
	return 1;
}

/* With more time where a slow machine needs it: half a second, 4 or 32. */
static struct proof proof_within(const struct robot_box *x, double slack)
{
	struct prove_options o = QUICK;
	struct proof p = proof_of(x, o);

	while (!has_slack(&p, x->analysis.dag.output_count, slack) && o.seconds < 30) {
		free(p.rows);
		o.seconds *= 8;
		p = proof_of(x, o);
	}
	return p;
}

static void check_slack(const struct proof *p, size_t count, double slack)
{
	for (size_t o = 0; o < count; o++) {
		const struct prove_row *r = &p->rows[o];
		double found = fmax(fabs(r->found_low), fabs(r->found_high)), proved = fmax(fabs(r->low), fabs(r->high));

		ck_assert(r->low <= r->found_low + 1e-12 * found && r->high >= r->found_high - 1e-12 * found);
		ck_assert_msg(slack == 0 || sanitized() || proved <= slack * found + 1e-12, "row %zu: %g proved, %g found", o, proved, found);
		for (int k = 0; k < 2; k++)
			ck_assert_msg(r->error_bound[k] * ABOVE >= r->error_found[k], "row %zu: %g proved, %g found", o, r->error_bound[k],
				r->error_found[k]);
	}
}

START_TEST(test_holds)
{
	struct rng r = rng_seed(SEED + (uint64_t)_i);
	struct robot_box x;
	struct proof p;

	if (CASES[_i].is_long && !exhaustive())
		return;
	robot_box_open(&x, CASES[_i].name, CASES[_i].scene, 0);
	p = proof_within(&x, CASES[_i].slack);
	check_slack(&p, x.analysis.dag.output_count, CASES[_i].slack);
	ck_assert_msg(!broken(&x, &p, exhaustive() ? MANY : FEW, 0, &r), "%s does not hold (seed %d)", CASES[_i].name, SEED + _i);
	free(p.rows);
	robot_box_close(&x);
}
END_TEST

/* Ranges by the URDF's constants, errors of a text by base parameters: both hold, and errors are not those of the URDF's text.
   Would catch one taken for the other. */
START_TEST(test_stated)
{
	struct rng r = rng_seed(SEED);
	struct prove_options o = QUICK;
	struct robot_box base, stated;
	struct proof p, of_stated;
	double error = 0, error_stated = 0;

	robot_box_open(&base, "iiwa14", "params base\nrange qdd=-20,20", 0);
	robot_box_open(&stated, "iiwa14", "params urdf\nrange qdd=-20,20", 0);
	of_stated = proof_of(&stated, o);
	o.stated = &stated.analysis;
	p = proof_of(&base, o);
	ck_assert(!broken(&base, &p, FEW, 0, &r));
	for (size_t i = 0; i < base.analysis.dag.output_count; i++) {
		error += p.rows[i].error_bound[0];
		error_stated += of_stated.rows[i].error_bound[0];
	}
	ck_assert_msg(error < 0.8 * error_stated, "%g by base parameters, %g", error, error_stated);
	free(p.rows);
	free(of_stated.rows);
	robot_box_close(&stated);
	robot_box_close(&base);
}
END_TEST

/* A proof for gravity that is a tenth smaller; states of a box that is a fifth wider. */
START_TEST(test_wrong_model)
{
	struct rng r = rng_seed(SEED);
	struct robot_box x, y;
	struct proof p;

	robot_box_open(&x, "double_pendulum", CASES[1].scene, 0);
	robot_box_open(&y, "double_pendulum", CASES[1].scene, 9.81 * 0.8);
	p = proof_of(&y, QUICK);
	ck_assert(broken(&x, &p, 2000, 0, &r) > 0);
	ck_assert(broken(&y, &p, 2000, 0, &r) == 0);
	ck_assert(broken(&y, &p, 2000, 0.1, &r) > 0);
	free(p.rows);
	robot_box_close(&y);
	robot_box_close(&x);
}
END_TEST

/* Leaving out the roundings of products, sums, constants or sines gives bounds below those of single states. */
START_TEST(test_missing_rounding)
{
	struct effort effort = robot_box_effort();
	struct prove_options o = QUICK;
	struct robot_box x;
	struct relaxed relaxed;
	struct proof p;
	struct prove_row *rows;

	robot_box_open(&x, "double_pendulum", CASES[0].scene, 0);
	o.precision_count = 1;
	p = proof_of(&x, o);
	ck_assert(!relax(&relaxed, &x.analysis, x.box.rows, &x.arena, &x.error));
	rows = calloc(x.analysis.dag.output_count, sizeof *rows);
	for (int left_out = 0; left_out < 4; left_out++) {
		struct rneagen_options of = x.options;
		struct eval_model m;

		of.precision = RNEAGEN_F32;
		m = eval_model_of(&of, 0);
		m.mul = left_out == 1 ? 0 : m.mul;
		m.add = left_out == 2 ? 0 : m.add;
		m.sincos = left_out == 3 ? 0 : m.sincos;
		rows[0] = (struct prove_row){.low = -1e300, .high = 1e300};
		ck_assert(rounding_find(rows, &relaxed, &x.box, &m, 1, &effort, 0.2));
		ck_assert_msg((rows[0].error_bound[0] * ABOVE >= p.rows[0].error_found[0]) == !left_out, "%d left out: %g, %g found", left_out,
			rows[0].error_bound[0], p.rows[0].error_found[0]);
	}
	workers_close(effort.workers);
	free(rows);
	free(p.rows);
	robot_box_close(&x);
}
END_TEST

/* A time that was over before it began leaves bounds that hold. */
START_TEST(test_no_time)
{
	static const char *const names[] = {"atlas", "hyq"};
	struct rng r = rng_seed(SEED);
	struct prove_options o = QUICK;
	struct robot_box x;
	struct proof p;

	o.start = 1e-9;
	o.seconds = 1e-9;
	robot_box_open(&x, names[_i], "range qdd=-20,20", 0);
	p = proof_of(&x, o);
	for (size_t i = 0; i < x.analysis.dag.output_count; i++)
		ck_assert(isfinite(p.rows[i].high - p.rows[i].low) && isfinite(p.rows[i].error_bound[0]) && isfinite(p.rows[i].error_bound[1]));
	check_slack(&p, x.analysis.dag.output_count, 0);
	ck_assert(!broken(&x, &p, FEW, 0, &r));
	free(p.rows);
	robot_box_close(&x);
}
END_TEST

/* What overflows is named by the text's node, though the proof is about relaxed expressions: the acceleration of a hip. */
START_TEST(test_overflow)
{
	struct effort effort = robot_box_effort();
	struct eval_model m;
	struct robot_box x;
	struct relaxed relaxed;
	struct prove_row *rows;

	robot_box_open(&x, "floating:hyq", "range qdd=-1,1\nrange qd=-1e19,1e19", 0);
	x.options.precision = RNEAGEN_F32;
	m = eval_model_of(&x.options, 0);
	ck_assert(!relax(&relaxed, &x.analysis, x.box.rows, &x.arena, &x.error) && !relaxed.is_same);
	rows = calloc(x.analysis.dag.output_count, sizeof *rows);
	ck_assert(rounding_find(rows, &relaxed, &x.box, &m, 1, &effort, 0.1));
	for (size_t i = 0; i < x.analysis.dag.output_count; i++) {
		const struct prove_gap *g = &rows[i].gaps[0];

		ck_assert(isinf(rows[i].error_bound[0]) && g->why == PROVE_OVERFLOW && g->size > g->most);
		if (x.analysis.dag.outputs[i].row >= 6)
			ck_assert_str_eq(x.analysis.dag.nodes[g->node].tag.quantity, "a");
	}
	free(rows);
	workers_close(effort.workers);
	robot_box_close(&x);
}
END_TEST

/* A continuous joint stands for all angles. */
START_TEST(test_continuous)
{
	struct rng r = rng_seed(SEED);
	struct robot_box x;
	struct proof p;

	robot_box_open(&x, "double_pendulum", "range q=-1000,1000\nrange qd=-1,1\nrange qdd=-1,1", 0);
	p = proof_of(&x, QUICK);
	check_slack(&p, x.analysis.dag.output_count, 1.1);
	ck_assert(!broken(&x, &p, FEW, 0, &r));
	free(p.rows);
	robot_box_close(&x);
}
END_TEST

/* Constants that are changed, other outputs, forward dynamics: refused, not proved. */
START_TEST(test_refused)
{
	static const char *const scenes[] = {"drop-below 1e-3", "want power", "want qdd\nrange tau=-1,1"};
	char scene[256];
	struct rneagen_error e = {0};
	struct progress silent = {0};
	struct robot_box x;
	struct proof p;

	snprintf(scene, sizeof scene, "range q=-1,1\nrange qd=-1,1\n%s%s", scenes[_i], _i < 2 ? "\nrange qdd=-1,1" : "");
	robot_box_open(&x, "double_pendulum", scene, 0);
	ck_assert(prove(&p, &x.analysis, &x.box, &QUICK, &silent, &e) == RNEAGEN_UNSUPPORTED);
	free(p.rows);
	robot_box_close(&x);
}
END_TEST

int main(void)
{
	Suite *suite = suite_create("prove");

	suite_add(suite, "holds", test_holds, CASE_COUNT, 6000);
	suite_add(suite, "stated", test_stated, 1, 600);
	suite_add(suite, "wrong model", test_wrong_model, 1, 600);
	suite_add(suite, "missing rounding", test_missing_rounding, 1, 600);
	suite_add(suite, "no time", test_no_time, 2, 600);
	suite_add(suite, "continuous", test_continuous, 1, 600);
	suite_add(suite, "overflow", test_overflow, 1, 600);
	suite_add(suite, "refused", test_refused, 3, 600);
	return suite_run(suite);
}
