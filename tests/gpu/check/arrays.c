#include "arrays.h"
#include <stdlib.h>

size_t arrays_bytes(const struct rnea_argument *a, size_t count)
{
	return a->rows * count * (a->scalar == RNEA_F64 ? sizeof(double) : sizeof(float));
}

static void arrays_fill(const struct gpu *g, struct arrays *a, const struct rnea_info *info, const struct reference *r)
{
	for (size_t i = 0; i < info->input_count; i++) {
		const struct rnea_argument *input = &info->arguments[i];

		samples_tile(reference_find(r, input->name), a->host, a->count, input->scalar, info->layout);
		GPU(g, cuMemcpyHtoD, (a->array[i].data, a->host, a->array[i].bytes));
	}
	/* a copy from pageable memory returns before it is done, and our stream does not wait for it */
	GPU(g, cuCtxSynchronize, ());
}

/* Every other array begins an element further on than its memory, if that is asked for. */
static struct arrays make(
	const struct gpu *g, const struct rnea_info *info, const struct reference *r, size_t count, int is_shifted)
{
	struct arrays a = {.n = info->input_count + info->output_count, .count = count};
	size_t most = 0;

	for (size_t i = 0; i < a.n; i++) {
		size_t bytes = arrays_bytes(&info->arguments[i], count);

		a.shift[i] = is_shifted && i % 2 ? bytes / (info->arguments[i].rows * count) : 0;
		a.array[i] = gpu_array_new(g, bytes + a.shift[i]);
		a.array[i].data += a.shift[i];
		a.array[i].bytes = bytes;
		a.pointers[i] = (void *)(uintptr_t)a.array[i].data;
		most = bytes > most ? bytes : most;
	}
	if (!(a.host = malloc(most)))
		gpu_must(g, CUDA_ERROR_OUT_OF_MEMORY, "malloc", __FILE__, __LINE__);
	arrays_fill(g, &a, info, r);
	return a;
}

struct arrays arrays_new(const struct gpu *g, const struct rnea_info *info, const struct reference *r, size_t count)
{
	return make(g, info, r, count, 0);
}

struct arrays arrays_new_shifted(const struct gpu *g, const struct rnea_info *info, const struct reference *r, size_t count)
{
	return make(g, info, r, count, 1);
}

void arrays_free(const struct gpu *g, struct arrays *a)
{
	for (size_t i = 0; i < a->n; i++) {
		a->array[i].data -= a->shift[i];
		gpu_array_free(g, &a->array[i]);
	}
	free(a->host);
}

void check_torque(const struct gpu *g, struct item *it, const struct arrays *a, size_t tau, const struct reference *r,
	const char *what)
{
	const struct rnea_info *info = rnea_info(it->robot);
	int intact = gpu_array_read(g, &a->array[tau], a->host);
	struct difference d = samples_compare(&r->tau, a->host, a->count, info->precision, info->layout);

	if (!intact)
		item_fail(it, "%s, %zu samples: written outside of tau", what, a->count);
	if (!(d.scaled <= it->limit))
		item_fail(it, "%s, %zu samples: sample %zu is off by %.3g, the limit is %.3g", what, a->count, d.worst,
			d.scaled, it->limit);
	if (d.max > it->max_error)
		it->max_error = d.max;
	if (d.rms > it->rms_error)
		it->rms_error = d.rms;
}
