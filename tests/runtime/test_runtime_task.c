/* Texts that a scene made, through the runtime: what is the same for the whole batch, cut into slices or not, outputs
   beside the torques, no fpass and no bpass. On the host and on the pretended driver, against the reference. */
#define _POSIX_C_SOURCE 200809L
#include "urdf.h"
#include "reference/reference.h"
#include "support/suite.h"
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

enum { COUNT = 70000, STEP = 997, SEED = 20261121, NV = 7 };
enum { Q, QD, GRAVITY, PAYLOAD, TAU, POWER, ARRAYS };

#define IIWA TEST_DIR "/robots/iiwa14.urdf"

static const char *const NAMES[ARRAYS] = {"q", "qd", "gravity", "payload_iiwa_link_7", "tau", "power"};
static const size_t WIDTHS[ARRAYS] = {NV, NV, 3, 10, NV, 1};

static struct rnea_robot *open_robot(enum rnea_backend backend, enum rneagen_layout layout)
{
	struct rneagen_options g = rneagen_options_default();
	struct rnea_options o = {.backend = backend, .threads = 2};
	struct rnea_robot *robot;
	struct rnea_error e;

	g.scene = "free gravity:batch\nfree payload.iiwa_link_7:batch\nwant tau,power\nfold qdd=0\n";
	g.precision = RNEAGEN_F64;
	g.layout = layout;
	ck_assert_msg(!rnea_open_urdf(IIWA, &g, &o, &robot, &e), "%s", e.message);
	return robot;
}

static size_t place(enum rneagen_layout layout, int array, size_t sample, size_t row)
{
	return layout == RNEAGEN_AOS ? sample * WIDTHS[array] + row : row * COUNT + sample;
}

/* The numbers of all inputs; what is for the whole batch has no room for more than one sample. */
static void fill(double **x, enum rneagen_layout layout)
{
	struct rng rng = rng_seed(SEED);

	for (int i = 0; i < ARRAYS; i++)
		x[i] = calloc(i == GRAVITY || i == PAYLOAD ? 1 : COUNT, WIDTHS[i] * sizeof **x);
	for (int i = 0; i < TAU; i++)
		for (size_t k = 0; k < (i == GRAVITY || i == PAYLOAD ? 1 : COUNT); k++)
			for (size_t r = 0; r < WIDTHS[i]; r++)
				x[i][i == GRAVITY || i == PAYLOAD ? r : place(layout, i, k, r)] = rng_uniform(&rng, -3, 3);
}

static void check(double *const *x, enum rneagen_layout layout)
{
	char message[512];
	struct reference *r = reference_open_file(IIWA, NULL, message, sizeof message);
	wide p[10], tau[NV];

	ck_assert_msg(r != NULL, "%s", message);
	for (int i = 0; i < r->nj; i++)
		if (!strcmp(r->joints[i].link, "iiwa_link_7")) {
			reference_inertia(r, i, p);
			for (int c = 0; c < 10; c++)
				p[c] += (wide)x[PAYLOAD][c];
			reference_set_inertia(r, i, p);
		}
	for (int i = 0; i < 3; i++)
		r->gravity[i] = (wide)x[GRAVITY][i];
	for (size_t k = 0; k < COUNT; k += STEP) {
		double q[NV], qd[NV], got[NV];
		static const double zero[NV];
		wide power = 0, size = 0;

		for (size_t i = 0; i < NV; i++) {
			q[i] = x[Q][place(layout, Q, k, i)];
			qd[i] = x[QD][place(layout, QD, k, i)];
			got[i] = x[TAU][place(layout, TAU, k, i)];
		}
		reference_rnea(r, q, qd, zero, tau);
		for (int i = 0; i < NV; i++) {
			power += tau[i] * (wide)qd[i];
			size += wide_abs(tau[i] * (wide)qd[i]);
		}
		ck_assert_msg(reference_error(got, tau, NV) < 1e-13, "sample %zu, seed %d", k, SEED);
		ck_assert_msg(wide_abs((wide)x[POWER][k] - power) < 1e-13L * size, "power, sample %zu, seed %d", k, SEED);
	}
	reference_close(r);
}

