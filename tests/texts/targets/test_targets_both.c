/* One text for both: what is written for CUDA, compiled as C, has the bits of the text for target c; slices of a batch
   have those of the functions for one sample, however the batch is cut. */
#define _POSIX_C_SOURCE 200809L
#include "support/exhaustive.h"
#include "support/model.h"
#include "support/pairs.h"
#include "support/process.h"
#include "support/rng.h"
#include "support/suite.h"
#include "target/target.h"
#include <dlfcn.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { COUNT = 700, SEED = 91, CUTS = 2 };

typedef void slice_function(void *const *arrays, size_t count, size_t first, size_t end);

/* The kernels of a text with the rows of their arrays, in order; `inputs` of them are read. */
struct kernel {
	const char *name;
	int inputs, arrays, rows[6];
};

/* A text for target c and one for CUDA, under two names in one shared object. */
struct both {
	struct target c, cuda;
	struct target_path sources[2], library;
	void *handle;
	int f32; /* arrays of float */
};

static void generate(struct target *t, const char *robot, struct rneagen_options o, enum rneagen_target target)
{
	size_t length;
	char *urdf = target_robot(robot, &length);

	o.target = target;
	o.name = target == RNEAGEN_TARGET_C ? "from_c" : "from_cuda";
	target_generate(t, urdf, length, &o, robot);
	free(urdf);
}

static void open_both(struct both *b, const char *robot, const struct rneagen_options *o, const char *compiler)
{
	b->sources[0] = target_path("both", ".c");
	b->sources[1] = target_path("both", ".cu");
	b->library = target_path("both", ".so");
	/* pairs of floats in line take compilers long, and many bodies do; test_targets_f32x2 has pairs optimised */
	const int is_pair = o->precision == RNEAGEN_F32X2, is_quick = is_pair ||
		(!exhaustive() && (!strcmp(robot, "hyq") || !strcmp(robot, "iiwa14")));
	const char *const argv[] = {compiler, "-std=c11", WARNING_FLAGS, "-Wshadow", is_quick ? "-O0" : "-O1", "-fPIC",
		"-shared", "-o", b->library.s, b->sources[0].s, "-x", "c", b->sources[1].s, "-lm", is_quick &&
		is_pair ? "-Dalways_inline=unused" : NULL, NULL};

	generate(&b->c, robot, *o, RNEAGEN_TARGET_C);
	generate(&b->cuda, robot, *o, RNEAGEN_TARGET_CUDA);
	target_write(b->sources[0], b->c.text.source);
	target_write(b->sources[1], b->cuda.text.source);
	target_compile(&b->cuda, argv);
	b->handle = dlopen(b->library.s, RTLD_NOW | RTLD_LOCAL);
	ck_assert_msg(b->handle != NULL, "%s: %s", b->c.what, dlerror());
	b->f32 = strstr(b->c.text.source, "_rnea(const float ") != NULL;
}

static void close_both(struct both *b)
{
	dlclose(b->handle);
	unlink(b->library.s);
	unlink(b->sources[0].s);
	unlink(b->sources[1].s);
	target_close(&b->c);
	target_close(&b->cuda);
}

static void function_of(const struct both *b, const char *text, const char *kernel, const char *suffix, void *function)
{
	char symbol[128];

	snprintf(symbol, sizeof symbol, "from_%s_%s%s", text, kernel, suffix);
	target_symbol(&b->cuda, b->handle, symbol, function);
}

/* Some samples have an angle that is not small, singly and many in a row. */
static double input(struct rng *g, int array, size_t sample)
{
	double x = rng_uniform(g, -3, 3);

	return array == 0 && (sample % 300 == 17 || (sample > 600 && sample % 3 == 0)) ? 3e4 * x : x;
}

static size_t element(const struct both *b, size_t sample, int row, int rows, size_t count)
{
	return b->c.options.layout == RNEAGEN_SOA ? (size_t)row * count + sample
						  : sample * (size_t)rows + (size_t)row;
}

static void fill(const struct both *b, const struct kernel *k, struct array *arrays, size_t count)
{
	struct rng g = rng_seed(SEED);

	for (int i = 0; i < k->arrays; i++) {
		arrays[i] = array_new(b->f32, (size_t)k->rows[i] * count);
		for (size_t s = 0; s < count; s++)
			for (int r = 0; r < k->rows[i]; r++)
				array_set(&arrays[i], element(b, s, r, k->rows[i], count),
					i < k->inputs ? input(&g, i, s) : (double)NAN);
	}
}

static void release(const struct kernel *k, struct array *arrays)
{
	for (int i = 0; i < k->arrays; i++)
		array_free(&arrays[i]);
}

