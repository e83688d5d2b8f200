/* Texts of forward dynamics by drawn pairs of options: no compiler has a word to say of them, and run by librnea, on
   the host and on the pretended device, they give what the evaluated DAG gives; by --strict several compilers give the
   same bits. Robots take turns; where all is asked for, they are one more option. */
#define _POSIX_C_SOURCE 200809L
#include "rnea.h"
#include "support/exhaustive.h"
#include "support/pairs.h"
#include "support/rng.h"
#include "support/scene_model.h"
#include "support/suite.h"
#include "target/target.h"
#include <dlfcn.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* More than one block, and a last one that is not full; so many states, in turn. */
enum { COUNT = 150, STATES = 7, SEED = 77, LARGEST = 35 * 35 };
enum { WAY, TARGET, PRECISION, LAYOUT, MODE, ROBOT, FACTORS };

static const struct subject {
	const char *name, *scene;
	int floating;
} SUBJECTS[] = {
	{"double_pendulum", "free mass.lower\narmature elbow=0.01\nwant qdd,dqdd_dq,dqdd_dmass.lower\n", 0},
	{"mimic_chain", "free offset.wrist\ndamping\nfriction 0.3\nwant qdd,Minv,dqdd_dqd,M\njvp qdd\n", 0},
	{"planar_tilted", "free gravity\nfext disc\nfold tau.mast=0.5\nwant Minv,dqdd_dq,dqdd_dgravity,dtau_dq\n", 0},
	{"floating_joint", "fext left_arm\nfext-frame world\nwant qdd,accel.left_arm,power\nvjp qdd\n", 0},
	{"mimic_chain",
		"free gravity,payload.hand\nfext arm\nwant kinetic\njvp pose.hand,qdd\nvjp accel.hand,kinetic,M\nby "
		"payload.hand,gravity,fext.arm\n",
		0},
	{"floating_joint", "want qdd,com\njvp com,potential\nvjp qdd,pose.left_arm\n", 0},
	{"root_with_mass", "free mass.leg:sample\nwant qdd,dqdd_dqd,dqdd_dmass.leg\njvp qdd\nvjp qdd\n", 1},
	{"root_with_mass", "free mass.leg:sample\nvjp qdd,com\njvp vjp,kinetic\nby mass.leg\n", 1}, /* second derivatives */
	{"floating_joint", "contact left_arm\nwant qdd,contact.left_arm,dqdd_dq\nvjp qdd,contact.left_arm\n", 0},
	{"hyq", "weld trunk\nframe world-aligned\nfree accel.trunk\nwant weld.trunk,qdd,dqdd_daccel.trunk\njvp weld.trunk\n", 1},
};
static const char *const WAYS[] = {"dynamics factor\n", "dynamics articulated\n", "dense\nrefine 1\n"};
static const enum rneagen_target TARGETS[] = {RNEAGEN_TARGET_C, RNEAGEN_TARGET_CUDA, RNEAGEN_TARGET_HEADER};
static const enum rneagen_precision PRECISIONS[] = {RNEAGEN_F64, RNEAGEN_F32, RNEAGEN_MIXED, RNEAGEN_F32X2};
static const struct {
	enum rneagen_trig trig;
	int strict;
} MODES[] = {{RNEAGEN_ACCURATE, 0}, {RNEAGEN_BOUNDED, 1}, {RNEAGEN_FAST, 0}};
enum { SUBJECT_COUNT = sizeof SUBJECTS / sizeof *SUBJECTS };
static const int LEVELS[FACTORS] = {3, 3, 4, 2, 3, SUBJECT_COUNT};

static struct rneagen_options options_of(const int *row, char *scene, size_t size)
{
	const struct subject *s = &SUBJECTS[row[ROBOT]];
	struct rneagen_options o = rneagen_options_default();
	int is_mimic = !strcmp(s->name, "mimic_chain");

