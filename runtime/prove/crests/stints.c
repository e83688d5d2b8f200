#include "prove/crests/stints.h"
#include "norms/adjoint.h"
#include <math.h>
#include <stdlib.h>

/* Nodes make more to look at, each of which takes longer and is known less well. */
static double work_of(const struct dag *d, size_t output)
{
	struct arena own;
	struct adjoint x;
	double work;

	arena_init(&own, NULL);
	work = adjoint_make(&x, d, output, 1, &own) ? pow((double)x.d.count, 3) : 0;
	arena_free(&own);
	return work;
}

static int by_work(const void *a, const void *b)
{
	const struct stint *x = a, *y = b;

	return (x->work < y->work) - (x->work > y->work);
}

struct stint *stints_make(const struct dag *d, double equally, unsigned threads, double seconds, struct arena *arena)
{
	struct stint *list = arena_alloc(arena, d->output_count + 1, sizeof *list);
	double sum = 0;

	for (size_t o = 0; o < d->output_count && list; o++) {
		list[o] = (struct stint){o, work_of(d, o), seconds};
		sum += list[o].work;
	}
	for (size_t o = 0; o < d->output_count && list && sum > 0; o++)
		list[o].seconds =
			seconds *
			fmin(1, threads * (equally / (double)d->output_count + (1 - equally) * list[o].work / sum));
	if (list)
		qsort(list, d->output_count, sizeof *list, by_work);
	return list;
}