static void call(slice_function *f, const struct kernel *k, const struct array *arrays, size_t first, size_t end)
{
	void *data[6];

	for (int i = 0; i < k->arrays; i++)
		data[i] = arrays[i].data;
	f(data, COUNT, first, end);
}

static void compare(const struct both *b, const struct kernel *k, const struct array *x, const struct array *y,
	size_t first, size_t end, const char *what)
{
	for (int i = k->inputs; i < k->arrays; i++) {
		for (size_t s = first; s < end; s++)
			for (int r = 0; r < k->rows[i]; r++) {
				size_t at = element(b, s, r, k->rows[i], COUNT);

				ck_assert_msg(same_number(array_get(&x[i], at), array_get(&y[i], at)),
					"%s: %s: array %d, row %d, sample %zu is %a, %s %a", b->cuda.what, k->name, i,
					r, s, array_get(&y[i], at), what, array_get(&x[i], at));
			}
		ck_assert_msg(array_intact(&y[i]), "%s: %s wrote before array %d", b->cuda.what, k->name, i);
	}
}

/* A function for one sample takes pointers to float or to double, and is called through this type for either: one
   pointer is passed as the other is. */
typedef void one3(void *, void *, void *);
typedef void one4(void *, void *, void *, void *);
typedef void one6(void *, void *, void *, void *, void *, void *);

static void call_one(const struct both *b, const struct kernel *k, const struct array *a)
{
	one3 *f3;
	one4 *f4;
	one6 *f6;

	if (k->arrays == 3) {
		function_of(b, "c", k->name, "", &f3);
		f3(a[0].data, a[1].data, a[2].data);
	} else if (k->arrays == 4) {
		function_of(b, "c", k->name, "", &f4);
		f4(a[0].data, a[1].data, a[2].data, a[3].data);
	} else {
		function_of(b, "c", k->name, "", &f6);
		f6(a[0].data, a[1].data, a[2].data, a[3].data, a[4].data, a[5].data);
	}
}

/* The whole batch by the function for one sample, which test_targets holds against the reference. */
static void call_singly(const struct both *b, const struct kernel *k, struct array *arrays)
{
	struct array one[6];

	for (int i = 0; i < k->arrays; i++)
		one[i] = array_new(b->f32, (size_t)k->rows[i]);
	for (size_t s = 0; s < COUNT; s++) {
		for (int i = 0; i < k->inputs; i++)
			for (int r = 0; r < k->rows[i]; r++)
				array_set(&one[i], (size_t)r,
					array_get(&arrays[i], element(b, s, r, k->rows[i], COUNT)));
		call_one(b, k, one);
		for (int i = k->inputs; i < k->arrays; i++)
			for (int r = 0; r < k->rows[i]; r++)
				array_set(&arrays[i], element(b, s, r, k->rows[i], COUNT),
					array_get(&one[i], (size_t)r));
	}
	release(k, one);
}

static void set(const struct kernel *k, const struct array *from, struct array *to)
{
	for (int i = 0; i < k->arrays; i++)
		memcpy(to[i].data, from[i].data, from[i].count * (from[i].f32 ? sizeof(float) : sizeof(double)));
}

static void copy(const struct kernel *k, const struct array *from, struct array *to)
{
	for (int i = 0; i < k->arrays; i++)
		to[i] = array_new(from[i].f32, from[i].count);
	set(k, from, to);
}

/* One slice: what it writes, and nothing beside it. */
static void check_slice(const struct both *b, const struct kernel *k, slice_function *f, const struct array *untouched,
	const struct array *whole, struct array *part, size_t first, size_t end)
{
	set(k, untouched, part);
	call(f, k, part, first, end);
	compare(b, k, untouched, part, 0, first, "untouched");
	compare(b, k, whole, part, first, end, "in one piece");
	compare(b, k, untouched, part, end, COUNT, "untouched");
}

/* A batch cut at random, each slice by itself. */
static void check_cuts(const struct both *b, const struct kernel *k, slice_function *f, const struct array *untouched,
	const struct array *whole)
{
	struct rng g = rng_seed(SEED + 1);
	struct array part[6];
	size_t at = 0;

	copy(k, untouched, part);
	for (int i = 0; i < CUTS; i++) {
		size_t end = at + (size_t)rng_below(&g, (int)(COUNT - at));

		check_slice(b, k, f, untouched, whole, part, at, end);
		at = end;
	}
	check_slice(b, k, f, untouched, whole, part, at, at);
	check_slice(b, k, f, untouched, whole, part, at, COUNT);
	release(k, part);
}