	snprintf(scene, size, "%s%s", s->scene, is_mimic && row[WAY] == 1 ? "" : WAYS[row[WAY]]);
	o.scene = scene;
	o.base = s->floating ? RNEAGEN_FLOATING : RNEAGEN_FIXED;
	o.target = TARGETS[row[TARGET]];
	o.precision = PRECISIONS[row[PRECISION]];
	o.layout = row[LAYOUT] ? RNEAGEN_AOS : RNEAGEN_SOA;
	o.trig = MODES[row[MODE]].trig;
	o.strict = MODES[row[MODE]].strict && o.precision != RNEAGEN_F32X2; /* these exclude each other */
	return o;
}

/* ---- what compilers say ---- */

/* A header stands beside what includes it. nvcc takes long. */
static void compile(const struct target *t, enum rneagen_target kind, int by_nvcc_too, const char *stem)
{
	static const char *const c_commands[] = {"gcc", "clang"};
	struct target_path source = target_path(stem, kind == RNEAGEN_TARGET_CUDA ? ".cu" : ".c"),
		header = target_path(stem, ".h");
	struct target_path object = target_path(stem, ".o");
	const char *const by_nvcc[] = {by_nvcc_too ? target_nvcc() : NULL, "-arch=sm_90", "-Werror", "all-warnings", "-ptx", "-o",
		object.s, source.s, NULL};
	char include[600];

	snprintf(include, sizeof include, "#include \"%s\"\ntypedef int nothing;\n", header.s);
	target_write(source, kind == RNEAGEN_TARGET_HEADER ? include : t->text.source);
	if (kind != RNEAGEN_TARGET_CUDA)
		target_write(header, kind == RNEAGEN_TARGET_HEADER ? t->text.source : t->text.header);
	for (int i = 0; i < 2; i++) {
		const char *const by_c[] = {c_commands[i], "-std=c11", WARNING_FLAGS, "-Wshadow", "-fsyntax-only", "-x",
			"c", source.s, NULL};
		const struct compiler c = {c_commands[i], {NULL}};

		if (!compiler_lacks(&c, 0))
			target_compile(t, by_c);
	}
	if (by_nvcc[0])
		target_compile(t, by_nvcc);
	unlink(source.s);
	unlink(header.s);
	unlink(object.s);
}

/* ---- run ---- */

struct arrays {
	void *at[DAG_ARGUMENTS];                          /* as the text has them */
	double in[DAG_ARGUMENTS][LARGEST], out[DAG_ARGUMENTS][LARGEST];
	double expected[DAG_ARGUMENTS][STATES][LARGEST], allowed[DAG_ARGUMENTS][STATES][LARGEST];
};

/* Of state LARGE, in rad: set where kernels are to take their tables of sines. */
enum { LARGE = 2 };
static double largest_angle = 1;

static void draw(const struct scene_model *m, struct rng *rng, int state, struct arrays *x)
{
	const struct dag *d = &m->dag;

	for (int k = 0; k < d->argument_count; k++)
		for (int i = 0; i < d->arguments[k].rows && (!state || !d->arguments[k].per_batch) &&
			!d->arguments[k].is_output; i++)
			x->in[k][i] = (double)(float)(rng_uniform(rng, -1, 1) + (d->arguments[k].role == ROLE_LINK_MASS ? 2 : 0));
	for (int i = 0; i < m->tree.nq && state == LARGE; i++)
		x->in[0][i] = (double)(float)(x->in[0][i] * largest_angle);
	for (int j = 0; j < m->tree.joint_count; j++) {
		double *u = x->in[0] + m->tree.joints[j].iq + 3, size = 0;

		for (int i = 0; i < 4 && m->tree.joints[j].nq == 7; i++)
			size += u[i] * u[i];
		for (int i = 0; i < 4 && m->tree.joints[j].nq == 7; i++)
			u[i] = (double)(float)(u[i] / sqrt(size));
	}
}

