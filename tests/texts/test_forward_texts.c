/* Texts of forward dynamics by drawn pairs of options: no compiler has a word to say of them, and run by librnea, on
   the host and on the pretended device, they give what the evaluated DAG gives. Robots take turns; where all is asked for,
   they are one more option. */
#define _POSIX_C_SOURCE 200809L
#include "forward_run.h"
#include "support/exhaustive.h"
#include "support/pairs.h"
#include "support/suite.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { SEED = 77 };
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
		forward_run(&m, &o, &t, RNEA_BACKEND_HOST, 1, seed);
	if (o.target == RNEAGEN_TARGET_CUDA)
		forward_run(&m, &o, &t, RNEA_BACKEND_CUDA, 1, seed);
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

int main(void)
{
	Suite *suite = suite_create("forward texts");

	setvbuf(stdout, NULL, _IOLBF, 0);
	suite_add(suite, "texts", texts, 1, 300);
	return suite_run(suite);
}
