/* Texts that tell where things are, compiled and called: each precision, both layouts, against the independent
   reference; the same for CUDA by nvcc, and as a header by the C++ compiler, without a warning. Would catch an argument
   or a row out of place, and a statement that a compiler does not take. */
#define _POSIX_C_SOURCE 200809L
#include "kinematics/kin_case.h"
#include "support/process.h"
#include "support/read.h"
#include "support/suite.h"
#include <dlfcn.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { SEED = 31, COUNT = 5, PATH = 512 };

static const struct subject {
	const char *robot, *scene;
	enum rneagen_base base;
	enum rneagen_precision precision;
	enum rneagen_layout layout;
	double noise; /* of the magnitudes and the largest element */
} SUBJECTS[] = {
	{"iiwa14", "want pose.iiwa_link_ee,jacobian.iiwa_link_ee\n", RNEAGEN_FIXED, RNEAGEN_F32, RNEAGEN_SOA, 0x1p-20},
	{"hyq", "want pose.lf_foot,jacobian.rh_foot,djacobian.rh_foot,com,vcom,momentum\npose quaternion\nframe world-aligned\n",
		RNEAGEN_FLOATING, RNEAGEN_F64, RNEAGEN_AOS, 0x1p-49},
	{"panda",
		"add-frame tip=panda_hand,0.1,0,0.2,0,1,0\nwant pose.tip,jacobian.tip,djacobian.panda_hand_tcp,com_jacobian\n"
		"frame world\n",
		RNEAGEN_FIXED, RNEAGEN_MIXED, RNEAGEN_SOA, 0x1p-21},
	{"atlas", "want momentum_matrix,dmomentum,com_jacobian\n", RNEAGEN_FLOATING, RNEAGEN_F32, RNEAGEN_AOS, 0x1p-19},
	{"ur5", "want jacobian.tool0,djacobian.tool0,momentum_matrix,dmomentum\n", RNEAGEN_FIXED, RNEAGEN_F32X2,
		RNEAGEN_SOA, 0x1p-40},
	{"iiwa14", "want coriolis,opspace_inv.iiwa_link_ee,opspace.iiwa_link_ee\nframe world-aligned\n", RNEAGEN_FIXED,
		RNEAGEN_F64, RNEAGEN_SOA, 0x1p-49},
	{"planar_tilted", "want jacobian.arm,pose.arm,momentum_matrix\ndense\n", RNEAGEN_FIXED, RNEAGEN_F64,
		RNEAGEN_SOA, 0x1p-49},
};
enum { SUBJECT_COUNT = sizeof SUBJECTS / sizeof *SUBJECTS };

static void write_file(const char *path, const char *text)
{
	FILE *f = fopen(path, "wb");

	ck_assert_msg(f != NULL && fputs(text, f) >= 0 && !fclose(f), "%s cannot be written", path);
}

static void run(const char *const *argv, const char *what)
{
	struct process p = process_run(argv);

	ck_assert_msg(p.status == 0 && !*p.output, "%s: %s gives %d and says\n%.2000s", what, argv[0], p.status, p.output);
	process_free(&p);
}

static struct rneagen_options options_of(const struct subject *s)
{
	struct rneagen_options o = rneagen_options_default();

	o.scene = s->scene;
	o.base = s->base;
	o.precision = s->precision;
	o.layout = s->layout;
	o.name = "it";
	return o;
}

/* ---- target C ---- */

/* An array of all samples, of float or double; nan at first, so that an element which no text writes is seen. */
struct array {
	int is_f32, is_aos, rows;
	void *data;
};

static struct array array_new(const struct subject *s, int rows)
{
	const int is_f32 = s->precision == RNEAGEN_F32 || s->precision == RNEAGEN_MIXED;
	const size_t bytes = ((size_t)rows * COUNT + 1) * (is_f32 ? sizeof(float) : sizeof(double));
	void *data = malloc(bytes);

