#include "test_runtime_batch.h"
#include "test_runtime.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

struct rnea_robot *soa, *aos;

static const size_t rows[ARRAYS] = {2, 3, 4, 2, 1}, bytes[ARRAYS] = {4, 8, 4, 4, 8};

size_t batch_size(const struct batch *b, int i)
{
	return rows[i] * bytes[i] * (i == 2 ? 1 : b->count);
}

static void batch_fill(struct batch *b, unsigned seed)
{
	float *a = b->arrays[0], *g = b->arrays[2];
	double *d = b->arrays[1];

	for (size_t i = 0; i < 2 * b->count; i++)
		a[i] = (float)((i * 7 + seed) % 4001) * 0.5f;
	for (size_t i = 0; i < 3 * b->count; i++)
		d[i] = (double)((i * 13 + seed) % 8009) * 0.25;
	for (size_t i = 0; i < 4; i++)
		g[i] = (float)(seed % 5 + i + 1);
}

void batch_make(struct batch *b, size_t count, int is_aos, unsigned seed)
{
	b->count = count;
	b->aos = is_aos;
	for (int i = 0; i < ARRAYS; i++) {
		size_t size = batch_size(b, i);

		b->memory[i] = malloc(size + 2 * GUARD);
		ck_assert_ptr_nonnull(b->memory[i]);
		memset(b->memory[i], POISON, size + 2 * GUARD);
		b->arrays[i] = b->memory[i] + GUARD;
	}
	batch_fill(b, seed);
}

void batch_free(struct batch *b)
{
	for (int i = 0; i < ARRAYS; i++)
		free(b->memory[i]);
}

static size_t at(const struct batch *b, size_t k, size_t row, size_t n)
{
	return b->aos ? k * n + row : row * b->count + k;
}

int batch_is_right(const struct batch *b)
{
	const float *a = b->arrays[0], *g = b->arrays[2], *x = b->arrays[3];
	const double *d = b->arrays[1], *y = b->arrays[4];

	for (size_t k = 0; k < b->count; k++) {
		for (size_t r = 0; r < 2; r++)
			if (x[at(b, k, r, 2)] != a[at(b, k, r, 2)] * g[r] + (float)d[at(b, k, 0, 3)])
				return 0;
		if (y[k] != d[at(b, k, 1, 3)] + d[at(b, k, 2, 3)] + (double)g[3])
			return 0;
	}
	for (int i = 0; i < ARRAYS; i++)
		for (size_t j = 0; j < GUARD; j++)
			if (b->memory[i][j] != POISON || b->memory[i][GUARD + batch_size(b, i) + j] != POISON)
				return 0;
	return 1;
}

static void defer(int yes)
{
	void (*call)(int);

	fake_function(FAKE_CUDA, "fake_cuda_defer", &call);
	call(yes);
}

struct rnea_robot *batch_open(int is_aos)
{
	char *text = read_text(TEST_DIR "/runtime/mixed.cu", NULL);
	struct rnea_robot *robot;
	struct rnea_error e;

	if (is_aos) {
		memcpy(strstr(text, "MIXED_AOS 0"), "MIXED_AOS 1", 11);
		memcpy(strstr(text, "layout soa"), "layout aos", 10);
	}
	ck_assert_msg(open_text(text, NULL, &robot, &e) == RNEA_OK, "%s", e.message);
	free(text);
	return robot;
}

void batch_setup(void)
{
	use_fakes();
	soa = batch_open(0);
	aos = batch_open(1);
	defer(1);
}

void batch_teardown(void)
{
	use_fakes();
	rnea_close(soa);
	rnea_close(aos);
	ck_assert_int_eq(fake_live(), 0);
}
