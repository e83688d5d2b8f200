#include "plan/segments.h"
#include "plan/readings.h"
#include "plan/stage.h"

/* Cuts are looked for in stretches of a segment's greatest length / WINDOWS, in each where the fewest values are alive. */
enum { WINDOWS = 16 };

static const uint64_t IMPOSSIBLE = UINT64_MAX;

struct cutter {
	const struct plan *p;
	struct readings readings;
	const struct segment_limits *limits;
	unsigned most_across;
	struct arena *a;
	uint32_t *alive;     /* by line, and at the end: values that cross a cut before it */
	uint32_t *places;    /* lines before which a cut may be: the first, ..., the number of lines */
	uint64_t *cost;      /* by place: of all that stands before a cut there */
	uint32_t *from;      /* by place: where the segment begins that ends there */
	size_t place_count;
	uint32_t loop;       /* the line at which the DAG's loops begin, each a segment; without them, the number of lines */
	uint32_t *cuts;      /* as chosen, from the first line to the number of lines */
	size_t cut_count;
	int *slot;           /* by node: where it crosses; -1: it does not */
	uint32_t *seen;      /* by node: 1 + the segment that has it */
};

/* It is read again where it is needed; but a loop over coordinates on their way back to the base fetches it as it does values. */
static int is_read_again(const struct cutter *c, uint32_t node)
{
	const struct node *n = &c->p->dag->nodes[node];

	return n->op == OP_INPUT && (n->arg[0].i >= DAG_COLUMN || c->readings.last[node] < c->loop || !dag_loops_go_back(c->p->dag));
}

/* ---- where a cut may be ---- */

static void count_alive(struct cutter *c)
{
	size_t lines = c->p->line_count;
	uint32_t alive = 0, *change = c->alive;

	for (size_t i = 0; i < c->p->dag->count; i++)
		if (c->p->names[i] && !is_read_again(c, (uint32_t)i)) {
			change[c->readings.made[i] + 1]++;
			change[c->readings.last[i] + 1]--; /* modulo 2^32 */
		}
	for (size_t i = 0; i <= lines; i++)
		c->alive[i] = alive += change[i];
}

static void add_place(struct cutter *c, uint32_t line)
{
	if (!c->place_count || c->places[c->place_count - 1] < line)
		c->places[c->place_count++] = line;
}

uint32_t segments_next_loop(const struct plan *p, uint32_t i)
{
	const struct line *l = p->lines;

	while (i < p->line_count && (l[i].kind != LINE_SECTION || !dag_section_loops(&p->dag->sections[l[i].index])))
		i++;
	return i;
}

static void find_places(struct cutter *c)
{
	uint32_t lines = (uint32_t)c->p->line_count, best = 0, passed = 0;

	add_place(c, 0);
	for (uint32_t i = 1; i < c->loop; i++) {
		passed += c->readings.weight[i - 1];
		if (!best || c->alive[i] < c->alive[best])
			best = i;
		if (passed >= c->limits->operations / WINDOWS) {
			add_place(c, best);
			best = passed = 0;
		}
	}
	for (uint32_t i = c->loop; i < lines; i = segments_next_loop(c->p, i + 1))
		add_place(c, i);
	add_place(c, lines);
}

/* ---- where the cuts are ---- */

/* A segment as it grows: its operations, what it fetches, and of what it makes the values that are still to be read. */
struct growing {
	uint32_t begin, operations, fetched, open;
};

static void grow(const struct cutter *c, struct growing *g, uint32_t line)
{
	const struct readings *r = &c->readings;
	struct ref made[2];

	g->operations += r->weight[line];
	for (uint32_t i = r->begin[line]; i < r->begin[line + 1]; i++) {
		uint32_t node = r->list[i].node;
		int is_own = !is_read_again(c, node) && r->made[node] >= g->begin;

		g->fetched += !is_own && (r->list[i].previous < g->begin || r->list[i].previous == r->made[node]);
		g->open -= is_own && r->last[node] == line;
	}
	for (int k = readings_made(c->p, &c->p->lines[line], made); k-- > 0;)
		g->open += !is_read_again(c, made[k].i) && r->last[made[k].i] > line;
}

/* All segments that begin at the place. */
static void begin_at(struct cutter *c, size_t place)
{
	struct growing g = {.begin = c->places[place]};

	for (size_t end = place + 1; end < c->place_count && (c->places[end] <= c->loop || end == place + 1); end++) {
		for (uint32_t i = c->places[end - 1]; i < c->places[end]; i++)
			grow(c, &g, i);
		if (g.operations > c->limits->operations && end > place + 1)
			return;
		if (c->alive[c->places[end]] > c->most_across)
			continue;
		uint64_t cost = c->cost[place] + g.fetched + g.open + c->limits->overhead;
		if (cost < c->cost[end]) {
			c->cost[end] = cost;
			c->from[end] = (uint32_t)place;
		}
	}
}

