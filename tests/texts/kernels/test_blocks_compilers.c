/* Texts in blocks of 32 to 1024 threads, without a GPU: NVRTC and nvcc take them without a word, for devices of any
   architecture, and the kernels have as much shared memory of their own as they should. The texts are drawn so that
   every two choices meet. */
#define _GNU_SOURCE
#include "support/exhaustive.h"
#include "support/rng.h"
#include "support/suite.h"
#include "target/target.h"
#include "cuda/compile/jit.h"
#include <elf.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { SEED = 20261126, OWN = 48 << 10, GIVEN = 227 << 10, RESERVED = 1 << 10, BARRIER = 128 };

/* ---- what is drawn ---- */

enum factor { ROBOT, SCENE, PRECISION, LAYOUT, TRIG, BASE, BLOCK, ARCH, FACTORS };
enum { LEVEL_LIMIT = 6, ROW_LIMIT = 100, TRIES = 400 };

struct row {
	int level[FACTORS];
};

enum { ROD, SHORT_CHAIN, ARM, CHAIN };
static const struct {
	const char *name, *tip;
} ROBOTS[] = {{"pendulum", "rod"}, {"chain 4", "l4"}, {"iiwa14", "iiwa_link_7"}, {"chain 29", "l29"}};

enum { PLAIN, MATRICES, FREED, PRODUCT, STRICT };
static const char *const SCENES[] = {
	"", "want tau,dtau_dq,dtau_dqd,M\n", "free payload.%s:sample,gravity\nwant gravity,bias\n", "want jvp\n", ""};
static const enum rneagen_precision PRECISIONS[] = {RNEAGEN_F32, RNEAGEN_F64, RNEAGEN_MIXED, RNEAGEN_F32X2};
static const unsigned BLOCKS[] = {32, 64, 128, 256, 512, 1024};
static const int ARCHS[] = {75, 86, 90, 100};
static const int LEVELS[FACTORS] = {4, 5, 4, 2, 3, 2, 6, 4};

/* Pairs of floats and the fast sine do not go with --strict; over pairs, and matrices of many joints, compilers take long. */
static int is_possible(const struct row *r)
{
	int pairs = PRECISIONS[r->level[PRECISION]] == RNEAGEN_F32X2;

	if (r->level[SCENE] == STRICT && (pairs || r->level[TRIG] == RNEAGEN_FAST))
		return 0;
	if (r->level[SCENE] == MATRICES && r->level[ROBOT] == CHAIN)
		return 0;
	return !pairs || (r->level[ROBOT] != ARM && (r->level[ROBOT] != CHAIN || r->level[SCENE] == PLAIN));
}

static struct row draw(struct rng *rng)
{
	struct row r;

	do
		for (int f = 0; f < FACTORS; f++)
			r.level[f] = rng_below(rng, LEVELS[f]);
	while (!is_possible(&r));
	return r;
}

static char met[FACTORS][LEVEL_LIMIT][FACTORS][LEVEL_LIMIT];

/* How many pairs of choices a row brings together that have not met; they have then, if it is taken. */
static int meet(const struct row *r, int take)
{
	int count = 0;

	for (int f = 0; f < FACTORS; f++)
		for (int g = 0; g < f; g++) {
			char *m = &met[f][r->level[f]][g][r->level[g]];

			count += !*m;
			*m |= (char)take;
		}
	return count;
}

/* Of so many rows drawn the one that brings most together, until nothing new comes. */
static int draw_rows(struct row *rows)
{
	struct rng rng = rng_seed(SEED);
	int count = 0;

	for (int most = 1; most && count < ROW_LIMIT; count += most > 0) {
		most = 0;
		for (int i = 0; i < TRIES; i++) {
			struct row r = draw(&rng);
			int new = meet(&r, 0);

			if (new > most)
				rows[count] = r;
			most = new > most ? new : most;
		}
		if (most)
			meet(&rows[count], 1);
	}
	return count;
}