/* What the text computes, within twice the evaluator's own bound. */
static void expect(const struct dag *d, const struct rneagen_options *o, int sample, struct arrays *x)
{
	static float in_f32[DAG_ARGUMENTS][LARGEST], out_f32[DAG_ARGUMENTS][LARGEST];
	static double bound[DAG_ARGUMENTS * LARGEST];
	const double *in[DAG_ARGUMENTS] = {0};
	double *out[DAG_ARGUMENTS] = {0}, more = o->precision == RNEAGEN_F32X2 ? 64 : o->trig == RNEAGEN_FAST ? 16 : 2;
	const float *ins[DAG_ARGUMENTS] = {0};
	float *outs[DAG_ARGUMENTS] = {0};
	int is_f32 = o->precision == RNEAGEN_F32;

	for (int k = 0; k < d->argument_count; k++) {
		for (int i = 0; i < d->arguments[k].rows; i++)
			in_f32[k][i] = (float)x->in[k][i];
		in[k] = d->arguments[k].is_output ? NULL : x->in[k];
		ins[k] = d->arguments[k].is_output ? NULL : in_f32[k];
		out[k] = d->arguments[k].is_output ? x->out[k] : NULL;
		outs[k] = d->arguments[k].is_output ? out_f32[k] : NULL;
	}
	ck_assert(is_f32 ? eval_f32(d, ins, outs, &(struct eval_terms){.bound = bound})
			 : eval_f64(d, in, out, &(struct eval_terms){.bound = bound}));
	for (size_t i = 0; i < d->output_count; i++) {
		int k = d->outputs[i].argument, row = d->outputs[i].row;
		double value = is_f32 ? (double)out_f32[k][row] : x->out[k][row];

		ck_assert_msg(isfinite(value), "%s[%d] is %g", d->arguments[k].name, row, value);
		x->expected[k][sample][row] = value;
		x->allowed[k][sample][row] = more * bound[i] + (o->precision == RNEAGEN_MIXED ? fabs(value) * 0x1p-23 : 0);
	}
}

static size_t place(const struct rnea_info *info, int k, int rows, int sample, int row)
{
	return (size_t)(info->arguments[k].per_batch ? row : info->layout == RNEA_AOS ? sample * rows + row
		: row * COUNT + sample);
}

static void put(const struct scene_model *m, const struct rnea_info *info, int sample, struct arrays *x)
{
	for (int k = 0; k < m->dag.argument_count; k++)
		for (int i = 0; i < m->dag.arguments[k].rows && !m->dag.arguments[k].is_output; i++) {
			size_t at = place(info, k, m->dag.arguments[k].rows, sample, i);

			if (info->precision == RNEA_F64)
				((double *)x->at[k])[at] = x->in[k][i];
			else
				((float *)x->at[k])[at] = (float)x->in[k][i];
		}
}

static void fill(const struct scene_model *m, const struct rneagen_options *o, const struct rnea_info *info,
	uint64_t seed, struct arrays *x)
{
	struct rng rng = rng_seed(seed);

	ck_assert_int_eq((int)(info->input_count + info->output_count), m->dag.argument_count);
	for (int k = 0; k < m->dag.argument_count; k++) {
		ck_assert_str_eq(info->arguments[k].name, m->dag.arguments[k].name);
		ck_assert_int_le(m->dag.arguments[k].rows, LARGEST);
		x->at[k] = malloc((size_t)(COUNT * m->dag.arguments[k].rows) * sizeof(double));
		/* nan: what no text writes is seen */
		memset(x->at[k], 0xff, (size_t)(COUNT * m->dag.arguments[k].rows) * sizeof(double));
	}
	for (int state = 0; state < STATES; state++) {
		draw(m, &rng, state, x);
		expect(&m->dag, o, state, x);
		for (int s = state; s < COUNT; s += STATES)
			put(m, info, s, x);
	}
}

static void compare(const struct dag *d, const struct rnea_info *info, const struct arrays *x, const char *what)
{
	for (int k = 0; k < d->argument_count; k++)
		for (int i = 0; i < d->arguments[k].rows && d->arguments[k].is_output; i++)
			for (int s = 0; s < COUNT; s++) {
				size_t at = place(info, k, d->arguments[k].rows, s, i);
				double got = info->precision == RNEA_F64 ? ((double *)x->at[k])[at]
					: (double)((float *)x->at[k])[at];

				ck_assert_msg(fabs(got - x->expected[k][s % STATES][i]) <= x->allowed[k][s % STATES][i],
					"%s: %s[%d] of sample %d: %.17g, not %.17g (%.3g)", what, d->arguments[k].name,
					i, s, got, x->expected[k][s % STATES][i], x->allowed[k][s % STATES][i]);
			}
}

