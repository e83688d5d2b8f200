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
	return k->is_forward && !k->refine_steps && segments_may_differ(o);
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

static int build(struct dag *d, const struct pass *p, const struct request *k)
{
	return build_limbs(d, p, k) || (p->single && algorithm_build_looped(d, p->plan.tree, k, LOOPED_LANES));
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
	return s->segments.count && 100 * count_operations(s) <= WORTH_PERCENT * count_operations(other) && !loops_read_lanes(s);
}

/* p->beside, for a pass in segments. */
static int make_beside(struct pass *p, const struct request *k, const struct rneagen_options *o, struct arena *a)
{
	struct pass *s;

	if (!segments_once_more(&s, p, build, "fd_beside", k, o, a))
		return 0;
	if (s && is_worth_it(s, p->single ? p->single : p))
		p->beside = s;
	return 1;
}

int lanes_single(struct pass *p, const struct request *k, const struct rneagen_options *o, struct arena *a)
{
	int is_whole;

	if (!segments_single(p, k, o, a) || !segments_many(p, k, o, a))
		return 0;
	if (!may_have_lanes(k, o))
		return !a->failed;
	is_whole = !p->segments.count;
	if (is_whole && !segments_choose(p, SEGMENT_AGAIN, k, o, a))
		return 0;
	if (p->segments.count && !make_beside(p, k, o, a))
		return 0;
	if (is_whole && !p->beside)
		p->segments = (struct segments){0};
	return 1;
}
