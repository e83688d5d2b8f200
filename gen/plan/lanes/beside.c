/* What a call of one sample runs where a compiler has vectors of four numbers: legs in the lanes, or else coordinates. */
#include "plan/lanes/lanes.h"
#include "dynamics/registry.h"

/* Operations, of lanes one for all, over those without, in percent. */
enum { WORTH_PERCENT = 95 };

/* Accelerations and their derivatives. The bits of a call are then not those of a batch: torques promise that. */
static int may_have_lanes(const struct request *k, const struct rneagen_options *o)
{
	for (int i = 0; i < k->want_count; i++)
		if (k->wants[i].kind != WANT_QDD && k->wants[i].kind != WANT_DQDD_DQ && k->wants[i].kind != WANT_DQDD_DQD)
			return 0;
	return k->is_forward && !k->refine_steps && o->segments == RNEAGEN_SEGMENTS_AUTO && !o->strict && !o->bounded &&
		(o->precision == RNEAGEN_F32 || o->precision == RNEAGEN_F64);
}

/* Limbs side by side. Returns 0 where none are alike. */
static int build_limbs(struct dag *d, const struct pass *p, const struct request *k)
{
	struct alike limbs;
	struct tree told;
	struct dag raw;

	if (!tree_alike(&limbs, &told, p->plan.tree, d->arena))
		return 0;
	dag_init(&raw, d->arena);
	if (!p->single)
		p->algorithm->build(&raw, &told, k);
	else if (!algorithm_build_looped(&raw, &told, k, LOOPED_SINGLE))
		return 0;
	lanes_of_twins(d, &raw, &limbs);
	return 1;
}

/* The pass once more; *is_built where lanes serve it. 0 when memory runs out. */
static int make_pass(struct pass *s, const struct pass *p, const struct request *k, struct arena *a, int *is_built)
{
	struct arena spare;
	struct dag raw;

	arena_init(&spare, &a->allocator);
	dag_init(&raw, &spare);
	*is_built = build_limbs(&raw, p, k) || (p->single && algorithm_build_looped(&raw, p->plan.tree, k, LOOPED_LANES));
	dag_init(&s->dag, a);
	if (*is_built)
		dag_fuse(&s->dag, &raw, 0);
	a->failed |= spare.failed;
	arena_free(&spare);
	return !a->failed && (!*is_built || (!s->dag.failed && plan_build(&s->plan, &s->dag, p->plan.tree, a)));
}

/* Loops over columns are told what goes across as numbers. */
static int loops_read_lanes(const struct pass *s)
{
	for (int k = s->segments.count - s->dag.loop_count; k < s->segments.count; k++) {
		const struct plan *lines = &s->segments.plans[k];

		for (const struct line *l = lines->lines; l < lines->lines + lines->line_count; l++)
			if (l->kind == LINE_FETCH && s->dag.nodes[l->value.i].is_wide)
				return 1;
	}
	return 0;
}

static unsigned count_operations(const struct pass *p)
{
	struct operation_count n = plan_operations(&p->plan);

	return n.mul + n.add + n.sub + n.fma;
}

static int is_worth_it(const struct pass *s, const struct pass *other)
{
	return s->segments.count && 100 * count_operations(s) <= WORTH_PERCENT * count_operations(other) && !loops_read_lanes(s) &&
		plan_operations(&s->plan).sincos == plan_operations(&other->plan).sincos; /* the tables of sines are the whole's */
}

static int make_beside(struct pass *p, const struct request *k, const struct rneagen_options *o, struct arena *a)
{
	struct algorithm *x = arena_alloc(a, 1, sizeof *x);
	struct pass *s = arena_alloc(a, 1, sizeof *s);
	int is_built;

	if (!p->segments.count || !may_have_lanes(k, o))
		return !a->failed;
	if (!x || !s || !make_pass(s, p, k, a, &is_built) || !is_built)
		return !a->failed;
	*x = *p->algorithm;
	x->name = "fd_beside";
	s->algorithm = x;
	if (!segments_choose(s, SEGMENT_LOOPS, k, o, a))
		return 0;
	if (is_worth_it(s, p->single ? p->single : p))
		p->beside = s;
	return 1;
}

int lanes_single(struct pass *p, const struct request *k, const struct rneagen_options *o, struct arena *a)
{
	return segments_single(p, k, o, a) && make_beside(p, k, o, a);
}
