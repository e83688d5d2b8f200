/* What a call of one sample runs where a compiler has vectors: limbs in the lanes, or else coordinates. */
#include "plan/lanes/lanes.h"
#include "dynamics/registry.h"

/* Operations, of lanes one for all, over those without, in percent; how many are saved at least. Zen 5, saved operations and
   times: upkie, torques 50, 1.14, qdd 80, 1.06; a hand, torques 223, 0.83. */
enum { WORTH_PERCENT = 95, LEAST_SAVED = 120 };

/* Torques, accelerations, and their derivatives: nothing that is told in the frame of a link. A call's last bits are then not
   those of a batch. */
static int may_have_lanes(const struct request *k, const struct rneagen_options *o)
{
	for (int i = 0; i < k->want_count; i++)
		if (!want_is(k->wants[i].kind, IS_TORQUES | IS_DERIVATIVE | FINDS_QDD | IS_PRODUCT) ||
			want_is(k->wants[i].kind, OF_LINK | OF_JOINT))
			return 0;
	return !k->refine_steps && segments_may_differ(o);
}

/* So many limbs side by side. Returns 0 where none are alike. */
static int build_limbs(struct dag *d, const struct function *p, const struct request *k, int count)
{
	struct alike limbs;
	struct tree told;
	struct dag raw;

	if (!tree_alike(&limbs, &told, p->plan.tree, count, !k->freed_count && !k->push_count, d->arena))
		return 0;
	dag_init(&raw, d->arena);
	if (!p->single)
		p->algorithm->build(&raw, &told, k);
	else if (!algorithm_build_looped(&raw, &told, k, LOOPED_SINGLE))
		return 0;
	raw.width = count;
	lanes_of_twins(d, &raw, &told, &limbs);
	return 1;
}

static int build_four(struct dag *d, const struct function *p, const struct request *k)
{
	return build_limbs(d, p, k, 4);
}

static int build_two(struct dag *d, const struct function *p, const struct request *k)
{
	return build_limbs(d, p, k, 2);
}

static int build_coordinates(struct dag *d, const struct function *p, const struct request *k)
{
	return p->single && algorithm_build_looped(d, p->plan.tree, k, LOOPED_LANES);
}

/* Loops over columns are told what goes across as numbers. */
static int loops_read_lanes(const struct function *s)
{
	for (int k = s->segments.count - s->dag.loop_count; k < s->segments.count; k++) {
		const struct plan *lines = &s->segments.plans[k];

		for (const struct line *l = lines->lines; l < lines->lines + lines->line_count; l++)
			if (l->kind == LINE_FETCH && s->dag.nodes[l->value.i].is_wide)
				return 1;
	}
	return 0;
}

static unsigned count_operations(const struct function *p)
{
	return plan_instructions(plan_operations(&p->plan));
}

static int is_worth_it(const struct function *s, const struct function *other)
{
	unsigned own = count_operations(s), others = count_operations(other);

	return 100 * own <= (unsigned)WORTH_PERCENT * others && own + LEAST_SAVED <= others;
}

/* What a call takes without. */
static const struct function *other_than(const struct function *p)
{
	return p->single ? p->single : p;
}

static const char *name_of(const struct function *p, struct arena *a)
{
	return text_format(a, "%s_beside", p->algorithm->name);
}

/* p->beside: of all ways the one with the fewest operations. A header has no functions for loops over columns. */
static int make_beside(struct function *p, const struct request *k, const struct rneagen_options *o, int is_header,
	struct arena *a)
{
	static segments_build *const builds[] = {build_four, build_two, build_coordinates};
	const char *name = name_of(p, a);

	for (size_t i = 0; i < sizeof builds / sizeof *builds; i++) {
		struct function *s;

		if (!segments_once_more(&s, p, builds[i], name, k, o, a))
			return 0;
		if (s && !(is_header && s->dag.loop_count) && !loops_read_lanes(s) && is_worth_it(s, other_than(p)) &&
			(!p->beside || count_operations(s) < count_operations(p->beside)))
			p->beside = s;
	}
	p->lanes_in_batches = p->beside && p->segments.count && k->is_forward;
	return !a->failed;
}

int lanes_single(struct function *p, const struct request *k, const struct rneagen_options *o, int is_header, struct arena *a)
{
	if (!segments_single(p, k, o, a) || (!o->only && !segments_many(p, k, o, a)))
		return 0;
	if (!may_have_lanes(k, o) || (p->single && dag_loops_go_back(&p->single->dag)))
		return !a->failed;
	return make_beside(p, k, o, is_header, a);
}
