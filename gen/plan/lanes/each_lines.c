/* Lines of loops over limbs: those of a loop stand together, after what they take. */
#include "plan/lanes/each.h"
#include "plan/readings.h"

int each_of_line(const struct function *p, const struct line *l)
{
	const struct node *n = &p->dag.nodes[l->value.i];

	if (!p->loops || l->kind == LINE_SECTION)
		return 0;
	return p->loops->loop[l->kind == LINE_VALUE && n->op >= OP_LANE0 ? n->arg[0].i : l->value.i];
}

struct gatherer {
	const struct function *p;
	struct readings r;
	uint32_t *left;          /* by line: loops whose lanes it takes, at once or not, by bits */
	unsigned char *is_taken; /* by line: one to be written before a loop */
	unsigned char *done;
	size_t *section;         /* by line: the line of the section that it is in; line_count: none */
	struct line *lines;
	size_t count, section_now;
	int is_apart; /* no loop takes what another one has left */
};

static uint32_t bit_of(int loop)
{
	return (uint32_t)1 << loop;
}

/* Operands stand before their users. */
static void find_left(struct gatherer *g)
{
	const struct plan *p = &g->p->plan;
	size_t section = p->line_count;

	for (uint32_t i = 0; i < p->line_count; i++) {
		int loop = each_of_line(g->p, &p->lines[i]);

		section = p->lines[i].kind == LINE_SECTION ? i : section;
		g->section[i] = section;
		for (uint32_t k = g->r.begin[i]; k < g->r.begin[i + 1]; k++) {
			uint32_t made = g->r.made[g->r.list[k].node];
			int other = each_of_line(g->p, &p->lines[made]);

			g->left[i] |= g->left[made] | (other && other != loop ? bit_of(other) : 0);
			if (other && other == loop && g->p->dag.nodes[g->r.list[k].node].op >= OP_LANE0)
				g->left[i] |= bit_of(loop); /* one turn's number in another */
		}
	}
}

static void write(struct gatherer *g, uint32_t line)
{
	const struct plan *p = &g->p->plan;
	size_t section = g->section[line];

	if (section != g->section_now && section < p->line_count)
		g->lines[g->count++] = p->lines[section];
	g->section_now = section;
	g->lines[g->count++] = p->lines[line];
	g->done[line] = 1;
}

/* What a loop takes and is not written yet, and then the loop's own lines. */
static void write_loop(struct gatherer *g, int loop)
{
	const struct plan *p = &g->p->plan;

	for (uint32_t i = (uint32_t)p->line_count; i-- > 0;)
		if (g->is_taken[i] || each_of_line(g->p, &p->lines[i]) == loop)
			for (uint32_t k = g->r.begin[i]; k < g->r.begin[i + 1]; k++)
				g->is_taken[g->r.made[g->r.list[k].node]] = 1;
	for (int is_own = 0; is_own < 2; is_own++)
		for (uint32_t i = 0; i < p->line_count; i++)
			if (!g->done[i] && (is_own ? each_of_line(g->p, &p->lines[i]) == loop : g->is_taken[i] && !each_of_line(g->p, &p->lines[i])))
				write(g, i);
}

/* Loops that one takes something of, and whether it is there. */
static uint32_t loops_before(const struct gatherer *g, int loop)
{
	uint32_t before = 0;

	for (uint32_t i = 0; i < g->p->plan.line_count; i++)
		if (each_of_line(g->p, &g->p->plan.lines[i]) == loop)
			before |= g->left[i];
	return before;
}

/* Returns 0 where no order of the loops serves. */
static int write_loops(struct gatherer *g, int loops)
{
	uint32_t written = 0;

	for (int turn = 0; turn < loops; turn++) {
		int next = 1;

		while (next <= loops && (written & bit_of(next) || loops_before(g, next) & ~written))
			next++;
		if (next > loops)
			return 0;
		g->is_apart &= !loops_before(g, next);
		write_loop(g, next);
		written |= bit_of(next);
	}
	for (uint32_t i = 0; i < g->p->plan.line_count; i++)
		if (!g->done[i] && g->p->plan.lines[i].kind != LINE_SECTION)
			write(g, i);
	return 1;
}

int each_gather(int *serves, int *is_apart, struct function *p, struct arena *spare, struct arena *a)
{
	size_t lines = p->plan.line_count;
	struct gatherer g = {.p = p, .left = arena_alloc(spare, lines, sizeof *g.left), .is_taken = arena_alloc(spare, lines, 1),
		.done = arena_alloc(spare, lines, 1), .section = arena_alloc(spare, lines, sizeof *g.section),
		.lines = arena_take(a, 2 * lines, sizeof *g.lines), .section_now = lines, .is_apart = 1};

	if (!readings_make(&g.r, &p->plan, spare) || spare->failed || a->failed)
		return 0;
	find_left(&g);
	*serves = write_loops(&g, p->loops->count);
	*is_apart = g.is_apart;
	p->plan.lines = g.lines;
	p->plan.line_count = g.count;
	return 1;
}

struct operation_count each_operations(const struct function *p)
{
	struct operation_count sum = {0};

	for (size_t i = 0; i < p->dag.count; i++)
		plan_add_operations(&sum, plan_operations_of(&p->dag, i, i + 1), p->loops->loop[i] ? (unsigned)p->loops->limbs : 1);
	for (const struct line *l = p->plan.lines; l < p->plan.lines + p->plan.line_count; l++)
		if (l->kind == LINE_SINCOS)
			sum.sincos += each_of_line(p, l) ? (unsigned)p->loops->limbs : 1;
	sum.wide = 0;
	return sum;
}
