/* Gradients of long chains, whose coordinates go back to the base in loops, of torques, and of accelerations, whose columns are
   solved in a loop behind them: one sample's and a batch's, compiled as C, beside central differences of the independent
   reference. This would catch a coordinate that another one's vector writes over, an element in another's place, one that no loop
   makes, and what is shared but made too late. */
#include "texts/kernels/launched.h"
#include "reference/differences.h"
#include "reference/forward.h"
#include "support/exhaustive.h"
#include "support/random_robot.h"
#include "support/rng.h"
#include "support/suite.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Several blocks of samples, and some that are left over, which are computed one by one. */
enum { COUNT = 41, SEED = 20261128, CHECKED = 3 };

static const struct subject {
	const char *scene;
	int links, floating;
	double prismatic, planar, branching, inner; /* inner: joints that float between others */
	enum rneagen_precision precision;
	enum rneagen_layout layout;
	enum { NONE, WAY_BACK, COLUMNS } loops; /* over coordinates that go back to the base, or over columns alone */
	int is_long; /* to make and to compile */
} SUBJECTS[] = {
	{"want tau,dtau_dq,dtau_dqd\n", 50, 0, 0.2, 0, 0.02, 0, RNEAGEN_F64, RNEAGEN_SOA, WAY_BACK, 0},
	{"want dtau_dqd,dtau_dq\n", 46, 1, 0, 0.1, 0.02, 0, RNEAGEN_F64, RNEAGEN_AOS, WAY_BACK, 1},
	{"want tau,dtau_dqd\ndense\n", 56, 0, 0.1, 0.1, 0.02, 0, RNEAGEN_F32, RNEAGEN_SOA, WAY_BACK, 1},
	{"want dtau_dqd\n", 42, 0, 0, 0, 0, 0, RNEAGEN_F64, RNEAGEN_AOS, WAY_BACK, 1}, /* reads no qdd */
	{"want qdd,dqdd_dq,dqdd_dqd\n", 42, 0, 0.1, 0.1, 0.02, 0, RNEAGEN_F64, RNEAGEN_SOA, WAY_BACK, 1},
	{"want dqdd_dqd\ndense\n", 46, 0, 0, 0, 0.01, 0, RNEAGEN_F64, RNEAGEN_AOS, WAY_BACK, 0},
	{"want qdd,dqdd_dqd,dqdd_dq\n", 42, 0, 0, 0, 0, 0, RNEAGEN_F32, RNEAGEN_SOA, WAY_BACK, 1},
	/* samples that would have room to be turned, were it not for columns: in one answer of two they were, and nothing compiled */
	{"want dqdd_dq\n", 30, 0, 0, 0, 0, 0, RNEAGEN_F64, RNEAGEN_AOS, COLUMNS, 0},
	{"want tau,dtau_dq\n", 42, 0, 0, 0, 0, 0, RNEAGEN_F32, RNEAGEN_AOS, WAY_BACK, 0},
	{"want dqdd_dqd\ndynamics factor\n", 42, 0, 0, 0, 0, 0, RNEAGEN_F64, RNEAGEN_SOA, NONE, 1},
	{"want dqdd_dq\n", 42, 1, 0, 0, 0, 0, RNEAGEN_F64, RNEAGEN_SOA, NONE, 1}, /* a base that floats */
	{"want tau,dtau_dq,dtau_dqd\n", 30, 0, 0, 0, 0, 0, RNEAGEN_F64, RNEAGEN_SOA, NONE, 0}, /* too short */
	{"want tau,dtau_dq,dtau_dqd\n", 60, 0, 0, 0, 0.8, 0, RNEAGEN_F64, RNEAGEN_SOA, NONE, 1}, /* too many branches */
	{"want tau,dtau_dqd\n", 44, 0, 0, 0, 0, 0.1, RNEAGEN_F64, RNEAGEN_SOA, NONE, 1}, /* forward mode, as in the next two */
	{"want dtau_dq,dtau_dqd\nfext link_04_5\nfext-frame world\n", 44, 0, 0, 0, 0, 0, RNEAGEN_F64, RNEAGEN_SOA, NONE, 0},
	{"want tau,dtau_dq\nderivatives forward\n", 44, 0, 0, 0, 0, 0, RNEAGEN_F64, RNEAGEN_SOA, NONE, 1},
	{"want dtau_dq,M\n", 48, 0, 0, 0, 0, 0, RNEAGEN_F64, RNEAGEN_SOA, NONE, 1},
	{"want tau,dtau_dq\n", 48, 0, 0, 0, 0, 0, RNEAGEN_MIXED, RNEAGEN_SOA, NONE, 1},
};
enum { SUBJECT_COUNT = sizeof SUBJECTS / sizeof *SUBJECTS };