/* By dynamic programming over the places. Returns whether there is a way within the limits. */
static int find_ways(struct cutter *c)
{
	size_t last = c->place_count - 1;

	for (size_t i = 1; i <= last; i++)
		c->cost[i] = IMPOSSIBLE;
	for (size_t i = 0; i < last; i++)
		if (c->cost[i] != IMPOSSIBLE)
			begin_at(c, i);
	return c->cost[last] != IMPOSSIBLE;
}

static void choose_cuts(struct cutter *c)
{
	size_t last = c->place_count - 1;

	if (!find_ways(c)) {
		c->most_across = UINT32_MAX;
		find_ways(c);
	}
	for (size_t i = last; i; i = c->from[i])
		c->cut_count++;
	c->cuts = arena_alloc(c->a, c->cut_count + 1, sizeof *c->cuts);
	if (!c->cuts)
		return;
	for (size_t i = last, k = c->cut_count;; i = c->from[i]) {
		c->cuts[k] = c->places[i];
		if (k-- == 0)
			return;
	}
}

/* ---- slots ---- */

/* The last segment that reads a value, the first for its line. */
static size_t segment_of(const struct cutter *c, uint32_t line)
{
	size_t first = 0, end = c->cut_count;

	while (end - first > 1) {
		size_t middle = (first + end) / 2;

		if (c->cuts[middle] <= line)
			first = middle;
		else
			end = middle;
	}
	return first;
}

/* A slot is free again in the segment after the last that fetches from it. */
static void choose_slots(struct cutter *c, int slots[2])
{
	size_t count = c->p->dag->count;
	uint32_t *free_from[2] = {arena_alloc(c->a, count, sizeof **free_from), arena_alloc(c->a, count, sizeof **free_from)};
	struct ref made[2];

	if (c->a->failed)
		return;
	for (uint32_t i = 0; i < c->p->line_count; i++)
		for (int k = 0, n = readings_made(c->p, &c->p->lines[i], made); k < n; k++) {
			uint32_t node = made[k].i;
			size_t begin = segment_of(c, i), end = segment_of(c, c->readings.last[node]);
			int is_wide = c->p->dag->nodes[node].is_wide, slot = 0;

			if (is_read_again(c, node) || begin == end)
				continue;
			while (slot < slots[is_wide] && free_from[is_wide][slot] > begin)
				slot++;
			free_from[is_wide][slot] = (uint32_t)end + 1;
			slots[is_wide] += slot == slots[is_wide];
			c->slot[node] = slot;
		}
	arena_release(c->a, free_from[1]);
	arena_release(c->a, free_from[0]);
}

/* ---- the segments' lines ---- */

/* What the line reads and the segment has not yet. */
static void add_readings(const struct cutter *c, struct plan *p, uint32_t line, uint32_t segment)
{
	for (uint32_t i = c->readings.begin[line]; i < c->readings.begin[line + 1]; i++) {
		struct ref x = {c->readings.list[i].node};

		if (c->seen[x.i] == segment + 1)
			continue;
		c->seen[x.i] = segment + 1;
		if (is_read_again(c, x.i))
			plan_add_line(p, LINE_INPUT, x, 0);
		else
			plan_add_line(p, LINE_FETCH, x, (size_t)c->slot[x.i]);
	}
}

static int is_way(const struct cutter *c, uint32_t first)
{
	const struct line *l = &c->p->lines[first];

	return l->kind == LINE_SECTION && c->p->dag->sections[l->index].kind == SECTION_WAY;
}

/* What a coordinate carries is all read before the first of it is written anew. */
static void add_carried(const struct cutter *c, struct plan *p, uint32_t first, uint32_t end, uint32_t segment)
{
	const struct readings *r = &c->readings;

	if (!is_way(c, first))
		return;
	for (uint32_t i = r->begin[first]; i < r->begin[end]; i++) {
		struct ref x = {r->list[i].node};

		if (is_read_again(c, x.i) && c->seen[x.i] != segment + 1) {
			c->seen[x.i] = segment + 1;
			plan_add_line(p, LINE_INPUT, x, 0);
		}
	}
}

