/* Accelerations with their derivatives as relays: what such a text holds, and run on the pretended device it gives what the
   evaluated DAG gives. It would catch a kernel that reads what none before it left, and one without room for what it keeps. */
#define _POSIX_C_SOURCE 200809L
#include "forward_run.h"
#include "support/exhaustive.h"
#include "support/suite.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { SEED = 77 };

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
	double largest_angle = x->precision == RNEAGEN_F32 ? 3e4 : 3e7; /* kernels take their tables of sines */

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
	ck_assert_msg(strstr(t.text.source, "\"relay ") && strstr(t.text.source, line), "%s is no relay", x->name);
	ck_assert(!!strstr(t.text.source, "reduced[") == !strcmp(x->name, "g1_29dof"));
	ck_assert_msg((x->starts > 1) == !!strstr(t.text.source, "\"start_parts 2\\n\""), "%s: parts of the first kernel", x->name);
	check_slices(t.text.source, x->starts > 1 && x->precision == RNEAGEN_F64 && !x->is_aos);
	ck_assert(!!strstr(t.text.source, "\"transpose 16 ") == x->is_aos);
	/* without limbs it is the same but where the batch is small: in the short form of hyq in f64 and of atlas in f32 */
	if (exhaustive() ? _i < RELAYED_COUNT - LONG_COUNT : _i == 1 || _i == 4)
		forward_run(&m, &o, &t, RNEA_BACKEND_CUDA, largest_angle, SEED);
	if (exhaustive() || _i != 1)
		forward_run_as(&m, &o, &t,
			(struct rnea_options){.backend = RNEA_BACKEND_CUDA, .cache = "", .compile = no_limbs, .compile_count = 1},
			largest_angle, SEED);
	if (exhaustive() && (x->tip || !strcmp(x->name, "panda")))
		forward_run(&m, &o, &t, RNEA_BACKEND_HOST, largest_angle, SEED);
	target_close(&t);
	scene_close(&m);
	free(urdf);
}
END_TEST

int main(void)
{
	Suite *suite = suite_create("relays");

	setvbuf(stdout, NULL, _IOLBF, 0);
	suite_add(suite, "halves", halves, 2, 60);
	suite_add(suite, "first_in_segments", first_in_segments, 1, 60);
	suite_add(suite, "relay", relay, RELAYED_COUNT - (exhaustive() ? 0 : LONG_COUNT), 300);
	return suite_run(suite);
}
