/* Texts for target cuda, without a GPU: nvcc and NVRTC take them without a word, and what ptxas says of their kernels
   goes into targets/ptxas.csv. The other robots of this folder by NVRTC, which has the same front end, and every
   seventh by nvcc too: every third of them, or where all is asked for every second, and every second of the real ones
   (RNEAGEN_ROBOTS). */
#define _GNU_SOURCE
#include "support/exhaustive.h"
#include "support/read.h"
#include "support/process.h"
#include "target/ptxas.h"
#include "support/suite.h"
#include "target/target.h"
#include "cuda/compile/jit.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { SM = 90 };

static const char *nvcc;

static void find_nvcc(void)
{
	nvcc = target_nvcc();
}

START_TEST(table_begins)
{
	target_write(target_path("ptxas", ".csv"),
		"robot,base,precision,layout,trig,kernel,registers,stack,spill_stores,spill_loads,shared\n");
}
END_TEST

static void write_row(const struct target *t, const char *robot, const struct kernel_use *k)
{
	static const char *const trigs[] = {"accurate", "bounded", "fast"};
	FILE *f = fopen(target_path("ptxas", ".csv").s, "a");

	ck_assert_ptr_nonnull(f);
	fprintf(f, "%s,%s,%s,%s,%s,%s,%d,%d,%d,%d,%d\n", robot,
		t->options.base == RNEAGEN_FLOATING ? "floating" : "fixed", t->f32 ? "f32" : "f64",
		t->options.layout == RNEAGEN_SOA ? "soa" : "aos", trigs[t->options.trig],
		k->name + strlen(t->text.name) + 1, k->registers, k->stack, k->spill_stores, k->spill_loads, k->shared);
	ck_assert_int_eq(fclose(f), 0);
}

/* Compile with nvcc; what it said, for the caller to free. */
static struct process run_nvcc(const struct target *t, struct target_path source, struct target_path object)
{
	const char *const argv[] = {
		nvcc, "-arch=sm_90", "-Werror", "all-warnings", "-Xptxas", "-v", "-c", "-o", object.s, source.s, NULL};
	struct process p = process_run(argv);

	ck_assert_msg(p.status == 0 && !strstr(p.output, "arning"), "%s: nvcc gives %d and says\n%.3000s", t->what,
		p.status, p.output);
	return p;
}

static int has_limbs(const struct target *t)
{
	return strstr(t->text.source, "#define RNEA_LIMBS ") != NULL;
}

enum { KERNELS = 8 };

/* Kernels of large batches. */
static int large_kernels(const struct target *t)
{
	static const char head[] = "__launch_bounds__(RNEA_PART_BLOCK)";
	int count = 0;

	for (const char *s = t->text.source; (s = strstr(s, head)) != NULL; s += strlen(head))
		count++;
	return count;
}

/* Is the name one of the text's: NAME_rnea_kernel and so on? */
static int is_kernel(const struct target *t, const char *name)
{
	static const char *const kernels[] = {"_rnea_kernel", "_fpass_kernel", "_bpass_kernel", "_rnea_limbs",
		"_rnea_part0_kernel", "_rnea_part1_kernel"};
	size_t own = strlen(t->text.name);

	for (size_t i = 0; i < sizeof kernels / sizeof *kernels; i++)
		if (!strncmp(name, t->text.name, own) && !strcmp(name + own, kernels[i]))
			return 1;
	return 0;
}

/* What ptxas says of the kernels, up to so many; returns how many there were. The files stay until they are removed. */
static int compile(const struct target *t, struct kernel_use *kernels, int limit)
{
	struct target_path source = target_path(t->text.name, ".cu"), object = target_path(t->text.name, ".o");
	struct process p;
	int n;

	target_write(source, t->text.source);
	p = run_nvcc(t, source, object);
	n = ptxas_read(p.output, kernels, limit);
	process_free(&p);
	return n;
}

static void remove_files(const struct target *t)
{
	unlink(target_path(t->text.name, ".o").s);
	unlink(target_path(t->text.name, ".cu").s);
}