static int is_forward(const struct subject *s)
{
	return strstr(s->scene, "dqdd") != NULL;
}

static char *draw(const struct subject *s)
{
	const struct random_robot_knobs knobs = {.links = s->links, .branching = s->branching, .fixed = 0.02, .continuous = 0.2,
		.prismatic = s->prismatic, .planar = s->planar, .floating = s->inner,
		.odd_axis = 0.3, .right_rpy = 0.3, .general_rpy = 0.2, .massless = is_forward(s) ? 0 : 0.05,
		.points = is_forward(s) ? 0 : 0.1, .rotated = 0.3, .root_mass = s->floating};

	return random_robot(SEED, &knobs);
}

static void generate(const struct subject *s, const char *urdf, struct target *t)
{
	struct rneagen_options o = rneagen_options_default();

	o.target = RNEAGEN_TARGET_C;
	o.precision = s->precision;
	o.layout = s->layout;
	o.scene = s->scene;
	o.base = s->floating ? RNEAGEN_FLOATING : RNEAGEN_FIXED;
	target_generate(t, urdf, strlen(urdf), &o, "a chain");
}

/* ---- what is right ---- */

/* The entry of a row of qd. */
static int entry_of(const struct reference *r, int row)
{
	int k = 0;

	while (r->joints[k].nv == 0 || row < r->joints[k].iv || row >= r->joints[k].iv + r->joints[k].nv)
		k++;
	return k;
}

static int is_at_or_above(const struct reference *r, int above, int entry)
{
	while (entry > above)
		entry = r->joints[entry].parent;
	return entry == above;
}

/* Do their joints feel each other? Only such elements are stored, row by row, unless a matrix is dense. */
static int is_stored(const struct reference *r, const struct subject *s, int i, int j)
{
	int a = entry_of(r, i), b = entry_of(r, j);

	return is_forward(s) || strstr(s->scene, "dense") != NULL || is_at_or_above(r, a, b) || is_at_or_above(r, b, a);
}

struct matrices {
	wide *by[2], *M, *work;
};

static struct matrices new_matrices(const struct reference *r)
{
	size_t elements = (size_t)r->nv * (size_t)r->nv;

	return (struct matrices){{calloc(elements, sizeof(wide)), calloc(elements, sizeof(wide))}, calloc(elements, sizeof(wide)),
		calloc(REFERENCE_WORK(r), sizeof(wide))};
}

static void free_matrices(struct matrices *x)
{
	free(x->by[0]);
	free(x->by[1]);
	free(x->M);
	free(x->work);
}

/* ---- what the text gives ---- */

/* Inputs, in turn q, qd and qdd, whose angles are all small, and outputs that nobody has written. */
static struct launch draw_batch(struct rnea_robot *robot, const struct subject *s)
{
	struct launch b = {robot, rnea_info(robot), COUNT, NULL};
	size_t arguments = b.info->input_count + b.info->output_count;
	struct rng rng = rng_seed(SEED);

	b.arrays = calloc(arguments, sizeof *b.arrays);
	for (size_t i = 0; i < arguments; i++) {
		size_t rows = b.info->arguments[i].rows;

		b.arrays[i] = calloc(rows * COUNT, sizeof(double));
		for (size_t k = 0; k < COUNT; k++)
			for (size_t row = 0; row < rows; row++) {
				int is_base = s->floating && i == 0 && row >= 3 && row < 7;

				launched_set(&b, i, row, k,
					i >= b.info->input_count ? (double)NAN : is_base ? 0.5 - (row == 5) : rng_uniform(&rng, -1, 1));
			}
	}
	return b;
}

static double largest(const wide *x, int count)
{
	double most = 0;

	for (int i = 0; i < count; i++)
		most = fmax(most, fabs((double)x[i]));
	return most;
}