static void run_as(const struct scene_model *m, const struct rneagen_options *o, const struct target *t, struct rnea_options how,
	uint64_t seed)
{
	struct arrays *x = calloc(1, sizeof *x);
	struct rnea_robot *robot;
	struct rnea_error e;

	ck_assert(x != NULL);
	ck_assert_msg(!rnea_open(t->text.source, strlen(t->text.source), &how, &robot, &e), "%s: %s", t->what, e.message);
	fill(m, o, rnea_info(robot), seed, x);
	ck_assert_msg(!rnea_run(robot, x->at, COUNT, &e), "%s: %s", t->what, e.message);
	compare(&m->dag, rnea_info(robot), x, t->what);
	for (int k = 0; k < m->dag.argument_count; k++)
		free(x->at[k]);
	free(x);
	rnea_close(robot);
}

static void run_on(const struct scene_model *m, const struct rneagen_options *o, const struct target *t,
	enum rnea_backend backend, uint64_t seed)
{
	static const char *const as_calls[] = {"-Dalways_inline=unused"}; /* in line, pairs of floats take a compiler long */
	size_t is_pair = o->precision == RNEAGEN_F32X2 && backend == RNEA_BACKEND_HOST;
	struct rnea_options how = {.backend = backend, .cache = "", .compile = as_calls, .compile_count = is_pair};

	run_as(m, o, t, how, seed);
}

static void check_row(const int *row, uint64_t seed)
{
	const struct subject *s = &SUBJECTS[row[ROBOT]];
	char scene[512], stem[64];
	struct rneagen_options o = options_of(row, scene, sizeof scene);
	struct scene_model m;
	struct target t;
	size_t length;
	char *urdf = target_robot(s->name, &length);

	snprintf(stem, sizeof stem, "forward_%s_%d", s->name, (int)seed);
	o.name = stem;
	ck_assert_msg(!scene_open(&m, urdf, &o), "%s: %s", s->name, m.error.message);
	target_generate(&t, urdf, length, &o, stem);
	snprintf(t.what + strlen(t.what), sizeof t.what - strlen(t.what), ", way %d, seed %d", row[WAY], (int)seed);
	compile(&t, o.target, o.target == RNEAGEN_TARGET_CUDA && row[PRECISION] == row[ROBOT] % 4, stem);
	if (o.target != RNEAGEN_TARGET_HEADER)
		run_on(&m, &o, &t, RNEA_BACKEND_HOST, seed);
	if (o.target == RNEAGEN_TARGET_CUDA)
		run_on(&m, &o, &t, RNEA_BACKEND_CUDA, seed);
	target_close(&t);
	scene_close(&m);
	free(urdf);
}

START_TEST(texts)
{
	static struct pairs p;

	setenv("RNEA_LIBCUDA", FAKE_CUDA, 1);
	setenv("RNEA_NVRTC", FAKE_NVRTC, 1);
	p.factors = exhaustive() ? FACTORS : ROBOT;
	memcpy(p.levels, LEVELS, sizeof LEVELS);
	pairs_draw(&p, SEED);
	for (int i = 0; i < p.count; i++) {
		p.rows[i][ROBOT] = exhaustive() ? p.rows[i][ROBOT] : i % SUBJECT_COUNT;
		check_row(p.rows[i], (uint64_t)(SEED + i));
	}
	printf("%d texts, seed %d\n", p.count, SEED);
}
END_TEST

/* ---- three kernels in a row ---- */

/* shadow_hand_right: other fingers' rows are in a column of qdd, and not of tau. panda: fingers slide. atlas: legs and arms do
   not feel each other, which stands in a dense matrix; with one of each they are parts of the first kernel. hyq and panda float:
   their elements that -d tau leaves zero are read. So many samples are a small batch for the first kernel of hyq in f64 and of
   atlas too, and a large one for that of the others. */