static void check_nvcc(const struct target *t, const char *robot, int no_spill)
{
	struct kernel_use kernels[KERNELS];
	int n = compile(t, kernels, KERNELS);

	ck_assert_msg(n == 3 + has_limbs(t) + large_kernels(t), "%s: %d kernels", t->what, n);
	for (int i = 0; i < n; i++) {
		const struct kernel_use *k = &kernels[i];

		ck_assert_msg(is_kernel(t, k->name) && k->registers > 0, "%s: kernel '%s'", t->what, k->name);
		ck_assert_msg(!no_spill || (!k->spill_stores && !k->spill_loads),
			"%s: %s spills %d and %d bytes in %d registers", t->what, k->name, k->spill_stores,
			k->spill_loads, k->registers);
		write_row(t, robot, k);
		if (strstr(k->name, "_rnea_kernel"))
			printf("%-50s %3d registers, stack %d, spilled %d, shared %d\n", t->what, k->registers,
				k->stack, k->spill_stores, k->shared);
	}
	remove_files(t);
}

static int nvrtc_is_missing;

/* All of a text, or the kernels that a macro leaves, of which `kernel` is one. */
static void check_program(const struct target *t, const char *macro, const char *ending)
{
	char log[4096] = "", kernel[512];
	struct jit_request r = {.source = t->text.source, .file = t->what, .arch = SM, .options = &macro,
		.option_count = macro != NULL, .log = log, .log_size = sizeof log};
	struct jit_image image;
	struct rnea_error e = {0};

	if (nvrtc_is_missing)
		return;
	jit_compile(&r, &image, &e);
	nvrtc_is_missing = e.code == RNEA_NO_COMPILER;
	if (nvrtc_is_missing) {
		printf("skipped: %s\n", e.message);
		return;
	}
	ck_assert_msg(e.code == RNEA_OK, "%s: %s", t->what, e.message);
	ck_assert_msg(!*log, "%s: NVRTC says %s", t->what, log);
	snprintf(kernel, sizeof kernel, "%s_rnea_%s", t->text.name, ending);
	ck_assert_msg(memmem(image.data, image.size, kernel, strlen(kernel)) != NULL, "%s: no %s in the image", t->what,
		kernel);
	jit_free(&image);
}

static void check_nvrtc(const struct target *t)
{
	check_program(t, NULL, "kernel");
	if (has_limbs(t))
		check_program(t, "-DRNEA_ONLY_LIMBS", "limbs");
}

static void generate(struct target *t, const char *path, struct rneagen_options *o, const char *name, const char *what)
{
	size_t length;
	char *urdf = read_file(path, &length);

	ck_assert_msg(urdf != NULL, "%s cannot be read", path);
	o->target = RNEAGEN_TARGET_CUDA;
	o->name = name;
	target_generate(t, urdf, length, o, what);
	free(urdf);
}

/* A text as it is asked for, by NVRTC and by nvcc if that is asked for, where they are; in the long form, and where it may not
   spill, by one of them. */
static void check_text(const char *path, struct rneagen_options *o, const char *robot, int no_spill, int by_nvcc)
{
	struct target t;
	char name[64];

	snprintf(name, sizeof name, "cuda_%s_%d%d%d%d", robot, o->base, o->precision, o->layout, o->trig);
	generate(&t, path, o, name, robot);
	if (nvcc && (by_nvcc || nvrtc_is_missing))
		check_nvcc(&t, robot, no_spill);
	if (!by_nvcc || !nvcc || (!exhaustive() && !no_spill))
		check_nvrtc(&t);
	target_close(&t);
}

/* Has each thread of the main kernel so many at least? */
static void check_registers(const char *path, struct rneagen_options *o, int least)
{
	struct kernel_use kernel;
	struct target t;

	generate(&t, path, o, "cuda_long", path);
	ck_assert_int_eq(compile(&t, &kernel, 1), 1);
	ck_assert_msg(kernel.registers >= least, "%s: %s has %d registers and spills %d bytes", t.what, kernel.name, kernel.registers,
		kernel.spill_stores);
	remove_files(&t);
	target_close(&t);
}