static void generate(const struct row *r, struct target *t)
{
	struct rneagen_options o = rneagen_options_default();
	const char *name = ROBOTS[r->level[ROBOT]].name;
	char scene[256], *urdf, *at;
	size_t length;

	snprintf(scene, sizeof scene, "%s", SCENES[r->level[SCENE]]);
	if ((at = strstr(scene, "%s")) != NULL)
		snprintf(at, sizeof scene - (size_t)(at - scene), "%s%s", ROBOTS[r->level[ROBOT]].tip,
			strstr(SCENES[r->level[SCENE]], "%s") + 2);
	o.scene = scene;
	o.strict = r->level[SCENE] == STRICT;
	o.precision = PRECISIONS[r->level[PRECISION]];
	o.layout = (enum rneagen_layout)r->level[LAYOUT];
	o.trig = (enum rneagen_trig)r->level[TRIG];
	o.base = (enum rneagen_base)r->level[BASE];
	o.name = "arm";
	urdf = target_robot(name, &length);
	target_generate(t, urdf, length, &o, name);
	free(urdf);
	snprintf(t->what + strlen(t->what), sizeof t->what - strlen(t->what), " scene %d, blocks of %u, sm_%d", r->level[SCENE],
		BLOCKS[r->level[BLOCK]], ARCHS[r->level[ARCH]]);
}

/* ---- what comes of it ---- */

/* Bytes of shared memory that a cubin's rnea kernel has of its own; since sm_90 one KiB beside them is the system's. */
static size_t own_bytes(const char *cubin, int arch)
{
	const Elf64_Ehdr *head = (const void *)cubin;
	const Elf64_Shdr *sections = (const void *)(cubin + head->e_shoff);
	const char *names = cubin + sections[head->e_shstrndx].sh_offset;

	for (int i = 0; i < head->e_shnum; i++)
		if (strcmp(names + sections[i].sh_name, ".nv.shared.arm_rnea_kernel") == 0)
			return sections[i].sh_size - (arch >= 90 ? RESERVED : 0);
	return 0;
}

/* Since sm_90 whole samples come through a barrier of the block's, where there is room for it: what it takes. */
static size_t barrier_bytes(const struct row *r, size_t stage)
{
	int has_room = stage > 0 && (stage <= OWN - BARRIER || (stage > OWN && stage <= GIVEN - BARRIER));

	return r->level[LAYOUT] == RNEAGEN_AOS && ARCHS[r->level[ARCH]] >= 90 && has_room ? BARRIER : 0;
}

/* A slice that fits, and, of derivatives alone, what registers do not hold. */
static void check_cubin(const struct target *t, const struct row *r, const char *cubin)
{
	const char *line = strstr(t->text.source, "\"stage ");
	size_t stage = (line ? strtoul(line + 7, NULL, 10) : 0) * BLOCKS[r->level[BLOCK]], least = stage <= OWN ? stage : 0;
	size_t own = own_bytes(cubin, ARCHS[r->level[ARCH]]),
	       barrier = barrier_bytes(r, stage),
	       most = r->level[SCENE] == MATRICES || r->level[SCENE] == PRODUCT ? OWN : least + barrier;

	ck_assert_msg(least + !!barrier <= own && own <= most, "%s: %zu bytes of its own, it stages %zu", t->what, own, stage);
}

static int nvrtc_is_missing;

static void check_nvrtc(const struct target *t, const struct row *r)
{
	char log[4096] = "", block[32];
	const char *const options[] = {block};
	struct jit_request j = {.source = t->text.source,
		.file = "arm.cu",
		.arch = ARCHS[r->level[ARCH]],
		.options = options,
		.option_count = 1,
		.log = log,
		.log_size = sizeof log};
	struct jit_image image;
	struct rnea_error e = {0};

	snprintf(block, sizeof block, "-DRNEA_BLOCK=%u", BLOCKS[r->level[BLOCK]]);
	jit_compile(&j, &image, &e);
	nvrtc_is_missing = e.code == RNEA_NO_COMPILER;
	if (nvrtc_is_missing) {
		printf("skipped: %s\n", e.message);
		return;
	}
	ck_assert_msg(e.code == RNEA_OK && !*log, "%s: %s\n%s", t->what, e.message, log);
	if (!image.is_ptx) /* of an older NVRTC */
		check_cubin(t, r, image.data);
	jit_free(&image);
}