static void add_line(const struct cutter *c, struct plan *p, uint32_t line, uint32_t segment)
{
	const struct line *l = &c->p->lines[line];
	struct ref made[2];
	int count = readings_made(c->p, l, made);

	if (l->kind == LINE_INPUT && is_read_again(c, l->value.i))
		return;
	add_readings(c, p, line, segment);
	p->lines[p->line_count++] = *l;
	for (int k = 0; k < count; k++) {
		c->seen[made[k].i] = segment + 1;
		if (c->slot[made[k].i] >= 0 && segment_of(c, c->readings.last[made[k].i]) > segment)
			plan_add_line(p, LINE_KEEP, made[k], (size_t)c->slot[made[k].i]);
	}
}

static size_t most_lines(const struct cutter *c, uint32_t first, uint32_t end)
{
	return 3 * (size_t)(end - first) + c->readings.begin[end] - c->readings.begin[first];
}

static void make_plans(struct cutter *c, struct segments *s)
{
	s->plans = arena_alloc(c->a, c->cut_count, sizeof *s->plans);
	for (uint32_t k = 0; k < c->cut_count && s->plans; k++) {
		uint32_t first = c->cuts[k], end = c->cuts[k + 1];
		struct plan *p = &s->plans[k];

		*p = *c->p;
		p->line_count = 0;
		p->lines = arena_take(c->a, most_lines(c, first, end), sizeof *p->lines);
		if (p->lines)
			add_carried(c, p, first, end, k);
		for (uint32_t i = first; i < end && p->lines; i++)
			add_line(c, p, i, k);
	}
	s->count = (int)c->cut_count;
}

int segments_make(struct segments *s, const struct plan *p, const struct segment_limits *limits, struct arena *a)
{
	size_t lines = p->line_count, nodes = p->dag->count;
	struct cutter c = {.p = p, .limits = limits, .most_across = limits->across, .loop = segments_next_loop(p, 0), .a = a};

	*s = (struct segments){0};
	c.alive = arena_alloc(a, lines + 2, sizeof *c.alive);
	c.places = arena_alloc(a, lines + 1, sizeof *c.places);
	c.cost = arena_alloc(a, lines + 1, sizeof *c.cost);
	c.from = arena_alloc(a, lines + 1, sizeof *c.from);
	c.slot = arena_alloc(a, nodes, sizeof *c.slot);
	c.seen = arena_alloc(a, nodes, sizeof *c.seen);
	if (!readings_make(&c.readings, p, a) || a->failed)
		return 0;
	for (size_t i = 0; i < nodes; i++)
		c.slot[i] = -1;
	count_alive(&c);
	find_places(&c);
	choose_cuts(&c);
	if (a->failed)
		return 0;
	choose_slots(&c, s->slots);
	s->carried = dag_loops_go_back(p->dag) && p->dag->rooms[0].is_batch ? p->dag->arguments[p->dag->rooms[0].argument].rows : 0;
	make_plans(&c, s);
	readings_free(&c.readings, a);
	arena_release(a, c.seen);
	arena_release(a, c.slot);
	arena_release(a, c.from);
	arena_release(a, c.cost);
	arena_release(a, c.places);
	arena_release(a, c.alive);
	return !a->failed;
}

static void put_segment(const struct function *p, int k, struct text *out)
{
	const struct plan *lines = &p->segments.plans[k];
	int fetched = 0, kept = 0;

	for (size_t i = 0; i < lines->line_count; i++) {
		fetched += lines->lines[i].kind == LINE_FETCH;
		kept += lines->lines[i].kind == LINE_KEEP;
	}
	text_printf(out, "%s segment %d: %u lines, %d values fetched, %d kept\n", p->algorithm->name, k,
		(unsigned)lines->line_count, fetched, kept);
}

int segments_reads_input(const struct plan *segment)
{
	for (const struct line *l = segment->lines; l < segment->lines + segment->line_count; l++)
		if (l->kind == LINE_INPUT && segment->dag->nodes[l->value.i].arg[0].i < DAG_COLUMN)
			return 1;
	return 0;
}

int segments_bytes(const struct segments *s, const struct rneagen_options *o, int is_wide)
{
	int number = stage_arithmetic_bytes(o), bytes = s->slots[0] * number + (is_wide ? s->slots[1] * (int)sizeof(double) : 0);

	return bytes ? bytes : number;
}

void segments_dump(const struct function *p, struct text *out)
{
	const struct segments *s = &p->segments;

	if (!s->count)
		text_printf(out, "%s whole: %u lines\n", p->algorithm->name, (unsigned)p->plan.line_count);
	for (int k = 0; k < s->count; k++)
		put_segment(p, k, out);
	if (s->count)
		text_printf(out, "%s: %d values across, and %d wide ones\n", p->algorithm->name, s->slots[0], s->slots[1]);
	if (p->many)
		segments_dump(p->many, out);
	if (p->single)
		segments_dump(p->single, out);
}