static void check_own(const char *robot, enum rneagen_base base, enum rneagen_precision precision,
	enum rneagen_layout layout, enum rneagen_trig trig, int no_spill)
{
	struct rneagen_options o = rneagen_options_default();
	char path[512];

	o.base = base;
	o.precision = precision;
	o.layout = layout;
	o.trig = trig;
	snprintf(path, sizeof path, TEST_DIR "/robots/%s.urdf", robot);
	check_text(path, &o, robot, no_spill, 1);
}

/* The robots whose speed is measured: in single precision nothing of them leaves the registers. */
START_TEST(measured_robots)
{
	static const char *const robots[] = {"iiwa14", "ur5", "hyq", "atlas"};

	for (size_t i = 0; i < sizeof robots / sizeof *robots; i++)
		for (int layout = RNEAGEN_SOA; layout <= RNEAGEN_AOS; layout++) {
			if (exhaustive() || layout == (int)i % 2)
				check_own(robots[i], RNEAGEN_FIXED, RNEAGEN_F32, (enum rneagen_layout)layout,
					RNEAGEN_ACCURATE, 1);
			if (exhaustive() ? layout != (int)i % 2 : i == 0 && layout)
				check_own(robots[i], RNEAGEN_FIXED, RNEAGEN_F64, (enum rneagen_layout)layout,
					RNEAGEN_ACCURATE, 0);
		}
}
END_TEST

/* The other modes, a floating base, another humanoid. */
START_TEST(modes)
{
	for (int trig = RNEAGEN_BOUNDED; trig <= RNEAGEN_FAST; trig++)
		for (int precision = RNEAGEN_F32; precision <= RNEAGEN_F64; precision++)
			if (exhaustive() || (precision == RNEAGEN_F32) == (trig == RNEAGEN_FAST))
				check_own("iiwa14", RNEAGEN_FIXED, (enum rneagen_precision)precision, RNEAGEN_SOA,
					(enum rneagen_trig)trig, 1);
	check_own("hyq", RNEAGEN_FLOATING, RNEAGEN_F32, RNEAGEN_SOA, RNEAGEN_BOUNDED, 1);
	if (!exhaustive())
		return;
	check_own("atlas", RNEAGEN_FLOATING, RNEAGEN_F32, RNEAGEN_AOS, RNEAGEN_FAST, 0);
	check_own("g1_29dof", RNEAGEN_FIXED, RNEAGEN_F32, RNEAGEN_SOA, RNEAGEN_ACCURATE, 0);
}
END_TEST

/* A warp whose sines are made first calls none of the functions that make them, and the program of small batches alone has them
   not. */
START_TEST(first_sines)
{
	struct rneagen_options o = rneagen_options_default();
	struct target t;

	o.precision = RNEAGEN_F32;
	generate(&t, TEST_DIR "/robots/chain_75.urdf", &o, "cuda_first", "chain_75");
	ck_assert_ptr_nonnull(strstr(t.text.source, "cuda_first_rnea_table("));
	check_program(&t, "-DRNEA_ONLY_LIMBS", "limbs");
	target_close(&t);
}
END_TEST

struct tour {
	int step, robots, turn;
};

static int is_elsewhere(const char *robot)
{
	static const char *const names[] = {"iiwa14", "ur5", "hyq", "atlas", "g1_29dof", "chain_75"};

	for (size_t i = 0; i < sizeof names / sizeof *names; i++)
		if (!strcmp(robot, names[i]))
			return 1;
	return 0;
}

