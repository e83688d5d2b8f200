#include "cuda/compile/compilation.h"

/* Whether `a` is to be had rather than `b`, of another block size. */
static int is_better(const struct compilation *a, const struct compilation *b, unsigned own)
{
	if (a->resident != b->resident)
		return a->resident > b->resident;
	if (a->block == own || b->block == own)
		return a->block == own;
	return a->block > b->block;
}

/* Whether another of the same block size is to be had rather than number i. */
static int is_beaten(const struct compilation *tried, size_t count, size_t i)
{
	for (size_t j = 0; j < count; j++)
		if (tried[j].block == tried[i].block &&
			(tried[j].spilled_bytes < tried[i].spilled_bytes ||
				(tried[j].spilled_bytes == tried[i].spilled_bytes && j < i)))
			return 1;
	return 0;
}

size_t compilation_best(const struct compilation *tried, size_t count, unsigned own)
{
	size_t best = count;

	for (size_t i = 0; i < count; i++)
		if (!is_beaten(tried, count, i) && (best == count || is_better(&tried[i], &tried[best], own)))
			best = i;
	return best;
}
