/* test_rnearun RNEARUN RNEA_REFERENCE: the command as its users run it, against the independent reference; what ends it
   early is in test_rnearun_limits.c. Both backends: this machine's processor, and the pretended GPU. */
#define _DEFAULT_SOURCE
#include "test_rnearun.h"
#include "support/process.h"
#include "states_file.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static const char *reference;

/* q.npy qd.npy qdd.npy tau.npy by the reference, states.npy of the first three, and the same in float32. */
static void make_states(const char *urdf, const char *count, const char *base, int f32)
{
	const char *const argv[] = {
		reference, urdf, count, "20261121", "--base", base, "--out", ".", f32 ? "--f32" : NULL, NULL};
	static const char *const names[] = {"q.npy", "qd.npy", "qdd.npy"};
	struct process p = process_run(argv);
	size_t n[3], samples = (size_t)atoi(count);
	double *parts[3], *states;

	ck_assert_msg(p.status == 0, "%s", p.output);
	process_free(&p);
	for (int i = 0; i < 3; i++) {
		parts[i] = file_numbers(names[i], 0, &n[i]);
		if (f32)
			file_put_array(names[i], parts[i], samples, n[i] / samples, 1);
	}
	states = states_join((const double *const *)parts, samples, n[0] / samples, n[1] / samples);
	file_put_array("states.npy", states, samples, (n[0] + 2 * n[1]) / samples, f32);
	for (int i = 0; i < 3; i++)
		free(parts[i]);
	free(states);
}

/* out.npy holds what tau.npy does, within `most`, relative in the norm of each sample. */
static void assert_torques(int f32, size_t samples, double most)
{
	size_t n, m, nv;
	double *tau = file_numbers("tau.npy", 0, &n), *out = file_numbers("out.npy", f32, &m);

	ck_assert_uint_eq(n, m);
	nv = n / samples;
	for (size_t k = 0; k < samples; k++) {
		double error = 0, norm = 0;

		for (size_t i = k * nv; i < (k + 1) * nv; i++) {
			error += (out[i] - tau[i]) * (out[i] - tau[i]);
			norm += tau[i] * tau[i];
		}
		ck_assert_msg(sqrt(error) <= most * sqrt(norm), "sample %zu: %g", k, sqrt(error / norm));
	}
	free(tau);
	free(out);
	ck_assert_int_eq(count_files("out.npy"), 1);
	ck_assert_int_eq(unlink("out.npy"), 0);
}

static const char *const BACKENDS[] = {"cuda", "cpu"};

/* Three robots, either precision, one file and three, slices that do not divide the batch, on each backend. */
START_TEST(test_torques)
{
	static const struct {
		const char *urdf, *base;
	} robots[] = {{IIWA, "fixed"}, {ROBOTS "hyq.urdf", "floating"}, {ROBOTS "panda.urdf", "fixed"}};
	const char *urdf = robots[_i / 4].urdf, *base = robots[_i / 4].base, *backend = BACKENDS[_i / 2 % 2];
	int f32 = _i % 2;
	double most = f32 ? 1e-5 : 1e-13;

	make_states(urdf, "1000", base, f32);
	RUN(0, "", urdf, "--in", "states.npy", "--out", "out.npy", "--base", base, "--backend", backend);
	assert_torques(f32, 1000, most);
	RUN(0, "", urdf, "--q", "q.npy", "--qd", "qd.npy", "--qdd", "qdd.npy", "-o", "out.npy", "--slice", "37",
		"--base", base, "--backend", backend, "--threads", "2");
	assert_torques(f32, 1000, most);
}
END_TEST

