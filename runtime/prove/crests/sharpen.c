#define _POSIX_C_SOURCE 200809L
#include "prove/crests/sharpen.h"
#include "core/seconds.h"
#include "prove/weights.h"
#include <math.h>
#include <stdlib.h>

enum { FEW = 6 };
#define STILL 0.8 /* of what it was */

/* Many that are quick first, then fewer that lose less: a part of the time, and how long one may take. */
#define SHARE_FIRST 0.4
#define QUICK_FIRST 0.3
#define QUICK 0.02
#define SLOWER 3 /* then */
#define LATE 1.2 /* of the time for crests: those that are not there then are left out */

static void take_known(const struct sharpening *s)
{
	double *most = s->view->values.most;

	for (uint32_t i = 0; i < s->x->count; i++) {
		uint32_t at = s->x->value[i].i;

		most[at] = at ? fmin(most[at], s->known[i]) : most[at];
	}
}

/* All outputs are made of the same values, but each of its own derivatives. */
static void make_known(const struct sharpening *s, uint32_t node, double most)
{
	for (uint32_t i = 0; i < s->x->count; i++) {
		double now = s->known[i];

		while (s->x->value[i].i == node && most < now &&
			!atomic_compare_exchange_weak(&s->known[i], &now, most))
			;
	}
}

static int find_peaks(const struct sharpening *s, struct peaks *p, double seconds)
{
	struct view *v = s->view;
	double *terms;

	*p = (struct peaks){.text = s->text,
		.output = s->output,
		.x = s->x,
		.norms = &v->norms,
		.values = &v->values,
		.rows = s->rows,
		.position = s->position,
		.dims = s->dims,
		.dim_count = s->dim_count,
		.deadline = fmin(s->effort->deadline, seconds_now() + seconds),
		.arena = s->arena};
	if (!(terms = s->terms(s->context)) || !weights_find(p, v, terms) || !peaks_find(p) || !crests_sample(p))
		return 0;
	for (size_t i = 0; i < p->count; i++) {
		double *most = p->list[i].pair ? &v->values.most_norm[p->list[i].pair - 1]
					       : &v->values.most[p->list[i].nodes[0]];

		*most = fmin(*most, p->list[i].most);
	}
	return 1;
}

/* Those that are still as large as they were when they were chosen; a few at once, so that others know of them soon. */
static int find_few(const struct sharpening *s, const struct crests *c, struct crest *list, size_t count)
{
	double *most = s->view->values.most;
	size_t left = 0;
	int done;

	take_known(s);
	s->error(s->context);
	for (size_t i = 0; i < count; i++)
		if (s->view->values.size[list[i].node] > STILL * list[i].before)
			list[left++] = list[i];
	done = crests_find(c, list, left);
	for (size_t i = 0; i < left && done; i++) {
		most[list[i].node] = fmin(most[list[i].node], list[i].most);
		make_known(s, list[i].node, list[i].most);
	}
	return done;
}

/* Outputs that are worked on at the same time ask about the same values: each second one begins at the end. */
static int find_all(const struct sharpening *s, const struct crests *c, struct crest *list, size_t count)
{
	size_t parts = (count + FEW - 1) / FEW;
	int done = 1;

	for (size_t i = 0; i < parts && done; i++) {
		size_t first = FEW * (s->output % 2 ? parts - 1 - i : i);

		done = find_few(s, c, list + first, count - first < FEW ? count - first : FEW);
	}
	return done;
}

static int find_crests(const struct sharpening *s, const struct peaks *p, double seconds, double quick, double slower,
	double close)
{
	const struct crests_choice choice = {p, &s->view->values, s->error, s->context, seconds, quick, slower, close};
	struct effort own = *s->effort;
	const struct crests c = {s->relaxed, p, &own};
	struct crest *list = malloc((2 * p->count + 1) * sizeof *list);
	size_t count;
	int done;

	if (!list)
		return 0;
	own.deadline = fmin(own.deadline, seconds_now() + LATE * seconds);
	count = crests_choose(&choice, list);
	for (size_t i = 0; i < count; i++)
		list[i].before = s->view->values.size[list[i].node];
	done = find_all(s, &c, list, count);
	free(list);
	return done;
}

int sharpen(const struct sharpening *s, double of_peaks, double of_crests)
{
	const double first = SHARE_FIRST * of_crests, rest = of_crests - first;
	struct peaks p;

	take_known(s);
	return find_peaks(s, &p, of_peaks) && find_crests(s, &p, first, fmin(QUICK_FIRST, QUICK * first), 1, 2) &&
	       find_crests(s, &p, rest, SLOWER * QUICK * rest, SLOWER, 1.6);
}
