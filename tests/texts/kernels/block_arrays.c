#include "block_arrays.h"
#include "support/rng.h"
#include <stdlib.h>
#include <string.h>

static size_t place(const struct arrays *x, size_t i, size_t sample, size_t row)
{
	return x->a[i].per_batch ? row : x->aos ? sample * x->a[i].rows + row : row * COUNT + sample;
}

double arrays_get(const struct arrays *x, size_t i, size_t sample, size_t row)
{
	size_t at = place(x, i, sample, row);

	return x->a[i].scalar == RNEA_F64 ? ((const double *)x->data[i])[at] : (double)((const float *)x->data[i])[at];
}

static void arrays_set(const struct arrays *x, size_t i, size_t sample, size_t row, double value)
{
	size_t at = place(x, i, sample, row);

	if (x->a[i].scalar == RNEA_F64)
		((double *)x->data[i])[at] = value;
	else
		((float *)x->data[i])[at] = (float)value;
}

void arrays_spoil(struct arrays *x)
{
	for (size_t i = x->inputs; i < x->count; i++)
		memset(x->data[i], 0xff, COUNT * x->a[i].rows * sizeof(double));
}

void arrays_new(struct arrays *x, const struct rnea_info *info)
{
	struct rng rng = rng_seed(SEED);

	*x = (struct arrays){.count = info->input_count + info->output_count,
		.inputs = info->input_count,
		.aos = info->layout == RNEA_AOS};
	for (size_t i = 0; i < x->count; i++) {
		x->a[i] = info->arguments[i];
		x->data[i] = calloc(COUNT * x->a[i].rows, sizeof(double));
		x->expected[i] = calloc(COUNT * x->a[i].rows, sizeof(double));
		for (size_t k = 0; k < COUNT && i < x->inputs; k++)
			for (size_t r = 0; r < x->a[i].rows; r++)
				arrays_set(x, i, k, r, (double)(float)rng_uniform(&rng, 0.1, 2));
	}
	arrays_spoil(x);
}

void arrays_free(struct arrays *x)
{
	for (size_t i = 0; i < x->count; i++) {
		free(x->data[i]);
		free(x->expected[i]);
	}
}