static enum rnea_backend backend_of(int i)
{
	return i % 2 ? RNEA_BACKEND_CUDA : RNEA_BACKEND_HOST;
}

/* A batch of several slices of rnea_run. */
START_TEST(test_run)
{
	enum rneagen_layout layout = _i / 2 ? RNEAGEN_AOS : RNEAGEN_SOA;
	struct rnea_robot *robot = open_robot(backend_of(_i), layout);
	const struct rnea_info *info = rnea_info(robot);
	double *x[ARRAYS];
	void *arguments[ARRAYS];
	struct rnea_error e;

	fill(x, layout);
	ck_assert_uint_eq(info->input_count + info->output_count, ARRAYS);
	for (int i = 0; i < ARRAYS; i++) {
		int at = rnea_bind(robot, NAMES[i]);

		ck_assert_int_ge(at, 0);
		ck_assert(info->arguments[at].rows == WIDTHS[i] &&
			info->arguments[at].per_batch == (i == GRAVITY || i == PAYLOAD));
		arguments[at] = x[i];
	}
	ck_assert_msg(!rnea_run(robot, arguments, COUNT, &e), "%s", e.message);
	check(x, layout);
	for (int i = 0; i < ARRAYS; i++)
		free(x[i]);
	rnea_close(robot);
}
END_TEST

/* What is not there is refused by name. */
START_TEST(test_refused)
{
	struct rnea_robot *robot = open_robot(backend_of(_i), RNEAGEN_SOA);
	double room[64] = {0};
	void *arguments[ARRAYS];
	struct rnea_resources resources;
	struct rnea_error e;

	for (int i = 0; i < ARRAYS; i++)
		arguments[i] = room;
	ck_assert_uint_eq(rnea_argument_count(robot, "rnea"), ARRAYS);
	ck_assert_uint_eq(rnea_argument_count(robot, "fpass"), 0);
	ck_assert_uint_eq(rnea_argument_count(robot, "bpass"), 0);
	ck_assert_int_eq(rnea_launch_kernel(robot, "fpass", arguments, 1, NULL, &e), RNEA_KERNEL);
	ck_assert_ptr_nonnull(strstr(e.message, "has no function \"fpass\"; it has rnea"));
	ck_assert_int_eq(rnea_resources(robot, "bpass", &resources, &e), RNEA_KERNEL);
	arguments[rnea_bind(robot, "gravity")] = NULL;
	ck_assert_int_eq(rnea_run(robot, arguments, 1, &e), RNEA_POINTER);
	ck_assert_ptr_nonnull(strstr(e.message, "\"gravity\", is NULL"));
	arguments[rnea_bind(robot, "gravity")] = (void *)((uintptr_t)room + 4);
	ck_assert_int_eq(rnea_launch(robot, arguments, 1, NULL, &e), RNEA_POINTER);
	ck_assert_ptr_nonnull(strstr(e.message, "\"gravity\", is not aligned"));
	ck_assert_int_eq(rnea_bind(robot, "qdd"), -1);
	rnea_close(robot);
}
END_TEST

int main(void)
{
	Suite *s = suite_create("runtime_task");
	TCase *c = tcase_create("runtime_task");

	setenv("RNEA_LIBCUDA", FAKE_CUDA, 1);
	setenv("RNEA_NVRTC", FAKE_NVRTC, 1);
	setenv("RNEA_CACHE", "", 1);
	tcase_set_timeout(c, 60);
	tcase_add_loop_test(c, test_run, 0, 4);
	tcase_add_loop_test(c, test_refused, 0, 2);
	suite_add_tcase(s, c);
	return suite_run(s);
}
