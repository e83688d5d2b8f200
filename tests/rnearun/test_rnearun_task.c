/* test_rnearun_task RNEARUN: rnearun eval with scenes that free, fold and want, against the independent reference, whose
   links, gravity and forces from outside are changed for each sample. Both backends: this machine's processor, and the
   pretended GPU. What is refused is in test_rnearun_task_refused.c. */
#define _DEFAULT_SOURCE
#include "test_rnearun_task.h"
#include "support/process.h"
#include "reference/reference.h"
#include "states_file.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { COUNT = SAMPLES, SEED = 20261121, ROWS = 64, PAYLOAD = 10, PUSH = 6 };

/* ---- a scene with inputs of all kinds ---- */

struct sample {
	double q[ROWS], qd[ROWS], payload[PAYLOAD], push[PUSH];
};

struct scene_case {
	const char *urdf, *base, *payload, *push;
};

/* The third is the first with a link of another name. */
static const struct scene_case CASES[] = {{IIWA, "fixed", "iiwa_link_7", "iiwa_link_ee"},
	{ROBOTS "hyq.urdf", "floating", "lf_lowerleg", "trunk"}, {"hostile.urdf", "fixed", "left=hand '7'", "iiwa_link_ee"}};

enum { CASE_COUNT = sizeof CASES / sizeof *CASES };

struct fixture {
	const struct scene_case *x;
	struct reference *r;
	size_t nq, nv;
	int f32;
	struct sample samples[COUNT];
	double gravity[3];
	wide own[PAYLOAD]; /* what the link has by itself */
};

/* iiwa14 with a link of a name that needs care everywhere. */
static void write_hostile(void)
{
	static const char name[] = "\"iiwa_link_7\"", other[] = "\"left=hand '7'\"";
	FILE *from = fopen(IIWA, "r"), *to = fopen("hostile.urdf", "w");
	char line[1024];

	while (fgets(line, sizeof line, from)) {
		char *at = strstr(line, name);

		if (at)
			fprintf(to, "%.*s%s%s", (int)(at - line), line, other, at + sizeof name - 1);
		else
			fputs(line, to);
	}
	fclose(from);
	fclose(to);
}

static int find_entry(const struct reference *r, const char *link)
{
	for (int i = 0; i < r->nj; i++)
		if (!strcmp(r->joints[i].link, link))
			return i;
	ck_abort_msg("no link %s", link);
	return -1;
}

static void draw(struct rng *rng, int f32, double most, double *x, int count)
{
	for (int i = 0; i < count; i++) {
		x[i] = rng_uniform(rng, -most, most);
		x[i] = f32 ? (double)(float)x[i] : x[i];
	}
}

/* Any ten numbers are a payload: torques are linear in them. */
struct fixture *fixture_new(int i, int f32)
{
	struct fixture *f = calloc(1, sizeof *f);
	struct reference_options o = {0};
	struct rng rng = rng_seed(SEED);
	char message[512];
	double qdd[ROWS];

	f->x = &CASES[i];
	f->f32 = f32;
	o.floating = !strcmp(f->x->base, "floating");
	write_hostile();
	f->r = reference_open_file(f->x->urdf, &o, message, sizeof message);
	ck_assert_msg(f->r != NULL, "%s", message);
	f->nq = (size_t)f->r->nq;
	f->nv = (size_t)f->r->nv;
	reference_inertia(f->r, find_entry(f->r, f->x->payload), f->own);
	draw(&rng, f32, 9, f->gravity, 3);
	for (struct sample *s = f->samples; s < f->samples + COUNT; s++) {
		reference_sample(f->r, &rng, f32, s->q, s->qd, qdd);
		draw(&rng, f32, 1, s->payload, PAYLOAD);
		draw(&rng, f32, 20, s->push, PUSH);
	}
	return f;
}

void fixture_free(struct fixture *f)
{
	reference_close(f->r);
	free(f);
}