	ck_assert_ptr_nonnull(data);
	return (struct array){is_f32, s->layout == RNEAGEN_AOS, rows, memset(data, 0xff, bytes)};
}

static size_t place(const struct array *a, int row, int sample)
{
	return a->is_aos ? (size_t)(sample * a->rows + row) : (size_t)(row * COUNT + sample);
}

static void put(const struct array *a, int sample, const wide *x)
{
	for (int i = 0; i < a->rows && a->is_f32; i++)
		((float *)a->data)[place(a, i, sample)] = (float)x[i];
	for (int i = 0; i < a->rows && !a->is_f32; i++)
		((double *)a->data)[place(a, i, sample)] = (double)x[i];
}

static void get(const struct array *a, int sample, wide *x)
{
	for (int i = 0; i < a->rows; i++)
		x[i] = a->is_f32 ? (wide)((float *)a->data)[place(a, i, sample)] : (wide)((double *)a->data)[place(a, i, sample)];
}

typedef void slice(void *const *arrays, size_t count, size_t first, size_t end);

static slice *slice_of(void *library, const char *what)
{
	static const char *const names[] = {"it_kin_slice", "it_rnea_slice", "it_fd_slice", "it_slice"};
	void *address = NULL;
	slice *f;

	for (int i = 0; i < 4 && !address; i++)
		address = dlsym(library, names[i]);
	ck_assert_msg(address != NULL, "%s: no function takes slices", what);
	memcpy(&f, &address, sizeof f);
	return f;
}

struct states {
	wide q[KIN_ROWS], qd[KIN_ROWS], qdd[KIN_ROWS];
};

static void call(struct kin_case *c, const struct subject *s, slice *f)
{
	static const char *const names[] = {"q", "qd", "qdd", "tau"};
	const struct dag *d = &c->analysis.dag;
	struct array arrays[DAG_ARGUMENTS];
	void *pointers[DAG_ARGUMENTS];
	struct states *all = calloc(COUNT, sizeof *all);

	for (int a = 0; a < d->argument_count; a++) {
		arrays[a] = array_new(s, d->arguments[a].rows);
		pointers[a] = arrays[a].data;
	}
	for (int k = 0; k < COUNT; k++) {
		kin_draw(c);
		kin_round(c, arrays[0].is_f32);
		memcpy(all[k].q, c->q, sizeof c->q);
		memcpy(all[k].qd, c->qd, sizeof c->qd);
		memcpy(all[k].qdd, c->qdd, sizeof c->qdd);
		for (int a = 0; a < d->argument_count; a++)
			for (int i = 0; i < 4 && !d->arguments[a].is_output; i++)
				if (!strcmp(names[i], d->arguments[a].name))
					put(&arrays[a], k, c->in[i]);
	}
	f(pointers, COUNT, 0, COUNT);
	for (int k = 0; k < COUNT; k++) {
		memcpy(c->q, all[k].q, sizeof c->q);
		memcpy(c->qd, all[k].qd, sizeof c->qd);
		memcpy(c->qdd, all[k].qdd, sizeof c->qdd);
		kin_settle(c);
		kin_evaluate(c);
		for (int a = 0; a < d->argument_count; a++)
			if (d->arguments[a].is_output)
				get(&arrays[a], k, c->out[a]);
		ck_assert_int_eq(kin_compare(c, s->noise), c->analysis.request.want_count);
	}
	for (int a = 0; a < d->argument_count; a++)
		free(arrays[a].data);
	free(all);
}

