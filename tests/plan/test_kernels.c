/* What kernels ask of a multiprocessor, beside what every one has. It would catch a block whose slices or windows have no
   room in the shared memory that a kernel has unasked, which no launch could run, and launch bounds under which ptxas has to
   spill all that a thread holds, or that no multiprocessor meets. */
#include "plan/stage.h"
#include "rneagen.h"
#include "support/read.h"
#include "support/suite.h"
#include <stdlib.h>
#include <string.h>

/* Threads of a multiprocessor, of which one of compute capability 8.6 has the fewest; registers of a thread below which even an
   arm's torques spill. */
enum { THREADS = 1536, FEWEST = 72 };

enum { NUMBERS = 2, LAYOUTS = 2 };

static const char *const scenes[] = {"want tau\n", "want tau,vjp\n", "want tau,dtau_dq\n", "want qdd\n", "want qdd\nvjp qdd\n"};
enum { SCENES = sizeof scenes / sizeof *scenes };

/* The first scenes of a humanoid, on a fixed base: the others take long. */
static const struct {
	const char *name;
	int bases, scenes;
} robots[] = {{"iiwa14", 2, SCENES}, {"hyq", 2, SCENES}, {"atlas", 1, 2}};
enum { ROBOTS = sizeof robots / sizeof *robots };

/* The number after these words in a dump; 0: they are not there. */
static int value(const char *dump, const char *words)
{
	const char *found = strstr(dump, words);

	return found ? atoi(found + strlen(words)) : 0;
}

/* How many kernels there were of each kind: a kind that is never seen is not tested. */
struct seen {
	int sliced, windowed, bounded, alone;
};

static void check(const char *dump, struct seen *seen)
{
	int block = value(dump, "threads of a block: "), blocks = value(dump, "blocks that have room: ");
	int slice = value(dump, "slice of a sample, bytes: "), window = value(dump, "window of a warp, bytes: ");
	int alone = value(dump, "threads of a block there: ");

	ck_assert_int_ge(block, WARP_THREADS);
	ck_assert_int_eq(block % WARP_THREADS, 0);
	ck_assert_int_le(block * slice, SHARED_BYTES);
	ck_assert_int_le(block / WARP_THREADS * window, SHARED_BYTES);
	ck_assert(!slice || !window);
	ck_assert_int_le(blocks * block, THREADS);
	ck_assert_int_le(blocks * block * FEWEST, REGISTERS);
	ck_assert_int_eq(alone % WARP_THREADS, 0);
	ck_assert_int_eq(alone > 0, value(dump, "has a kernel from so many samples on: ") > 0);
	seen->sliced += slice > 0;
	seen->windowed += window > 0;
	seen->bounded += blocks > 0;
	seen->alone += alone > 0;
}

static void check_scenes(const char *urdf, struct rneagen_options o, int count, struct seen *seen)
{
	struct rneagen_result r;
	struct rneagen_error e;

	for (int i = 0; i < count; i++) {
		o.scene = scenes[i];
		ck_assert_msg(!rneagen_generate(urdf, strlen(urdf), &o, &r, &e), "%s", e.message);
		check(r.dump, seen);
		rneagen_result_free(&r);
	}
}

START_TEST(a_multiprocessor_has_what_kernels_ask_for)
{
	static const enum rneagen_precision precisions[NUMBERS] = {RNEAGEN_F32, RNEAGEN_F64};
	static const enum rneagen_layout layouts[LAYOUTS] = {RNEAGEN_SOA, RNEAGEN_AOS};
	static const enum rneagen_base bases[] = {RNEAGEN_FIXED, RNEAGEN_FLOATING};
	struct seen seen = {0};

	for (int robot = 0; robot < ROBOTS; robot++) {
		char *urdf = robot_text(robots[robot].name);

		for (int k = 0; k < NUMBERS * LAYOUTS * robots[robot].bases; k++) {
			struct rneagen_options o = rneagen_options_default();

			o.dump = RNEAGEN_DUMP_KERNELS;
			o.target = RNEAGEN_TARGET_CUDA;
			o.limbs = RNEAGEN_LIMBS_NONE; /* which take long, and change nothing here */
			o.precision = precisions[k % NUMBERS];
			o.layout = layouts[k / NUMBERS % LAYOUTS];
			o.base = bases[k / NUMBERS / LAYOUTS];
			check_scenes(urdf, o, robots[robot].scenes, &seen);
		}
		free(urdf);
	}
	ck_assert_msg(seen.sliced && seen.windowed && seen.bounded && seen.alone, "seen: %d with slices, %d with windows, %d bounded, "
		"%d of large batches", seen.sliced, seen.windowed, seen.bounded, seen.alone);
}
END_TEST

int main(void)
{
	Suite *suite = suite_create("kernels");

	suite_add(suite, "kernels", a_multiprocessor_has_what_kernels_ask_for, 1, 60);
	return suite_run(suite);
}