static const struct relayed {
	const char *name;
	enum rneagen_precision precision;
	int floating, dense;
	const char *grid; /* threads for each sample of the third kernel, blocks of it that share columns at most, and samples of a
			     block, where they are more than a warp's */
	const char *tip;  /* of the robot that far; NULL: all of it */
	int starts;       /* parts of the first kernel; 1: it is whole */
	int is_aos;       /* outputs are turned by a fourth kernel */
} RELAYED[] = {
	{"hyq", RNEAGEN_F32, 1, 0, "1 528 64", NULL, 1, 0},
	{"hyq", RNEAGEN_F64, 1, 0, "2 264", NULL, 1, 0},
	{"shadow_hand_right", RNEAGEN_F64, 0, 0, "1 528", NULL, 1, 0},
	{"panda", RNEAGEN_F64, 1, 1, "1 528", NULL, 1, 0},
	{"atlas", RNEAGEN_F32, 0, 0, "1 528 64", "l_hand,l_foot", 2, 0},
	{"atlas", RNEAGEN_F64, 0, 0, "1 528", "l_hand,l_foot", 2, 0},
	{"hyq", RNEAGEN_F32, 1, 0, "1 528 64", NULL, 1, 1},
	{"atlas", RNEAGEN_F64, 0, 1, "1 528 32", "l_hand,l_foot", 2, 1},
	/* where all is asked for: compilers take long; g1_29dof: from each limb's loop on to one of all columns */
	{"g1_29dof", RNEAGEN_F32, 1, 0, "2 528", NULL, 1, 0},
	{"atlas", RNEAGEN_F64, 0, 1, "2 264", NULL, 2, 0},
};
enum { RELAYED_COUNT = sizeof RELAYED / sizeof *RELAYED, LONG_COUNT = 2 };

/* The parts of the first kernel have their slices in shared memory, where a store to global memory, as RNEA_STORE is one, stops
   the GPU with an error. The pretended GPU knows one memory. */
static void check_slices(const char *text, int is_staged)
{
	const char *body = strstr(text, "_fd_start_part0_body("), *end = body ? strstr(body, "\n}\n") : NULL, *store;

	ck_assert(!!strstr(text, "double slices[RNEA_BLOCK*") == is_staged);
	if (!is_staged)
		return;
	ck_assert(end != NULL);
	store = strstr(body, "RNEA_STORE(");
	ck_assert_msg(!store || store > end, "a part of the first kernel stores to global memory");
}

/* What the short form does not run: of a humanoid that floats each limb's columns go to the base in a loop of their own, and all
   out from it in one, of a quadruped each limb's in one loop. */
START_TEST(halves)
{
	static const struct {
		const char *name;
		int loops, is_halved;
	} of[] = {{"g1_29dof", 7, 1}, {"hyq", 5, 0}};
	struct rneagen_options o = rneagen_options_default();
	size_t length;
	char *urdf = target_robot(of[_i].name, &length), loop[60];
	struct target t;

	o.scene = "want qdd,dqdd_dq,dqdd_dqd\n";
	o.base = RNEAGEN_FLOATING;
	o.target = RNEAGEN_TARGET_CUDA;
	o.name = "halved";
	target_generate(&t, urdf, length, &o, "halved");
	snprintf(loop, sizeof loop, "halved_fd_solve_loop%d(column + k", of[_i].loops - 1);
	ck_assert(strstr(t.text.source, loop) != NULL);
	snprintf(loop, sizeof loop, "halved_fd_solve_loop%d(", of[_i].loops);
	ck_assert(!strstr(t.text.source, loop));
	ck_assert(!!strstr(t.text.source, "reduced[35] = {0};") == of[_i].is_halved);
	target_close(&t);
	free(urdf);
}
END_TEST

/* A first kernel in segments keeps its own values across cuts, where the main kernel has none: 8 bytes for each that the pass
   tells of. With the main kernel's bytes the launch would divide by 0. */