START_TEST(compiled)
{
	const struct subject *s = &SUBJECTS[_i];
	struct kin_case *c = calloc(1, sizeof *c);
	struct rneagen_options o = options_of(s);
	struct rneagen_result text;
	struct rneagen_error e;
	char *urdf = robot_text(s->robot), folder[] = "/tmp/kin_texts_XXXXXX", source[64], header[64], library[64];
	void *handle;

	o.target = RNEAGEN_TARGET_C;
	snprintf(c->what, sizeof c->what, "%s, row %d, seed %d", s->robot, _i, SEED);
	c->added[c->added_count++] = (struct kin_added){"tip", "panda_hand", {0.1, 0, 0.2, 0, 1, 0}};
	ck_assert_msg(!rneagen_generate(urdf, strlen(urdf), &o, &text, &e), "%s: %s", c->what, e.message);
	ck_assert(mkdtemp(folder) != NULL);
	snprintf(source, sizeof source, "%s/it.c", folder);
	snprintf(header, sizeof header, "%s/it.h", folder);
	snprintf(library, sizeof library, "%s/it.so", folder);
	write_file(source, text.source);
	write_file(header, text.header);
	run((const char *const[]){"cc", "-std=c11", "-O0", "-Wall", "-Wextra", "-Wconversion", "-Wdouble-promotion", "-Werror",
		"-Dalways_inline=unused", "-ffp-contract=off", "-shared", "-fPIC", "-o", library, source, "-lm", NULL}, c->what);
	handle = dlopen(library, RTLD_NOW | RTLD_LOCAL);
	ck_assert_msg(handle != NULL, "%s: %s", c->what, dlerror());
	ck_assert(kin_open(c, urdf, NULL, &o, SEED));
	call(c, s, slice_of(handle, c->what));
	printf("%s: off by %.2g of the tolerance\n", c->what, c->worst);
	kin_close(c);
	dlclose(handle);
	unlink(source);
	unlink(header);
	unlink(library);
	rmdir(folder);
	rneagen_result_free(&text);
	free(urdf);
	free(c);
}
END_TEST

/* ---- CUDA, and a header ---- */

static void check_other(const struct subject *s, enum rneagen_target target, const char *suffix, const char *const *command)
{
	struct rneagen_options o = options_of(s);
	struct rneagen_result text;
	struct rneagen_error e;
	char *urdf = robot_text(s->robot), folder[] = "/tmp/kin_texts_XXXXXX", source[64], object[64], what[128];
	const char *argv[24];
	int n = 0;

	o.target = target;
	snprintf(what, sizeof what, "%s, target %s", s->robot, suffix);
	ck_assert_msg(!rneagen_generate(urdf, strlen(urdf), &o, &text, &e), "%s: %s", what, e.message);
	ck_assert(mkdtemp(folder) != NULL);
	snprintf(source, sizeof source, "%s/it.%s", folder, suffix);
	snprintf(object, sizeof object, "%s/it.o", folder);
	write_file(source, text.source);
	while (command[n]) {
		argv[n] = command[n];
		n++;
	}
	argv[n++] = "-o";
	argv[n++] = object;
	argv[n++] = source;
	argv[n] = NULL;
	run(argv, what);
	unlink(source);
	unlink(object);
	rmdir(folder);
	rneagen_result_free(&text);
	free(urdf);
}

START_TEST(cuda)
{
	if (process_exists("nvcc"))
		check_other(&SUBJECTS[_i], RNEAGEN_TARGET_CUDA, "cu",
			(const char *const[]){"nvcc", "-arch=sm_90", "-cubin", "-Werror", "all-warnings", NULL});
	else
		printf("skipped: CUDA: there is no nvcc\n");
}
END_TEST

START_TEST(header)
{
	check_other(&SUBJECTS[_i], RNEAGEN_TARGET_HEADER, "hpp",
		(const char *const[]){"c++", "-std=c++17", "-O1", "-Wall", "-Wextra",
		"-Wconversion", "-Werror", "-Wno-pragma-once-outside-header", "-x", "c++", "-c", NULL});
}
END_TEST

int main(void)
{
	Suite *suite = suite_create("kinematic texts");

	setvbuf(stdout, NULL, _IOLBF, 0);
	suite_add(suite, "compiled", compiled, SUBJECT_COUNT, 300);
	suite_add(suite, "cuda", cuda, 3, 300);
	suite_add(suite, "header", header, 3, 300);
	return suite_run(suite);
}
