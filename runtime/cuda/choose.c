#include "cuda/choose.h"

/* Whether `a` is to be had rather than `b`, of another block size. */
static int is_better(const struct choice *a, const struct choice *b, unsigned own)
{
	if (a->resident != b->resident)
		return a->resident > b->resident;
	if (a->block == own || b->block == own)
		return a->block == own;
	return a->block > b->block;
}

/* Whether another choice of the same block size is to be had rather than choice i. */
static int is_beaten(const struct choice *choices, size_t count, size_t i)
{
	for (size_t j = 0; j < count; j++)
		if (choices[j].block == choices[i].block &&
			(choices[j].local_bytes < choices[i].local_bytes ||
				(choices[j].local_bytes == choices[i].local_bytes && j < i)))
			return 1;
	return 0;
}

size_t choose_best(const struct choice *choices, size_t count, unsigned own)
{
	size_t best = count;

	for (size_t i = 0; i < count; i++)
		if (!is_beaten(choices, count, i) && (best == count || is_better(&choices[i], &choices[best], own)))
			best = i;
	return best;
}