/* With the launch, which is the host's. */
static void check_nvcc(const struct target *t, const char *nvcc, int sm, const char *macro)
{
	struct target_path source = target_path("blocks", ".cu"), object = target_path("blocks", ".o");
	char arch[32];
	const char *const argv[] = {nvcc, arch, macro, "-Werror", "all-warnings", "-c", "-o", object.s, source.s, NULL};

	snprintf(arch, sizeof arch, "-arch=sm_%d", sm);
	target_write(source, t->text.source);
	target_compile(t, argv);
	unlink(object.s);
	unlink(source.s);
}

START_TEST(test_nvrtc)
{
	static struct row rows[ROW_LIMIT];
	int count = draw_rows(rows);
	struct target t;

	printf("%d texts%s, seed %d\n", count, exhaustive() ? "" : ", of them every fourth", SEED);
	for (int i = 0; i < count && !nvrtc_is_missing; i += exhaustive() ? 1 : 4) {
		generate(&rows[i], &t);
		check_nvrtc(&t, &rows[i]);
		rneagen_result_free(&t.text);
	}
}
END_TEST

/* Each block once, of texts that stage: in memory of the kernel's own, of the launch, and not at all. */
START_TEST(test_nvcc)
{
	static const struct row rows[] = {
		{{[ROBOT] = CHAIN, [PRECISION] = 1, [BLOCK] = 0, [ARCH] = 2}},
		{{[ROBOT] = ARM, [LAYOUT] = 1, [SCENE] = MATRICES, [BLOCK] = 2, [ARCH] = 2}},
		{{[ROBOT] = CHAIN, [PRECISION] = 1, [BLOCK] = 4, [ARCH] = 2}},
		{{[ROBOT] = ARM, [BLOCK] = 5, [ARCH] = 1}},
	};
	const char *nvcc = target_nvcc();
	struct target t;
	char block[32];

	if (!nvcc || (_i % 2 && !exhaustive()))
		return;
	generate(&rows[_i], &t);
	snprintf(block, sizeof block, "-DRNEA_BLOCK=%u", BLOCKS[rows[_i].level[BLOCK]]);
	check_nvcc(&t, nvcc, ARCHS[rows[_i].level[ARCH]], block);
	rneagen_result_free(&t.text);
}
END_TEST

/* Parts whose slices are pieces of each sample: nothing stands there that only whole slices use. */
START_TEST(test_pieces)
{
	struct rneagen_options o = rneagen_options_default();
	size_t length;
	char *urdf = target_robot("atlas", &length);
	const char *nvcc = target_nvcc();
	struct target t;

	o.scene = "want qdd\n";
	o.precision = RNEAGEN_F64;
	o.layout = RNEAGEN_AOS;
	target_generate(&t, urdf, length, &o, "atlas in pieces");
	ck_assert_ptr_nonnull(strstr(t.text.source, "rneagen_stage_rows_in<"));
	ck_assert_ptr_null(strstr(t.text.source, "rneagen_stage_in<"));
	if (nvcc)
		check_nvcc(&t, nvcc, 90, "-DRNEA_NO_LIMBS");
	rneagen_result_free(&t.text);
	free(urdf);
}
END_TEST

int main(void)
{
	Suite *s = suite_create("blocks_compilers");

	setvbuf(stdout, NULL, _IOLBF, 0);
	unsetenv("RNEA_NVRTC");
	suite_add(s, "nvrtc", test_nvrtc, 1, 600);
	suite_add(s, "nvcc", test_nvcc, 4, 120);
	suite_add(s, "pieces", test_pieces, 1, 120);
	return suite_run(s);
}