/* The members of all samples that `at` and `rows` name, after one another. */
static void write_parts(const struct fixture *f, const char *path, const size_t (*parts)[2], int part_count)
{
	size_t columns = 0;
	double *x;

	for (int p = 0; p < part_count; p++)
		columns += parts[p][1];
	x = malloc(COUNT * columns * sizeof *x);
	for (size_t k = 0, to = 0; k < COUNT; k++)
		for (int p = 0; p < part_count; p++) {
			memcpy(x + to, (const char *)&f->samples[k] + parts[p][0], parts[p][1] * sizeof *x);
			to += parts[p][1];
		}
	file_put_array(path, x, COUNT, columns, f->f32);
	free(x);
}

void write_inputs(const struct fixture *f)
{
	const size_t parts[][2] = {{offsetof(struct sample, q), f->nq}, {offsetof(struct sample, qd), f->nv},
		{offsetof(struct sample, payload), PAYLOAD}, {offsetof(struct sample, push), PUSH}};
	static const char *const names[] = {"q.npy", "qd.npy", "payload.npy", "push.npy"};

	write_parts(f, "in.npy", parts, 4);
	for (int i = 0; i < 4; i++)
		write_parts(f, names[i], &parts[i], 1);
	file_put_array("g.npy", f->gravity, 1, 3, f->f32);
}

/* tau and power of sample k, or, with nothing but q and qd, as the URDF has the rest. */
static void refer(struct fixture *f, size_t k, int is_bare, wide *tau, wide *power, wide *size)
{
	const struct sample *s = &f->samples[k];
	static const double zero[ROWS], down[3] = {0, 0, -9.81};
	wide p[PAYLOAD], w[PUSH];

	for (int i = 0; i < PAYLOAD; i++)
		p[i] = f->own[i] + (is_bare ? 0 : (wide)s->payload[i]);
	for (int i = 0; i < PUSH; i++)
		w[i] = is_bare ? 0 : (wide)s->push[i];
	for (int i = 0; i < 3; i++)
		f->r->gravity[i] = is_bare ? (wide)down[i] : (wide)f->gravity[i];
	reference_set_inertia(f->r, find_entry(f->r, f->x->payload), p);
	reference_set_push(f->r, find_entry(f->r, f->x->push), w, 0);
	reference_rnea(f->r, s->q, s->qd, zero, tau);
	*power = *size = 0;
	for (size_t i = 0; i < f->nv; i++) {
		*power += tau[i] * (wide)s->qd[i];
		*size += wide_abs(tau[i] * (wide)s->qd[i]);
	}
}

/* Rows first to first + nv - 1 and `power` of files that are [COUNT][columns]. */
static void assert_close(struct fixture *f, int is_bare, const double *tau, size_t columns, const double *power,
	size_t step, double most)
{
	for (size_t k = 0; k < COUNT; k++) {
		wide ref[ROWS], ref_power, size;

		refer(f, k, is_bare, ref, &ref_power, &size);
		ck_assert_msg(reference_error(tau + k * columns, ref, (int)f->nv) < most, "tau of sample %zu: %g, seed %d", k,
			reference_error(tau + k * columns, ref, (int)f->nv), SEED);
		ck_assert_msg(fabs(power[k * step] - (double)ref_power) <= most * (double)size,
			"power of sample %zu: %g, not %g, seed %d", k, power[k * step], (double)ref_power, SEED);
	}
}

static void assert_results(struct fixture *f, int is_bare, const double *tau, size_t columns, const double *power, size_t step)
{
	assert_close(f, is_bare, tau, columns, power, step, f->f32 ? 2e-5 : 1e-12);
}

void run_scene(const struct fixture *f, int status, const char *part, const char *const *more)
{
	char mass[300];
	const char *const options[] = {"--base", f->x->base, "--free", mass, "--free", "gravity:batch", "--fext",
		f->x->push, "--want", "tau,power", "--fold", "qdd=0", "--slice", "37"};
	const char *words[40] = {f->x->urdf};
	size_t n = sizeof options / sizeof *options;

	snprintf(mass, sizeof mass, "payload.%s", f->x->payload);
	memcpy(words + 1, options, sizeof options);
	for (size_t i = 0; more[i]; i++)
		words[1 + n + i] = more[i];
	run_eval(status, part, words);
}

static const char *const BACKENDS[] = {"cuda", "cpu"};

