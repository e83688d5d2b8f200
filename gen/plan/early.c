/* A section's outputs stand at its end. On a processor what waits for that is kept in memory, and fetched again. */
#include "plan/early.h"
#include "plan/readings.h"

static const uint32_t NONE = UINT32_MAX;

struct mover {
	const struct plan *p;
	struct readings r;
	uint32_t end;           /* where loops begin */
	uint32_t *first, *next; /* by line: the first store that follows it, and of a store the next one there; NONE: there is none */
};

static int begins_loops(const struct plan *p, const struct line *l)
{
	return l->kind == LINE_SECTION && p->dag->sections[l->index].kind == SECTION_COLUMNS;
}

/* The last line that makes what a store reads; NONE: the line stays where it is. */
static uint32_t place_of(const struct mover *m, uint32_t line)
{
	uint32_t place = NONE;

	if (line >= m->end || m->p->lines[line].kind != LINE_STORE)
		return NONE;
	for (uint32_t i = m->r.begin[line]; i < m->r.begin[line + 1]; i++) {
		uint32_t made = m->r.made[m->r.list[i].node];

		place = place == NONE || made > place ? made : place;
	}
	return place;
}

/* Stores in their order behind the lines that they follow. */
static void find_places(struct mover *m)
{
	uint32_t lines = (uint32_t)m->p->line_count;

	while (m->end < lines && !begins_loops(m->p, &m->p->lines[m->end]))
		m->end++;
	for (uint32_t i = 0; i < lines; i++)
		m->first[i] = m->next[i] = NONE;
	for (uint32_t i = m->end; i-- > 0;) {
		uint32_t place = place_of(m, i);

		if (place == NONE)
			continue;
		m->next[i] = m->first[place];
		m->first[place] = i;
	}
}

static void add(struct plan *to, const struct line *l)
{
	/* a section without lines has nothing to say */
	if (l->kind == LINE_SECTION && to->line_count && to->lines[to->line_count - 1].kind == LINE_SECTION)
		to->line_count--;
	to->lines[to->line_count++] = *l;
}

static void write(const struct mover *m, struct plan *to)
{
	for (uint32_t i = 0; i < m->p->line_count; i++) {
		if (place_of(m, i) == NONE)
			add(to, &m->p->lines[i]);
		for (uint32_t k = m->first[i]; k != NONE; k = m->next[k])
			add(to, &m->p->lines[k]);
	}
}

int plan_store_early(struct plan *early, const struct plan *p, struct arena *a)
{
	struct mover m = {.p = p, .first = arena_alloc(a, p->line_count, sizeof *m.first),
		.next = arena_alloc(a, p->line_count, sizeof *m.next)};

	*early = *p;
	early->line_count = 0;
	early->lines = arena_take(a, p->line_count, sizeof *early->lines);
	if (!readings_make(&m.r, p, a) || a->failed)
		return 0;
	find_places(&m);
	write(&m, early);
	readings_free(&m.r, a);
	arena_release(a, m.next);
	arena_release(a, m.first);
	return !a->failed;
}