/* The widest input decides unless an option does. */
START_TEST(test_precision)
{
	size_t n;
	double *q;

	make_states(IIWA, "50", "fixed", 1);
	q = file_numbers("q.npy", 1, &n);
	file_put_array("q8.npy", q, 50, 7, 0);
	free(q);
	RUN(0, "", IIWA, "--q", "q8.npy", "--qd", "qd.npy", "--qdd", "qdd.npy", "--out", "out.npy");
	assert_torques(0, 50, 1e-13);
	RUN(0, "", IIWA, "--q", "q8.npy", "--qd", "qd.npy", "--qdd", "qdd.npy", "--out", "out.npy", "--precision",
		"f32");
	assert_torques(1, 50, 1e-5);
	RUN(0, "", IIWA, "--in", "states.npy", "--out", "out.npy", "--precision", "f64");
	assert_torques(0, 50, 1e-13);
	RUN(0, "", IIWA, "--in", "states.npy", "--out", "out.npy", "--precision", "mixed");
	assert_torques(1, 50, 1.2e-7);
}
END_TEST

START_TEST(test_pipes)
{
	make_states(IIWA, "300", "fixed", 0);
	run_shell(0, "", "cat states.npy | \"$1\" eval \"$2\" --in - --out - --slice 7 >out.npy", IIWA);
	assert_torques(0, 300, 1e-13);
	run_shell(0, "", "\"$1\" eval - --in states.npy --out out.npy <\"$2\"", IIWA);
	assert_torques(0, 300, 1e-13);
	run_shell(1, "<stdin>: ends within the array",
		"head -c 10000 states.npy | \"$1\" eval \"$2\" --in - --out out.npy", IIWA);
	run_shell(1, "<stdin>: bytes after the array",
		"cat states.npy states.npy | \"$1\" eval \"$2\" --in - --out out.npy", IIWA);
	run_shell(
		1, "standard output: cannot be written", "\"$1\" eval \"$2\" --in states.npy --out - >/dev/full", IIWA);
	/* so little that it is written at the very end */
	file_put_sparse("one.npy", 1, 21);
	run_shell(1, "standard output: cannot be written", "\"$1\" eval \"$2\" --in one.npy --out - >/dev/full", IIWA);
	ck_assert_int_eq(count_files("out.npy"), 0);
}
END_TEST

/* No sample, one sample, and axes before the last. */
START_TEST(test_shapes)
{
	double zero[42] = {0}, *x;
	char header[128];
	size_t n;
	FILE *f;

	file_put_array("none.npy", zero, 0, 21, 0);
	RUN(0, "", IIWA, "--in", "none.npy", "--out", "out.npy");
	x = file_numbers("out.npy", 0, &n);
	ck_assert_uint_eq(n, 0);
	free(x);
	file_put_array("two.npy", zero, 2, 21, 0);
	f = fopen("two.npy", "r+b");
	fseek(f, 10, SEEK_SET);
	fprintf(f, "{'descr': '<f8', 'fortran_order': False, 'shape': (2, 1, 21)}    ");
	fclose(f);
	RUN(0, "", IIWA, "--in", "two.npy", "--out", "out.npy");
	f = fopen("out.npy", "rb");
	ck_assert_uint_eq(fread(header, 1, sizeof header, f), sizeof header);
	fclose(f);
	header[127] = '\0';
	ck_assert_ptr_nonnull(strstr(header + 10, "'shape': (2, 1, 7)"));
	unlink("out.npy");
}
END_TEST