/* All inputs of samples in one file and all outputs in one. */
START_TEST(test_joined)
{
	struct fixture *f = fixture_new(_i / 4, _i % 2);
	size_t n, width = f->nv + 1;
	double *x;

	write_inputs(f);
	RUN_SCENE(f, 0, "", "--in", "in.npy", "--input", "gravity=g.npy", "--out", "out.npy", "--backend", BACKENDS[_i / 2 % 2]);
	x = file_numbers("out.npy", f->f32, &n);
	ck_assert_uint_eq(n, COUNT * width);
	assert_results(f, 0, x, width, x + f->nv, width);
	free(x);
	fixture_free(f);
	unlink("out.npy");
}
END_TEST

/* --drop-below knows that payloads, gravity and wrenches from outside are none of the URDF's; at 1e-12 nothing is seen of what
   it drops. */
START_TEST(test_dropped)
{
	struct fixture *f = fixture_new(_i, 0);
	size_t n, width = f->nv + 1;
	double *x;

	write_inputs(f);
	RUN_SCENE(f, 0, "", "--in", "in.npy", "--input", "gravity=g.npy", "--out", "out.npy", "--backend", "cpu",
		"--drop-below", "1e-12:sampled");
	x = file_numbers("out.npy", 0, &n);
	ck_assert_uint_eq(n, COUNT * width);
	assert_close(f, 0, x, width, x + f->nv, width, 1e-9);
	free(x);
	fixture_free(f);
}
END_TEST

/* 5 kg at the hand of a stretched panda: held by the reference, with and without. */
START_TEST(test_heavy_hand)
{
	const double q[8] = {0, 1.5707963267948966, 0, -0.1, 0, 1.5, 0, 0.02}, zero[8] = {0},
		     load[PAYLOAD] = {5, 0, 0, 0.25, 0.02, 0, 0, 0.02, 0, 0.01};
	struct reference_options o = {0};
	char message[512];
	struct reference *r = reference_open_file(ROBOTS "panda.urdf", &o, message, sizeof message);
	wide own[PAYLOAD], tau[8];
	double *x;
	size_t n;

	ck_assert_msg(r != NULL, "%s", message);
	reference_rnea(r, q, zero, zero, tau);
	printf("tau[1] of an empty hand %g", (double)tau[1]);
	reference_inertia(r, find_entry(r, "panda_hand"), own);
	for (int i = 0; i < PAYLOAD; i++)
		own[i] += (wide)load[i];
	reference_set_inertia(r, find_entry(r, "panda_hand"), own);
	reference_rnea(r, q, zero, zero, tau);
	printf(", with 5 kg %g\n", (double)tau[1]);
	file_put_array("q.npy", q, 1, 8, 0);
	file_put_array("payload.npy", load, 1, PAYLOAD, 0);
	RUN(0, "", ROBOTS "panda.urdf", "--free", "payload.panda_hand", "--drop-below", "1e-12:sampled", "--fold", "qd=0",
		"--fold", "qdd=0", "--q", "q.npy", "--input", "payload.panda_hand=payload.npy", "--out", "out.npy",
		"--backend", "cpu");
	x = file_numbers("out.npy", 0, &n);
	ck_assert_uint_eq(n, 8);
	ck_assert_msg(reference_error(x, tau, 8) < 1e-9, "%g, not %g", x[1], (double)tau[1]);
	free(x);
	reference_close(r);
}
END_TEST

