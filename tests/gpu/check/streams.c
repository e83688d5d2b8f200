/* Two streams at once: one robot over different data, and two robots. */
#include "arrays.h"

enum { ROUNDS = 10 };

struct side {
	struct item *item;
	struct reference reference;
	struct arrays arrays;
	CUstream stream;
};

/* The samples from `first` on; the memory stays that of `r`. */
static struct reference reference_part(const struct reference *r, size_t first)
{
	struct reference part = *r;
	struct samples *all[] = {&part.q, &part.qd, &part.qdd, &part.tau};

	for (int i = 0; i < 4; i++) {
		all[i]->values += first * all[i]->rows;
		all[i]->count -= first;
	}
	return part;
}

static struct side side_new(const struct gpu *g, struct item *it, struct reference r)
{
	struct side s = {.item = it, .reference = r};

	s.arrays = arrays_new(g, rnea_info(it->robot), &r, r.q.count);
	GPU(g, cuStreamCreate, (&s.stream, CU_STREAM_NON_BLOCKING));
	return s;
}

static void side_close(const struct gpu *g, struct side *s, const char *what)
{
	GPU(g, cuStreamSynchronize, (s->stream));
	check_torque(g, s->item, &s->arrays, s->arrays.n - 1, &s->reference, what);
	GPU(g, cuStreamDestroy, (s->stream));
	arrays_free(g, &s->arrays);
}

/* Both launch in turns and neither waits; then both are right. */
static void run_beside(const struct gpu *g, struct item *it, const struct reference *r, struct item *partner,
	const struct reference *partner_r)
{
	struct side sides[] = {
		side_new(g, it, *r), side_new(g, partner, reference_part(partner_r, partner_r->q.count / 3))};
	struct rnea_error e;

	for (int i = 0; i < 2 * ROUNDS; i++) {
		struct side *s = &sides[i % 2];

		if (rnea_launch(s->item->robot, s->arrays.pointers, s->arrays.count, s->stream, &e) != RNEA_OK)
			item_fail(s->item, "on two streams: %s", e.message);
	}
	for (int i = 0; i < 2; i++)
		side_close(g, &sides[i], it == partner ? "one robot on two streams" : "two robots on two streams");
}

void verify_streams(const struct gpu *g, struct item *it, const struct reference *r, struct item *partner,
	const struct reference *partner_r)
{
	run_beside(g, it, r, it, r);
	if (partner_r)
		run_beside(g, it, r, partner, partner_r);
}