/* One text of a robot, options taking turns. */
static void check_robot(const char *path, const char *name, void *context)
{
	struct tour *tour = context;
	struct rneagen_options o = rneagen_options_default();
	char robot[48];

	snprintf(robot, sizeof robot, "%.*s", (int)(strlen(name) - 5), name);
	if (!strncmp(name, "xfail_", 6) || is_elsewhere(robot) || tour->robots++ % tour->step)
		return;
	o.precision = tour->turn % 2 ? RNEAGEN_F64 : RNEAGEN_F32;
	o.layout = tour->turn / 2 % 2 ? RNEAGEN_AOS : RNEAGEN_SOA;
	o.trig = (enum rneagen_trig)(tour->turn % 3);
	o.base = tour->turn % 5 == 4 ? RNEAGEN_FLOATING : RNEAGEN_FIXED;
	check_text(path, &o, robot, 0, tour->turn % 7 == 0);
	tour->turn++;
}

START_TEST(other_robots)
{
	const char *folder = getenv("RNEAGEN_ROBOTS");
	struct tour tour = {.step = exhaustive() ? 2 : 3};

	for_each_urdf(TEST_DIR "/robots", check_robot, &tour);
	tour.step = 4;
	if (exhaustive() && folder)
		for_each_urdf(folder, check_robot, &tour);
	else if (exhaustive())
		printf("skipped: RNEAGEN_ROBOTS is not set\n");
	printf("%d texts of other robots\n", tour.turn);
}
END_TEST

static const char KERNEL[] =
	"#include \"cuda_arm.h\"\n"
	"#include \"cuda_dog.h\"\n\n"
	"extern \"C\" __global__ void both_kernel(const float *x, float *y, const double *u, double *v)\n{\n"
	"\tfloat tau[cuda_arm_nv];\n\n"
	"\tcuda_arm_rnea(x, x + cuda_arm_nq, x + 2*cuda_arm_nq, tau);\n"
	"\tfor (int i = 0; i < cuda_arm_nv; i++)\n\t\ty[threadIdx.x*cuda_arm_nv + i] = tau[i];\n"
	"\tcuda_dog_fpass(u, u, u, v, v + 6*cuda_dog_nb, v + 12*cuda_dog_nb);\n"
	"\tcuda_dog_bpass(u, v + 12*cuda_dog_nb, v);\n}\n\n"
	"void on_host(const float *x, float *tau);\n"
	"void on_host(const float *x, float *tau)\n{\n\tcuda_arm_rnea(x, x, x, tau);\n}\n";

static void write_header(
	const char *robot, const char *name, enum rneagen_precision precision, enum rneagen_trig trig, struct target *t)
{
	struct rneagen_options o = rneagen_options_default();
	size_t length;
	char *urdf = target_robot(robot, &length);

	o.target = RNEAGEN_TARGET_HEADER;
	o.precision = precision;
	o.trig = trig;
	o.name = name;
	target_generate(t, urdf, length, &o, robot);
	target_write(target_path(name, ".h"), t->text.source);
	free(urdf);
}

/* Two header texts in a kernel of the user's. */
START_TEST(header_in_kernel)
{
	struct target_path source = target_path("cuda_user", ".cu"), object = target_path("cuda_user", ".o");
	struct target arm, dog;
	struct process p;

	if (!nvcc)
		return;
	for (int trig = RNEAGEN_ACCURATE; trig <= (exhaustive() ? RNEAGEN_FAST : RNEAGEN_ACCURATE); trig += RNEAGEN_FAST) {
		write_header("iiwa14", "cuda_arm", RNEAGEN_F32, (enum rneagen_trig)trig, &arm);
		write_header("hyq", "cuda_dog", RNEAGEN_F64, RNEAGEN_ACCURATE, &dog);
		target_write(source, KERNEL);
		p = run_nvcc(&arm, source, object);
		process_free(&p);
		target_close(&arm);
		target_close(&dog);
	}
}
END_TEST

static const char PROGRAM[] =
	"#include \"linked.h\"\n"
	"extern int linked_rnea_launch(const float *q, const float *qd, const float *qdd, float *tau, size_t count, void "
	"*stream);\n"
	"int main(void)\n{\n"
	"\tdouble q[linked_nq] = {0}, tau[linked_nv];\n\n"
	"\tlinked_rnea(q, q, q, tau);\n"
	"\treturn linked_info[0] != 'r' || !(tau[0] == tau[0]) || linked_rnea_launch(0, 0, 0, 0, 0, 0);\n}\n";