/* Each array in a file of its own, by the scene's word and by the text's name; and none where one may be left out. */
START_TEST(test_apart)
{
	struct fixture *f = fixture_new(_i / 2, 0);
	const char *backend = BACKENDS[_i % 2];
	char payload[300], push[300];
	size_t n, m;
	double *tau, *power;

	write_inputs(f);
	snprintf(payload, sizeof payload, "payload.%s=payload.npy", f->x->payload);
	snprintf(push, sizeof push, "fext_%s=push.npy", f->x->push);
	RUN_SCENE(f, 0, "", "--q", "q.npy", "--input", "qd=qd.npy", "--input", payload, "--input", push, "--input",
		"gravity=g.npy", "--output", "tau=tau.npy", "--output", "power=power.npy", "--backend", backend);
	tau = file_numbers("tau.npy", 0, &n);
	power = file_numbers("power.npy", 0, &m);
	ck_assert(n == COUNT * f->nv && m == COUNT);
	assert_results(f, 0, tau, f->nv, power, 1);
	free(tau);
	free(power);
	RUN_SCENE(f, 0, "gravity: no file named: 0 0 -9.81, as the URDF has it", "--q", "q.npy", "--qd", "qd.npy", "--output",
		"tau=tau.npy", "--output", "power=power.npy", "--backend", backend);
	tau = file_numbers("tau.npy", 0, &n);
	power = file_numbers("power.npy", 0, &m);
	assert_results(f, 1, tau, f->nv, power, 1);
	free(tau);
	free(power);
	RUN_SCENE(f, 0, "", "--q", "q.npy", "--qd", "qd.npy", "--output", "power=power.npy", "--quiet", "--backend", backend);
	fixture_free(f);
}
END_TEST

/* The plain robot by the new names, a pipe for one of two outputs, and an array of one axis for the whole batch. */
START_TEST(test_mixed)
{
	static const char vector[] = "{'descr': '<f8', 'fortran_order': False, 'shape': (3,)}    ";
	struct fixture *f = fixture_new(0, 0);
	const char *const piped[] = {"sh", "-c",
		"\"$1\" eval \"$2\" --free gravity --fold qdd=0 --want tau,power --q q.npy --qd - --input gravity=g.npy "
		"--output tau=- --output power=power.npy <qd.npy >tau.npy", "sh", rnearun, IIWA, NULL};
	struct process p;
	FILE *g;
	size_t n, m;
	double *tau, *again;

	write_inputs(f);
	g = fopen("g.npy", "r+b");
	fseek(g, 10, SEEK_SET);
	fputs(vector, g);
	fclose(g);
	RUN(0, "", IIWA, "--free", "gravity", "--fold", "qdd=0", "--input", "gravity=g.npy", "--out", "out.npy",
		"--input", "q=q.npy", "--input", "qd=qd.npy");
	p = process_run(piped);
	ck_assert_msg(p.status == 0 && !*p.output, "%s", p.output);
	process_free(&p);
	tau = file_numbers("tau.npy", 0, &n);
	again = file_numbers("out.npy", 0, &m);
	ck_assert(n == m && n == COUNT * 7);
	ck_assert(!memcmp(tau, again, n * sizeof *tau));
	free(tau);
	free(again);
	fixture_free(f);
}
END_TEST

/* Where no input has samples there is one. */
START_TEST(test_no_samples)
{
	double zero[7] = {0}, *x;
	struct fixture *f = fixture_new(0, 0);
	wide ref[7];
	size_t n;

	RUN(0, "", IIWA, "--fold", "q=0", "--fold", "qd=0", "--fold", "qdd=0", "--out", "out.npy", "--precision",
		"f64", "--backend", BACKENDS[_i]);
	reference_rnea(f->r, zero, zero, zero, ref);
	x = file_numbers("out.npy", 0, &n);
	ck_assert_uint_eq(n, 7);
	ck_assert(reference_error(x, ref, 7) < 1e-13);
	free(x);
	fixture_free(f);
}
END_TEST

static Suite *suite(void)
{
	Suite *s = suite_create("rnearun_task");
	TCase *c = tcase_create("rnearun_task");

	tcase_set_timeout(c, 120);
	tcase_add_loop_test(c, test_joined, 0, 4 * CASE_COUNT);
	tcase_add_loop_test(c, test_dropped, 0, CASE_COUNT);
	tcase_add_test(c, test_heavy_hand);
	tcase_add_loop_test(c, test_apart, 0, 2 * CASE_COUNT);
	tcase_add_test(c, test_mixed);
	tcase_add_loop_test(c, test_no_samples, 0, 2);
	suite_add_tcase(s, c);
	suite_add_tcase(s, case_refused());
	return s;
}

int main(int argc, char **argv)
{
	if (argc != 2)
		return fputs("usage: test_rnearun_task RNEARUN\n", stderr), 2;
	rnearun = argv[1];
	printf("seed %d\n", SEED);
	return run_in_folder(suite(), "rnearun_task");
}
