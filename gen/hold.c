#include "hold.h"
#include "analysis.h"
#include <math.h>
#include <string.h>

/* More are kept or merged all together, and so are fewer where each try takes long: operations of all tries. */
enum { CANDIDATES = 32, WORK = 4000000 };

struct keeping {
	const struct robot *r;
	const struct rneagen_options *o;
	struct arena *a;
	struct rneagen_error *e;
	struct adjust adjust;
	char *kept; /* by joint: what is tried */
};

/* A turn by no right angle: others permute and negate, and cost nothing. */
static int is_candidate(const struct tree_held *h)
{
	struct within s, c, angle = h->type == JOINT_PLANAR ? h->value[2] : h->value[0];

	if (h->type == JOINT_FLOATING)
		return h->value[3].x != 0 || h->value[4].x != 0 || h->value[5].x != 0;
	if (h->type == JOINT_PRISMATIC)
		return 0;
	angle_sincos(angle, &s, &c);
	return s.x != 0 && c.x != 0;
}

/* Operations of the torques with these joints kept; -1 and an error when memory runs out. */
static long cost(const struct keeping *k)
{
	struct arena spare;
	struct tree t;
	struct dag d;
	long flops = -1;

	arena_init(&spare, &k->a->allocator);
	if (!tree_build_adjusted(&t, k->r, k->o, &k->adjust, &spare, k->e) && analysis_dag(&d, &t, k->o->strict, &spare))
		flops = analysis_flops(&d);
	if (flops < 0)
		error_memory(k->e);
	arena_free(&spare);
	return flops;
}

/* Turn each choice round, and leave it so where that is cheaper. Returns the least cost, -1 when memory runs out. */
static long improve(struct keeping *k, const int *candidates, int count, long least)
{
	for (int i = 0; i < count && least >= 0; i++) {
		char *kept = &k->kept[candidates[i]];
		long flops;

		*kept = !*kept;
		flops = cost(k);
		if (flops < 0 || flops >= least)
			*kept = !*kept;
		least = flops < 0 ? -1 : flops < least ? flops : least;
	}
	return least;
}

/* How many of `count` joints are tried one by one. */
static int tried(int count, long flops)
{
	return count <= CANDIDATES && count * flops <= WORK ? count : 0;
}

/* From all merged on, and, where that is dearer than all kept, from there on. */
static enum rneagen_code choose(struct keeping *k, const struct tree *t, const int *candidates, int count)
{
	int *all = arena_alloc(k->a, (size_t)t->held_count, sizeof *all);
	char *best = arena_alloc(k->a, (size_t)k->r->joint_count, 1);
	long merged = cost(k), kept;

	merged = improve(k, candidates, tried(count, merged), merged);
	if (merged < 0 || !best || !all)
		return error_memory(k->e);
	memcpy(best, k->kept, (size_t)k->r->joint_count);
	for (int i = 0; i < t->held_count; i++) {
		all[i] = t->held[i].joint;
		k->kept[all[i]] = 1;
	}
	kept = cost(k);
	if (kept >= 0 && kept < merged)
		kept = improve(k, all, tried(t->held_count, kept), kept);
	if (kept < 0)
		return k->e->code;
	if (kept >= merged)
		memcpy(k->kept, best, (size_t)k->r->joint_count);
	return RNEAGEN_OK;
}

enum rneagen_code keep_build(struct tree *t, const struct robot *r, const struct rneagen_options *o, struct arena *a,
	struct rneagen_error *e)
{
	struct keeping k = {.r = r, .o = o, .a = a, .e = e};
	int *candidates, count = 0;

	if (tree_build(t, r, o, a, e) || !t->held_count)
		return e->code;
	candidates = arena_alloc(a, (size_t)t->held_count, sizeof *candidates);
	k.kept = arena_alloc(a, (size_t)r->joint_count, 1);
	if (!candidates || !k.kept)
		return error_memory(e);
	for (int i = 0; i < t->held_count; i++)
		if (is_candidate(&t->held[i]))
			candidates[count++] = t->held[i].joint;
	k.adjust = t->adjust;
	k.adjust.kept = k.kept;
	k.adjust.drop = 0; /* its sampling takes long, and does not depend on this */
	if (choose(&k, t, candidates, count))
		return e->code;
	k.adjust.drop = t->adjust.drop;
	return tree_build_adjusted(t, r, o, &k.adjust, a, e);
}