START_TEST(first_in_segments)
{
	struct rneagen_options o = rneagen_options_default();
	size_t length;
	char *urdf = target_robot("atlas", &length), room[60];
	const char *found;
	struct target t;
	int values = 0;

	o.scene = "tip l_foot,r_foot,l_hand\nwant qdd,dqdd_dq,dqdd_dqd\n";
	o.base = RNEAGEN_FLOATING;
	o.target = RNEAGEN_TARGET_CUDA;
	o.precision = RNEAGEN_F64;
	o.limbs = RNEAGEN_LIMBS_NONE;
	o.dump = RNEAGEN_DUMP_SEGMENTS;
	target_generate(&t, urdf, length, &o, "segmented");
	found = strstr(t.text.dump, "fd_start: ");
	ck_assert(found && sscanf(found, "fd_start: %d values across", &values) == 1 && values > 0);
	target_close(&t);
	o.dump = RNEAGEN_DUMP_NONE;
	target_generate(&t, urdf, length, &o, "segmented");
	snprintf(room, sizeof room, "(49152/(RNEA_BLOCK*%d))\n", 8 * values);
	ck_assert_msg(strstr(t.text.source, room) != NULL, "the first kernel has no room for %d values", values);
	ck_assert(strstr(t.text.source, "(RNEA_ACROSS_ROOM >= 2 ? 2 :") != NULL);
	target_close(&t);
	free(urdf);
}
END_TEST

START_TEST(relay)
{
	static const char *const no_limbs[] = {"-DRNEA_NO_LIMBS"};
	const struct relayed *x = &RELAYED[_i];
	struct rneagen_options o = rneagen_options_default();
	struct scene_model m;
	struct target t;
	size_t length;
	char *urdf = target_robot(x->name, &length), line[32], scene[80];

	setenv("RNEA_LIBCUDA", FAKE_CUDA, 1);
	setenv("RNEA_NVRTC", FAKE_NVRTC, 1);
	snprintf(scene, sizeof scene, "%s%s%s%swant qdd,dqdd_dq,dqdd_dqd\n", x->dense ? "dense\n" : "", x->tip ? "tip " : "",
		x->tip ? x->tip : "", x->tip ? "\n" : "");
	o.scene = scene;
	o.base = x->floating ? RNEAGEN_FLOATING : RNEAGEN_FIXED;
	o.target = RNEAGEN_TARGET_CUDA;
	o.precision = x->precision;
	o.layout = x->is_aos ? RNEAGEN_AOS : RNEAGEN_SOA;
	o.name = "relayed";
	ck_assert_msg(!scene_open(&m, urdf, &o), "%s: %s", x->name, m.error.message);
	target_generate(&t, urdf, length, &o, "relayed");
	snprintf(line, sizeof line, " %s\\n\"", x->grid);
	largest_angle = x->precision == RNEAGEN_F32 ? 3e4 : 3e7;
	ck_assert_msg(strstr(t.text.source, "\"relay ") && strstr(t.text.source, line), "%s is no relay", x->name);
	ck_assert(!!strstr(t.text.source, "reduced[") == !strcmp(x->name, "g1_29dof"));
	ck_assert_msg((x->starts > 1) == !!strstr(t.text.source, "\"start_parts 2\\n\""), "%s: parts of the first kernel", x->name);
	check_slices(t.text.source, x->starts > 1 && x->precision == RNEAGEN_F64 && !x->is_aos);
	ck_assert(!!strstr(t.text.source, "\"transpose 16 ") == x->is_aos);
	/* without limbs it is the same but where the batch is small: in the short form of hyq in f64 and of atlas in f32 */
	if (exhaustive() ? _i < RELAYED_COUNT - LONG_COUNT : _i == 1 || _i == 4)
		run_on(&m, &o, &t, RNEA_BACKEND_CUDA, SEED);
	if (exhaustive() || _i != 1)
		run_as(&m, &o, &t,
			(struct rnea_options){.backend = RNEA_BACKEND_CUDA, .cache = "", .compile = no_limbs, .compile_count = 1},
			SEED);
	if (exhaustive() && (x->tip || !strcmp(x->name, "panda")))
		run_on(&m, &o, &t, RNEA_BACKEND_HOST, SEED);
	target_close(&t);
	scene_close(&m);
	free(urdf);
}
END_TEST

/* ---- the same bits ---- */

