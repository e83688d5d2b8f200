/* Batches of every size beside the independent reference, in texts for target C: whole groups of samples, those that are left
   over and computed beside others or beside copies, samples that are turned in layout aos, and large angles among them. Arrays
   end where a page begins that traps. This would catch a sample that is left out or computed from another's inputs, a row that is
   turned to another's place, and a group that reads or writes beyond the batch. */
#include "reference/reference.h"
#include "support/exhaustive.h"
#include "support/rng.h"
#include "support/suite.h"
#include "target/target.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { SEED = 20261129, MOST = 71, ROWS = 64, FAR = 11 };

/* Vectors of several lengths go by other loops, and by other sizes from which a group is worth its time. */
static const struct compiler COMPILERS[] = {
	{"gcc", {"-O2"}},
	{"gcc", {"-O1", "-mavx2", "-mfma"}},
	{"gcc", {"-O0"}},
	{"clang", {"-O2", "-mavx2", "-mfma"}},
};

static const struct subject {
	const char *robot;
	enum rneagen_precision precision;
	enum rneagen_layout layout;
	int floating, segments, compiler, is_long;
	double most;
} SUBJECTS[] = {
	{"ur5", RNEAGEN_F64, RNEAGEN_SOA, 0, 0, 0, 0, 1e-13},
	{"ur5", RNEAGEN_F32, RNEAGEN_AOS, 0, 0, 1, 0, 2e-5},
	{"cartpole", RNEAGEN_F64, RNEAGEN_AOS, 1, 0, 1, 0, 1e-13}, /* q has a row more than qd */
	{"gantry", RNEAGEN_F64, RNEAGEN_SOA, 0, 0, 1, 0, 1e-13},    /* reads no angle */
	{"panda", RNEAGEN_F64, RNEAGEN_SOA, 0, 150, 0, 0, 1e-13},   /* in segments */
	{"ur5", RNEAGEN_F32, RNEAGEN_AOS, 0, 150, 1, 0, 2e-5},
	{"ur5", RNEAGEN_MIXED, RNEAGEN_AOS, 0, 0, 2, 0, 2e-6},
	{"ur5", RNEAGEN_F64, RNEAGEN_AOS, 0, 0, 3, 0, 1e-13},
	{"ur5", RNEAGEN_F32, RNEAGEN_SOA, 0, 0, 3, 0, 2e-5},
	{"ur5", RNEAGEN_F32X2, RNEAGEN_AOS, 0, 0, 1, 1, 1e-10},
	{"hyq", RNEAGEN_F64, RNEAGEN_AOS, 1, 0, 0, 1, 1e-13},
	{"atlas", RNEAGEN_F32, RNEAGEN_SOA, 0, 0, 1, 1, 2e-5},
	{"atlas", RNEAGEN_F64, RNEAGEN_AOS, 0, 0, 0, 1, 1e-13},
};
enum { SUBJECT_COUNT = sizeof SUBJECTS / sizeof *SUBJECTS };

/* q, qd, qdd and tau of some samples. */
struct batch {
	int rows[4];
	size_t count;
	struct array arrays[4];
};

static size_t place_of(const struct batch *b, const struct subject *s, int array, int row, size_t sample)
{
	return s->layout == RNEAGEN_SOA ? (size_t)row * b->count + sample : sample * (size_t)b->rows[array] + (size_t)row;
}

static double drawn(const struct subject *s, int array, int row, size_t sample, struct rng *rng)
{
	int is_quaternion = s->floating && array == 0 && row >= 3 && row < 7;
	double x = rng_uniform(rng, -1, 1);

	if (is_quaternion)
		return 0.5 - (row == 5);
	if (array == 0 && sample % FAR == FAR - 1 && row == (s->floating ? 7 : 1))
		x *= s->precision == RNEAGEN_F32 ? 2e4 : 2e7; /* larger than what a group takes */
	return s->precision == RNEAGEN_F64 || s->precision == RNEAGEN_F32X2 ? x : (double)(float)x;
}

