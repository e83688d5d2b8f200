#include "host/rows.h"
#include <stdatomic.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

/* Rows are apart by no power of two, or they would all take the same few lines of the cache. */
enum { PIECE = 256, BAND = 8, PAD = 8 };

struct batch {
	host_slice *slice;
	const struct rnea_function *table;
	void *const *arrays;
	size_t count;
	atomic_int failed;
};

/* [samples][rows] at `a` and [rows][stride] at `s`, in bands of samples that share lines of the cache. */
#define TURN(type, name, to, from)                                                                                     \
	static void name(type *restrict a, type *restrict s, size_t rows, size_t stride, size_t samples)                \
	{                                                                                                               \
		size_t band = 0;                                                                                        \
                                                                                                                        \
		for (; band + BAND <= samples; band += BAND)                                                            \
			for (size_t r = 0; r < rows; r++)                                                               \
				for (size_t k = band; k < band + BAND; k++)                                             \
					to = from;                                                                      \
		for (size_t r = 0; r < rows; r++)                                                                       \
			for (size_t k = band; k < samples; k++)                                                         \
				to = from;                                                                              \
	}
TURN(uint32_t, turn_in_32, s[r * stride + k], a[k * rows + r])
TURN(uint64_t, turn_in_64, s[r * stride + k], a[k * rows + r])
TURN(uint32_t, turn_out_32, a[k * rows + r], s[r * stride + k])
TURN(uint64_t, turn_out_64, a[k * rows + r], s[r * stride + k])

static size_t size_of(const struct rnea_argument *a)
{
	return a->scalar == RNEA_F64 ? sizeof(double) : sizeof(float);
}

static void turn(const struct rnea_argument *a, int is_output, char *array, char *turned, size_t first, size_t stride,
	size_t samples)
{
	char *at = array + first * a->rows * size_of(a);

	if (a->scalar == RNEA_F64)
		(is_output ? turn_out_64 : turn_in_64)((uint64_t *)at, (uint64_t *)turned, a->rows, stride, samples);
	else
		(is_output ? turn_out_32 : turn_in_32)((uint32_t *)at, (uint32_t *)turned, a->rows, stride, samples);
}

static void run_piece(void *job, size_t i)
{
	struct batch *b = job;
	const struct rnea_function *f = b->table;
	size_t first = i * PIECE, samples = b->count - first < PIECE ? b->count - first : PIECE,
	       arrays = f->input_count + f->output_count;
	size_t used = 0, total = 0, stride = samples + PAD;
	void *pointers[RNEA_ARGUMENT_LIMIT] = {NULL};
	char *turned;

	for (size_t k = 0; k < arrays; k++)
		total += f->arguments[k].rows * size_of(&f->arguments[k]) * stride;
	if (!(turned = malloc(total))) {
		atomic_store(&b->failed, 1);
		return;
	}
	for (size_t k = 0; k < arrays; k++) {
		const struct rnea_argument *a = &f->arguments[k];

		pointers[k] = a->per_batch ? b->arrays[k] : turned + used;
		if (!a->per_batch && k < f->input_count)
			turn(a, 0, b->arrays[k], pointers[k], first, stride, samples);
		used += a->rows * size_of(a) * stride;
	}
	b->slice(pointers, stride, 0, samples);
	for (size_t k = f->input_count; k < arrays; k++)
		turn(&f->arguments[k], 1, b->arrays[k], pointers[k], first, stride, samples);
	free(turned);
}

int host_run_aos(const struct host *h, const struct host_function *f, const struct rnea_function *table,
	void *const *arrays, size_t count)
{
	struct batch b = {.slice = f->slice, .table = table, .arrays = arrays, .count = count};
	size_t pieces = count / PIECE + (count % PIECE != 0);

	if (count == 1)
		f->slice(arrays, 1, 0, 1);
	else if (pieces == 1)
		run_piece(&b, 0);
	else
		workers_run(h->workers, host_threads(h, f, count), run_piece, &b, pieces);
	return !atomic_load(&b.failed);
}