/* The largest error of a matrix, by its largest element. */
static double error_of(const struct launch *b, size_t argument, size_t sample, const struct reference *r, const struct subject *s,
	const wide *right)
{
	double most = largest(right, r->nv * r->nv), worst = 0;
	size_t row = 0;

	for (int i = 0; i < r->nv; i++)
		for (int j = 0; j < r->nv; j++)
			if (is_stored(r, s, i, j)) {
				double error = fabs(launched_get(b, argument, row++, sample) - (double)right[i * r->nv + j]) / most;

				worst = !(error <= worst) ? error : worst;
			}
	ck_assert_uint_eq(row, b->info->arguments[argument].rows);
	return worst;
}

/* Of one sample's q, qd, and qdd or tau. */
static void find_right(struct reference *r, const struct subject *s, double *const in[3], struct matrices *x)
{
	wide *state[3];

	if (!is_forward(s)) {
		reference_differences(r, in[0], in[1], in[2], x->by[0], x->by[1], x->M, x->work);
		return;
	}
	for (int i = 0; i < 3; i++) {
		state[i] = calloc((size_t)r->nq, sizeof(wide));
		for (int k = 0; k < (i ? r->nv : r->nq); k++)
			state[i][k] = in[i][k];
	}
	reference_forward_differences(r, NULL, state[0], state[1], state[2], x->by[0], x->by[1]);
	for (int i = 0; i < 3; i++)
		free(state[i]);
}

static double error_in(const struct launch *b, size_t sample, struct reference *r, const struct subject *s)
{
	struct matrices x = new_matrices(r);
	double *in[3], worst = 0;

	for (size_t i = 0; i < 3; i++) {
		in[i] = calloc((size_t)r->nq, sizeof(double));
		for (size_t row = 0; i < b->info->input_count && row < b->info->arguments[i].rows; row++)
			in[i][row] = launched_get(b, i, row, sample);
	}
	find_right(r, s, in, &x);
	for (size_t i = b->info->input_count; i < b->info->input_count + b->info->output_count; i++) {
		const char *name = b->info->arguments[i].name;

		if (strstr(name, "_dq") != NULL) {
			double error = error_of(b, i, sample, r, s, x.by[strstr(name, "_dqd") != NULL]);

			worst = !(error <= worst) ? error : worst;
		}
	}
	for (size_t i = 0; i < 3; i++)
		free(in[i]);
	free_matrices(&x);
	return worst;
}

static void check_values(const struct subject *s, const struct target *t, const char *urdf)
{
	static const size_t checked[CHECKED] = {0, 17, COUNT - 1};
	struct reference_options how = {.floating = s->floating};
	char message[200];
	struct reference *r = reference_open(urdf, strlen(urdf), &how, message, sizeof message);
	struct rnea_robot *robot = launched_open(t, RNEA_BACKEND_HOST, 0);
	struct launch b = draw_batch(robot, s);
	struct rnea_error e;

	ck_assert_msg(r != NULL, "%s", message);
	ck_assert_msg(!rnea_launch(robot, b.arrays, COUNT, NULL, &e), "%s", e.message);
	for (int k = 0; k < CHECKED; k++) {
		double worst = error_in(&b, checked[k], r, s);

		printf("%s, sample %zu: within %.1e, seed %d\n", t->what, checked[k], worst, SEED);
		ck_assert_double_lt(worst, s->precision == RNEAGEN_F32 ? 2e-4 : is_forward(s) ? 1e-7 : 1e-9);
	}
	launched_free(&b);
	reference_close(r);
}

START_TEST(test_chain)
{
	const struct subject *s = &SUBJECTS[_i];
	char *urdf;
	struct target t;

	if (s->is_long && !exhaustive())
		return;
	urdf = draw(s);
	generate(s, urdf, &t);
	ck_assert_int_eq(strstr(t.text.source, "_set_out(") != NULL, s->loops == WAY_BACK);
	if (s->loops)
		check_values(s, &t, urdf);
	rneagen_result_free(&t.text);
	free(urdf);
}
END_TEST

int main(void)
{
	Suite *s = suite_create("way_back");

	launched_pretend();
	suite_add(s, "chain", test_chain, SUBJECT_COUNT, 120);
	return suite_run(s);
}
