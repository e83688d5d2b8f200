/* One after the other: what lowers the error most for the time that it takes, as if its magnitude became close to what
 * is found. */
#define _POSIX_C_SOURCE 200809L
#include "prove/crests/crests.h"
#include "core/seconds.h"
#include "prove/crests/frontier.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

#define CLOSE 1.4		   /* over what was found at points, about */
#define WORTH 1e-3		   /* of the error */
#define SECONDS_OF_A_STEP 4e-10    /* of all crests of a field, at a knot, for each number */
#define SECONDS_OF_A_NUMBER 1.5e-6 /* at a knot that is left */
#define SHARE 0.2		   /* of the time, to choose */
#define OF_TIME 0.8		   /* crests take longer than is thought */
#define MOST_STRETCH 4

/* One node, or the two of a pair. */
struct candidate {
	struct peak *peak;
	double cost, gain; /* seconds; of the error, for a second */
};

struct choosing {
	const struct crests_choice *c;
	struct candidate *list;
	struct peak *peaks; /* of the list */
	double *sizes;      /* with nothing taken */
	double error, deadline; /* error: with what is taken */
};

/* Numbers beside those at knots, and crests of a field, about. */
enum { OTHERS = 9, TOGETHER = 3 };

/* More rows of q are too many even where some are cut; such ones never take less than so many seconds. */
enum { MOST_ROWS = 12 };
#define CUT_LEAST 0.12

/* As large as it is thought to come out. */
static double close_to(const struct choosing *h, const struct peak *k)
{
	return (k->cut ? h->c->close : CLOSE) * k->found;
}

static int nodes_of(const struct peak *k)
{
	return k->pair ? 2 : 1;
}

static double cost_of(const struct choosing *h, const struct peak *k)
{
	const struct peaks *p = h->c->p;
	double together = fmin(TOGETHER, crests_together(p, k));
	double cost = SECONDS_OF_A_STEP * k->steps * crests_numbers(k) * crests_knots(p, k, 0) / together +
		      SECONDS_OF_A_NUMBER * (crests_numbers(k) + OTHERS) * crests_knots(p, k, 1);

	return nodes_of(k) * (k->cut ? CUT_LEAST + h->c->slower * cost : cost);
}

/* The error if it were close; is_kept: it is taken to be. */
static double error_if(const struct choosing *h, const struct peak *k, int is_kept)
{
	double *most = h->c->values->most, before[2] = {most[k->nodes[0]], most[k->nodes[1]]}, error;

	for (int i = 0; i < 2; i++)
		most[k->nodes[i]] = fmin(before[i], close_to(h, k));
	error = h->c->error(h->c->context);
	for (int i = 0; i < 2 && !is_kept; i++)
		most[k->nodes[i]] = before[i];
	return error;
}

/* When the time is over what was known of it counts. */
static double gain_of(const struct choosing *h, const struct candidate *k)
{
	if (seconds_now() > h->deadline || !isfinite(k->cost))
		return k->gain;
	return fmax(0, h->error - error_if(h, k->peak, 0)) / k->cost;
}

static double fitting_cost(const struct choosing *h, struct peak *k)
{
	return frontier_count(h->c->p, k) && crests_fit(h->c->p, k) ? cost_of(h, k) : (double)INFINITY;
}

/* Without the fewest of its first rows of q, which are those nearest the base, so that it is quick enough; else as it is
   quickest. */
static double cut_rows(const struct choosing *h, struct peak *k)
{
	uint64_t dims = k->dims;
	double cost = fitting_cost(h, k), least = cost;
	struct peak best = *k;

	if (__builtin_popcountll(dims) > MOST_ROWS)
		return least;
	for (uint64_t left = dims & (dims - 1); left & (left - 1) && !(cost < h->c->quick); left &= left - 1) {
		k->cut = dims & ~left;
		k->dims = left;
		cost = fitting_cost(h, k);
		if (cost < least) {
			least = cost;
			best = *k;
		}
	}
	*k = best;
	return least;
}

static int by_weight(const void *a, const void *b)
{
	const struct peak *x = a, *y = b;

	return (x->weight < y->weight) - (x->weight > y->weight);
}

