/* A section's outputs stand at its end. On a processor what waits for that is kept in memory, and fetched again. */
#include "plan/early.h"
#include "plan/order.h"
#include "plan/segments.h"

/* A section without lines has nothing to say. */
static void add(struct plan *to, const struct line *l)
{
	if (l->kind == LINE_SECTION && to->line_count && to->lines[to->line_count - 1].kind == LINE_SECTION)
		to->line_count--;
	to->lines[to->line_count++] = *l;
}

int plan_early(struct plan *early, const struct plan *p, struct arena *a)
{
	struct orderer x = {.p = p, .t = p->tree};
	struct arena spare;

	*early = *p;
	early->line_count = 0;
	early->lines = arena_take(a, p->line_count, sizeof *early->lines);
	arena_init(&spare, &a->allocator);
	if (early->lines && order_begin(&x, &spare)) {
		order_write_early(&x, segments_next_loop(p, 0));
		for (uint32_t i = 0; i < x.count; i++)
			add(early, &p->lines[x.order[i]]);
	}
	a->failed |= spare.failed;
	arena_free(&spare);
	return !a->failed;
}