/* One robot under one name, for CUDA and for C, in one program: both texts have a table of that name. */
START_TEST(linked_together)
{
	struct target_path source = target_path("linked", ".cu"), object = target_path("linked_cu", ".o"),
			   c = target_path("linked", ".c"), program = target_path("linked_main", ".c"),
			   executable = target_path("linked", ".exe");
	const char *const link[] = {nvcc, "-arch=sm_90", "-o", executable.s, program.s, c.s,
		object.s, "-lm", NULL}, *const run[] = {executable.s, NULL};
	struct rneagen_options o = rneagen_options_default();
	struct target t;
	struct process p;
	size_t length;
	char *urdf = target_robot("iiwa14", &length);

	if (!nvcc)
		return;
	o.name = "linked";
	o.target = RNEAGEN_TARGET_C;
	target_generate(&t, urdf, length, &o, "linked");
	target_write(c, t.text.source);
	target_write(target_path("linked", ".h"), t.text.header);
	target_close(&t);
	o.target = RNEAGEN_TARGET_CUDA;
	target_generate(&t, urdf, length, &o, "linked");
	target_write(source, t.text.source);
	p = run_nvcc(&t, source, object);
	process_free(&p);
	target_write(program, PROGRAM);
	target_compile(&t, link);
	target_compile(&t, run);
	target_close(&t);
	free(urdf);
}
END_TEST

/* Of a long text of a floating robot. The compiler may choose to spill nearly all: it once gave each thread of two of these 32
   registers. */
static void check_floating(const char *path, const char *scene, enum rneagen_precision precision, enum rneagen_layout layout)
{
	struct rneagen_options o = rneagen_options_default();

	o.base = RNEAGEN_FLOATING;
	o.precision = precision;
	o.layout = layout;
	o.limbs = RNEAGEN_LIMBS_NONE;
	o.scene = scene;
	check_registers(path, &o, 200);
}

/* In aos no part of a text that has the base first has all rows of an array. It would catch a function that none calls, and of
   which nvcc warns. */
START_TEST(long_texts)
{
	const char *folder = getenv("RNEAGEN_ROBOTS");
	char path[512];

	if (!exhaustive() || !nvcc)
		return;
	check_floating(TEST_DIR "/robots/hyq.urdf", "vjp qdd\njvp vjp\n", RNEAGEN_F32, RNEAGEN_SOA);
	check_floating(TEST_DIR "/robots/atlas.urdf", "want qdd\n", RNEAGEN_F64, RNEAGEN_AOS);
	if (!folder) {
		printf("skipped: accelerations of a long text: RNEAGEN_ROBOTS is not set\n");
		return;
	}
	snprintf(path, sizeof path, "%s/jvrc1.urdf", folder);
	check_floating(path, "want qdd\n", RNEAGEN_F64, RNEAGEN_SOA);
}
END_TEST

static void add_case(Suite *suite, const char *name, const TTest *test, void (*setup)(void))
{
	TCase *c = tcase_create(name);

	tcase_set_timeout(c, 7200);
	if (setup)
		tcase_add_unchecked_fixture(c, setup, NULL);
	tcase_add_test(c, test);
	suite_add_tcase(suite, c);
}

int main(void)
{
	Suite *suite = suite_create("cuda");

	setvbuf(stdout, NULL, _IOLBF, 0);
	unsetenv("RNEA_NVRTC");
	add_case(suite, "table", table_begins, NULL);
	add_case(suite, "measured", measured_robots, find_nvcc);
	add_case(suite, "modes", modes, find_nvcc);
	add_case(suite, "first", first_sines, NULL);
	add_case(suite, "others", other_robots, find_nvcc);
	add_case(suite, "header", header_in_kernel, find_nvcc);
	add_case(suite, "linked", linked_together, find_nvcc);
	add_case(suite, "long", long_texts, find_nvcc);
	return suite_run(suite);
}