/* Is it far from what it is thought to come to? `error` has changed the sizes: these were before. */
static int is_far(const struct choosing *h, const struct peak *k, double close)
{
	return k->weight > 0 && crests_are_known(k) && fmax(h->sizes[k->nodes[0]], h->sizes[k->nodes[1]]) > close;
}

/* Those that matter most first: the time may not be enough for all. */
static size_t list_all(struct choosing *h)
{
	const struct peaks *p = h->c->p;
	size_t count = 0;

	memcpy(h->peaks, p->list, p->count * sizeof *h->peaks);
	qsort(h->peaks, p->count, sizeof *h->peaks, by_weight);
	for (size_t i = 0; i < p->count && seconds_now() < h->deadline; i++) {
		struct peak *k = &h->peaks[i];
		double cost = is_far(h, k, CLOSE * k->found) ? cut_rows(h, k) : (double)INFINITY;

		if (!isfinite(cost) || !is_far(h, k, close_to(h, k)))
			continue;
		h->list[count] = (struct candidate){k, cost, 0};
		h->list[count].gain = gain_of(h, &h->list[count]);
		count++;
	}
	return count;
}

/* The best of those from `first` on, to that place. Gains grow less as others are taken: one that is known anew and
   still the largest is the best. */
static void put_best(struct choosing *h, size_t first, size_t count)
{
	for (;;) {
		size_t best = first;
		struct candidate k;
		double next = 0;

		for (size_t i = first + 1; i < count; i++)
			best = h->list[i].gain > h->list[best].gain ? i : best;
		k = h->list[best];
		h->list[best] = h->list[first];
		for (size_t i = first + 1; i < count; i++)
			next = fmax(next, h->list[i].gain);
		k.gain = gain_of(h, &k);
		h->list[first] = k;
		if (k.gain >= next)
			return;
	}
}

/* Takes them as if they were close; to the front. */
static size_t take(struct choosing *h, size_t count)
{
	double left = h->c->seconds;
	size_t taken = 0;

	while (taken < count) {
		struct candidate *k = &h->list[taken];

		put_best(h, taken, count);
		if (!(k->gain > 0))
			break;
		if (k->cost > left || !(k->gain * k->cost > WORTH * h->error)) {
			k->cost = (double)INFINITY;
			k->gain = 0;
			continue;
		}
		left -= k->cost;
		h->error = error_if(h, k->peak, 1);
		taken++;
	}
	return taken;
}

/* Each node once. */
static size_t put_nodes(const struct choosing *h, size_t taken, struct crest *list)
{
	size_t count = 0;

	for (size_t i = 0; i < taken; i++)
		for (int n = 0; n < nodes_of(h->list[i].peak); n++) {
			uint32_t node = h->list[i].peak->nodes[n];
			size_t at = 0;

			while (at < count && list[at].node != node)
				at++;
			if (at == count)
				list[count++] = (struct crest){h->list[i].peak, node,
					h->list[i].cost / nodes_of(h->list[i].peak), (double)INFINITY, 0};
		}
	return count;
}

/* Where little is worth it, that gets more of the time. */
static void stretch(double seconds, struct crest *list, size_t count)
{
	double sum = 0, by;

	for (size_t i = 0; i < count; i++)
		sum += list[i].cost;
	by = sum > 0 ? fmin(MOST_STRETCH, fmax(1, OF_TIME * seconds / sum)) : 1;
	for (size_t i = 0; i < count; i++)
		list[i].cost *= by;
}

size_t crests_choose(const struct crests_choice *c, struct crest *list)
{
	size_t count = c->p->x->d.count, size = count * sizeof(double), put = 0;
	double *caps = malloc(size);
	struct choosing h = {c, malloc((c->p->count + 1) * sizeof *h.list),
		arena_alloc(c->p->arena, c->p->count + 1, sizeof *h.peaks), malloc(size), c->error(c->context),
		seconds_now() + SHARE * c->seconds};

	if (h.list && h.peaks && h.sizes && caps && isfinite(h.error)) {
		memcpy(h.sizes, c->values->size, size);
		memcpy(caps, c->values->most, size);
		put = put_nodes(&h, take(&h, list_all(&h)), list);
		memcpy(c->values->most, caps, size);
		c->error(c->context); /* values are again what is known of them, and no guess */
	}
	stretch(c->seconds, list, put);
	free(caps);
	free(h.sizes);
	free(h.list);
	return put;
}