/* The first sets them. */
static const struct compiler STRICT[] = {{"gcc", {"-O0", "-std=c11"}}, {"clang", {"-O0", "-std=c11"}},
	{"gcc", {"-O3", "-std=gnu11", "-ffp-contract=fast", "-march=x86-64-v3"}},
	{"clang", {"-O3", "-std=c11", "-ffp-contract=fast", "-march=x86-64-v3"}}, {"gcc", {"-O2", "-std=c11"}}};

enum { STRICT_COUNT = sizeof STRICT / sizeof *STRICT, NV = 6 };

static void run_strict(const struct target *t, const struct compiler *c, int f32, double *out)
{
	struct target_path source = target_path("forward_strict", ".c"), library = target_path("forward_strict", ".so");
	const char *argv[20] = {c->command, "-fPIC", "-shared", "-o", library.s, source.s};
	void (*as_f64)(const double *q, const double *qd, const double *tau, double *qdd, double *X);
	void (*as_f32)(const float *q, const float *qd, const float *tau, float *qdd, float *X);
	struct rng rng = rng_seed(SEED);
	void *handle;
	int n = 6;

	for (int i = 0; c->flags[i]; i++)
		argv[n++] = c->flags[i];
	argv[n] = "-lm";
	target_compile(t, argv);
	handle = dlopen(library.s, RTLD_NOW | RTLD_LOCAL);
	ck_assert_msg(handle != NULL, "%s", dlerror());
	target_symbol(t, handle, "forward_strict_fd", &as_f64);
	target_symbol(t, handle, "forward_strict_fd", &as_f32);
	for (int s = 0; s < COUNT; s++, out += NV + NV * NV) {
		double in[3 * NV];
		float in_f32[3 * NV], out_f32[NV + NV * NV];

		for (int i = 0; i < 3 * NV; i++)
			in_f32[i] = (float)(in[i] = rng_uniform(&rng, -2, 2));
		if (!f32) {
			as_f64(in, in + NV, in + 2 * NV, out, out + NV);
			continue;
		}
		as_f32(in_f32, in_f32 + NV, in_f32 + 2 * NV, out_f32, out_f32 + NV);
		for (int i = 0; i < NV + NV * NV; i++)
			out[i] = (double)out_f32[i];
	}
	dlclose(handle);
	unlink(library.s);
}

START_TEST(strict)
{
	static double first[COUNT * (NV + NV * NV)], now[COUNT * (NV + NV * NV)];
	struct rneagen_options o = rneagen_options_default();
	char scene[128];
	struct target t;
	size_t length;
	char *urdf = target_robot("ur5", &length);
	int f32 = _i;

	snprintf(scene, sizeof scene, "dense\nrefine 1\nwant qdd,Minv\n%s", WAYS[_i]);
	o.scene = scene;
	o.target = RNEAGEN_TARGET_C;
	o.precision = f32 ? RNEAGEN_F32 : RNEAGEN_F64;
	o.strict = 1;
	o.name = "forward_strict";
	target_generate(&t, urdf, length, &o, "ur5");
	target_write(target_path("forward_strict", ".c"), t.text.source);
	for (int i = 0; i < STRICT_COUNT; i++) {
		if (!compiler_serves(&STRICT[i], STRICT[i].flags[3] != NULL))
			continue;
		run_strict(&t, &STRICT[i], f32, i ? now : first);
		for (int k = 0; k < COUNT * (NV + NV * NV) && i; k++)
			ck_assert_msg(same_number(first[k], now[k]), "%s by %s %s: number %d is %a, not %a", t.what,
				STRICT[i].command, STRICT[i].flags[0], k, now[k], first[k]);
	}
	unlink(target_path("forward_strict", ".c").s);
	target_close(&t);
	free(urdf);
}
END_TEST

int main(void)
{
	Suite *suite = suite_create("forward texts");

	setvbuf(stdout, NULL, _IOLBF, 0);
	suite_add(suite, "texts", texts, 1, 300);
	suite_add(suite, "halves", halves, 2, 60);
	suite_add(suite, "first_in_segments", first_in_segments, 1, 60);
	suite_add(suite, "relay", relay, RELAYED_COUNT - (exhaustive() ? 0 : LONG_COUNT), 300);
	suite_add(suite, "strict", strict, 2, 120);
	return suite_run(suite);
}