static void check_kernel(const struct both *b, const struct kernel *k)
{
	struct array untouched[6], singly[6], c[6], cuda[6];
	slice_function *from_c, *from_cuda;

	function_of(b, "c", k->name, "_slice", &from_c);
	function_of(b, "cuda", k->name, "_slice", &from_cuda);
	fill(b, k, untouched, COUNT);
	copy(k, untouched, singly);
	copy(k, untouched, c);
	copy(k, untouched, cuda);
	call_singly(b, k, singly);
	call(from_c, k, c, 0, COUNT);
	compare(b, k, singly, c, 0, COUNT, "alone");
	call(from_cuda, k, cuda, 0, COUNT);
	compare(b, k, singly, cuda, 0, COUNT, "alone, from target c");
	check_cuts(b, k, from_c, untouched, singly);
	check_cuts(b, k, from_cuda, untouched, singly);
	release(k, untouched);
	release(k, singly);
	release(k, c);
	release(k, cuda);
}

/* NAME_rnea_batch of the text for CUDA. */
static void check_batch(const struct both *b, const struct kernel *k)
{
	typedef void batch_function(void *, void *, void *, void *, size_t);
	struct array singly[4], batch[4];
	batch_function *f;

	function_of(b, "cuda", "rnea_batch", "", &f);
	fill(b, k, singly, COUNT);
	fill(b, k, batch, COUNT);
	call_singly(b, k, singly);
	f(batch[0].data, batch[1].data, batch[2].data, batch[3].data, COUNT);
	compare(b, k, singly, batch, 0, COUNT, "alone");
	release(k, singly);
	release(k, batch);
}

static void check_text(const char *robot, const struct rneagen_options *o, const char *compiler)
{
	struct both b;
	struct model m;
	size_t length;
	char *urdf = target_robot(robot, &length);

	open_both(&b, robot, o, compiler);
	model_open(&m, urdf, length, o, robot);
	const int nq = m.tree.nq, nv = m.tree.nv, w = 6 * m.tree.body_count;
	const struct kernel kernels[] = {{"rnea", 3, 4, {nq, nv, nv, nv}}, {"fpass", 3, 6, {nq, nv, nv, w, w, w}},
		{"bpass", 2, 3, {nq, w, nv}}};

	for (int i = 0; i < 3; i++)
		check_kernel(&b, &kernels[i]);
	check_batch(&b, &kernels[0]);
	model_close(&m);
	close_both(&b);
	free(urdf);
}

static const char *const COMPILERS[] = {"gcc", "clang"};

static const char *const ROBOTS[] = {
	"iiwa14", "hyq", "mimic_chain", "planar_tilted", "floating_joint", "gantry", "all_zero_torque", "odd_names"};

enum { ROBOT_COUNT = sizeof ROBOTS / sizeof *ROBOTS };
enum { COMPILER, PRECISION, LAYOUT, TRIG, COLUMNS }; /* columns of the table */

/* Pairs of floats in line are what compilers take longest over: those of robots with few joints, unless all is asked for. */
static const char *robot_of(const int *row, int robot)
{
	return row[PRECISION] == 3 && robot < 2 && !exhaustive() ? ROBOTS[robot + 2] : ROBOTS[robot];
}

/* Each pair of compiler, precision, layout and mode, of the robots in turn. */
START_TEST(same_bits)
{
	static const enum rneagen_precision precisions[] = {RNEAGEN_F32, RNEAGEN_F64, RNEAGEN_MIXED,
		RNEAGEN_F32X2};
	struct pairs p = {.factors = COLUMNS, .levels = {2, 4, 2, 3}};
	struct rneagen_options o = rneagen_options_default();
	int texts = 0;

	if (!process_exists(COMPILERS[_i])) {
		printf("skipped: no %s\n", COMPILERS[_i]);
		return;
	}
	pairs_draw(&p, SEED);
	for (int i = 0; i < p.count; i++) {
		const int *row = p.rows[i], robot = i % ROBOT_COUNT;

		if (row[COMPILER] != _i)
			continue;
		o.precision = precisions[row[PRECISION]];
		o.layout = (enum rneagen_layout)row[LAYOUT];
		o.trig = (enum rneagen_trig)row[TRIG];
		o.base = robot == 1 ? RNEAGEN_FLOATING : RNEAGEN_FIXED;
		check_text(robot_of(row, robot), &o, COMPILERS[_i]);
		texts++;
	}
	printf("%s: %d pairs of texts, %d samples each, seed %d\n", COMPILERS[_i], texts, COUNT, SEED);
}
END_TEST

int main(void)
{
	Suite *suite = suite_create("both");

	setvbuf(stdout, NULL, _IOLBF, 0);
	suite_add(suite, "bits", same_bits, 2, 1200);
	return suite_run(suite);
}