static struct batch new_batch(const struct subject *s, const struct target *t, const struct reference *r, size_t count)
{
	struct batch b = {{r->nq, r->nv, r->nv, r->nv}, count, {{0}}};
	struct rng rng = rng_seed(SEED + count);

	for (int i = 0; i < 4; i++) {
		b.arrays[i] = array_new(t->f32, (size_t)b.rows[i] * count);
		for (size_t k = 0; k < count; k++)
			for (int row = 0; row < b.rows[i]; row++)
				array_set(&b.arrays[i], place_of(&b, s, i, row, k), i == 3 ? (double)NAN : drawn(s, i, row, k, &rng));
	}
	return b;
}

/* ||tau - reference|| / ||reference||, of a sample. */
static double error_of(const struct batch *b, const struct subject *s, struct reference *r, size_t sample)
{
	double x[3][ROWS], error = 0, norm = 0;
	wide tau[ROWS];

	for (int i = 0; i < 3; i++)
		for (int row = 0; row < b->rows[i]; row++)
			x[i][row] = array_get(&b->arrays[i], place_of(b, s, i, row, sample));
	reference_rnea(r, x[0], x[1], x[2], tau);
	for (int row = 0; row < r->nv; row++) {
		error += pow(array_get(&b->arrays[3], place_of(b, s, 3, row, sample)) - (double)tau[row], 2);
		norm += pow((double)tau[row], 2);
	}
	return sqrt(error / norm);
}

static void check_size(const struct subject *s, const struct target *t, struct reference *r, size_t count, double *worst)
{
	struct batch b = new_batch(s, t, r, count);

	target_batch(t, &b.arrays[0], &b.arrays[1], &b.arrays[2], &b.arrays[3], count);
	for (size_t k = 0; k < count; k++) {
		double error = error_of(&b, s, r, k);

		ck_assert_msg(error < s->most, "%s: sample %zu of %zu is off by %g, seed %d", t->what, k, count, error, SEED);
		*worst = fmax(*worst, error);
	}
	for (int i = 0; i < 4; i++) {
		ck_assert(array_intact(&b.arrays[i]));
		array_free(&b.arrays[i]);
	}
}

static void open_text(const struct subject *s, const char *urdf, size_t length, struct target *t)
{
	struct rneagen_options o = rneagen_options_default();
	char stem[64];

	o.target = RNEAGEN_TARGET_C;
	o.precision = s->precision;
	o.layout = s->layout;
	o.base = s->floating ? RNEAGEN_FLOATING : RNEAGEN_FIXED;
	o.segments = s->segments ? s->segments : RNEAGEN_SEGMENTS_AUTO;
	snprintf(stem, sizeof stem, "groups_%s_%d%d%d", s->robot, s->precision, s->layout, s->segments > 0);
	target_open(t, urdf, length, &o, &COMPILERS[s->compiler], stem);
}

START_TEST(test_sizes)
{
	const struct subject *s = &SUBJECTS[_i];
	const struct reference_options how = {.floating = s->floating};
	int serves = compiler_serves(&COMPILERS[s->compiler], COMPILERS[s->compiler].flags[1] != NULL);
	char message[200];
	size_t length;
	char *urdf;
	struct reference *r;
	struct target t;
	double worst = 0;

	if (!serves || (s->is_long && !exhaustive()))
		return;
	urdf = target_robot(s->robot, &length);
	r = reference_open(urdf, length, &how, message, sizeof message);
	ck_assert_msg(r != NULL, "%s", message);
	ck_assert_int_le(r->nq, ROWS);
	open_text(s, urdf, length, &t);
	for (size_t count = 1; count <= MOST; count++)
		check_size(s, &t, r, count, &worst);
	printf("%s: batches of 1 to %d samples within %.1e, seed %d\n", t.what, MOST, worst, SEED);
	target_close(&t);
	reference_close(r);
	free(urdf);
}
END_TEST

int main(void)
{
	Suite *s = suite_create("groups");

	suite_add(s, "sizes", test_sizes, SUBJECT_COUNT, 120);
	return suite_run(s);
}