START_TEST(test_refused)
{
	make_states(IIWA, "50", "fixed", 0);
	RUN(1, "states.npy: 21 columns, hyq needs nq + 2 nv = 12 + 24 = 36", ROBOTS "hyq.urdf", "--in", "states.npy",
		"--out", "out.npy");
	RUN(1, "q.npy: 7 columns, hyq needs nq = 12 for q", ROBOTS "hyq.urdf", "--q", "q.npy", "--qd", "qd.npy",
		"--qdd", "qdd.npy", "--out", "out.npy");
	file_put_sparse("long.npy", 51, 7);
	RUN(1, "long.npy: shape (51, 7), other samples than q.npy, shape (50, 7)", IIWA, "--q", "q.npy", "--qd",
		"long.npy", "--qdd", "qdd.npy", "--out", "out.npy");
	RUN(1, "no/such.urdf: cannot be opened", "no/such.urdf", "--in", "states.npy", "--out", "out.npy");
	RUN(1, "no/such.npy: cannot be opened", IIWA, "--in", "no/such.npy", "--out", "out.npy");
	RUN(1, "no/out.npy: cannot be written", IIWA, "--in", "states.npy", "--out", "no/out.npy");
	RUN(1, "/dev/full: cannot be written", IIWA, "--in", "states.npy", "--out", "/dev/full");
	RUN(1, "not a .npy file", IIWA, "--in", IIWA, "--out", "out.npy");
	RUN(2, "is the input states.npy", IIWA, "--in", "states.npy", "--out", "./states.npy");
	RUN(2, "is the input q.npy", IIWA, "--q", "q.npy", "--qd", "qd.npy", "--qdd", "qdd.npy", "--out", "q.npy");
	RUN(2, "--order names 'nothing'", IIWA, "--in", "states.npy", "--out", "out.npy", "--order", "nothing");
	RUN(2, "no URDF named", "--in", "states.npy", "--out", "out.npy");
	RUN(2, "one URDF at a time", IIWA, IIWA, "--in", "states.npy", "--out", "out.npy");
	RUN(2, "no input named", IIWA, "--out", "out.npy");
	RUN(2, "no output named", IIWA, "--in", "states.npy");
	RUN(2, "--qdd is missing", IIWA, "--q", "q.npy", "--qd", "qd.npy", "--out", "out.npy");
	RUN(2, "leave out --q", IIWA, "--in", "states.npy", "--q", "q.npy", "--out", "out.npy");
	RUN(2, "can be read once", "-", "--in", "-", "--out", "out.npy");
	RUN(2, "--slice takes a whole number", IIWA, "--slice", "0");
	RUN(2, "--slice takes a whole number", IIWA, "--slice", "1e3");
	RUN(2, "--device takes a whole number", IIWA, "--device", "-1");
	RUN(2, "--threads takes a whole number", IIWA, "--threads", "99999999999999999999999");
	RUN(2, "--backend takes cpu|cuda|any, not 'gpu'", IIWA, "--backend", "gpu");
	RUN(2, "--trig takes accurate|bounded|fast, not 'slow'", IIWA, "--trig", "slow");
	RUN(2, "option '--layout' is not known", IIWA, "--layout", "soa");
	RUN(2, "option '--in' needs a value", IIWA, "--in");
	RUN(0, "usage: rnearun eval", "--help");
	ck_assert_int_eq(count_files("out.npy"), 0);
}
END_TEST

/* The line of progress is for terminals, and for who wants it. */
START_TEST(test_progress)
{
	make_states(IIWA, "50", "fixed", 0);
	run_shell(0, "of 50 samples",
		"script -qec \"'$1' eval '$2' --in states.npy --out out.npy --slice 20\" /dev/null", IIWA);
	run_shell(0, "", "! script -qec \"'$1' eval '$2' --in states.npy --out out.npy --quiet\" /dev/null | grep .",
		IIWA);
	RUN(0, "", IIWA, "--in", "states.npy", "--out", "out.npy");
	unlink("out.npy");
}
END_TEST

static TCase *add_case(Suite *s, const char *name)
{
	TCase *c = tcase_create(name);

	tcase_set_timeout(c, 120);
	suite_add_tcase(s, c);
	return c;
}

static Suite *suite(void)
{
	Suite *s = suite_create("rnearun");
	TCase *c = add_case(s, "torques");

	tcase_add_loop_test(c, test_torques, 0, 12);
	tcase_add_test(c, test_precision);
	c = add_case(s, "files");
	tcase_add_test(c, test_pipes);
	tcase_add_test(c, test_shapes);
	tcase_add_test(c, test_refused);
	suite_add_tcase(s, case_limits());
	c = add_case(s, "terminal");
	if (system("command -v script >/dev/null") == 0)
		tcase_add_test(c, test_progress);
	else
		puts("skipped: the line of progress, for there is no script(1) to make a terminal");
	return s;
}

int main(int argc, char **argv)
{
	if (argc != 3)
		return fputs("usage: test_rnearun RNEARUN RNEA_REFERENCE\n", stderr), 2;
	rnearun = argv[1];
	reference = argv[2];
	return run_in_folder(suite(), "rnearun");
}
