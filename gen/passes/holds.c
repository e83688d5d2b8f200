/* Which joints that the scene holds are merged with the body that carries them, and which are kept as fixed bodies of their own:
   where many bodies hang on a link that is turned by no right angle, each would take the turn for itself, and merging costs more
   operations than it saves. So nothing costs more for being held, by the URDF's constants. */
#include "passes/analysis.h"

/* More are kept or merged all together, and so are fewer where each try takes long: operations of all tries. */
enum { CANDIDATES = 32, WORK = 4000000 };

struct trials {
	const struct analysis *of;
	struct adjust adjust;
	struct selection_joint *joints; /* is_body: what is tried */
};

/* A turn by no right angle: others permute and negate, and cost nothing. */
static int is_candidate(const struct outcome_held *h)
{
	struct within s, c, angle = h->type == JOINT_PLANAR ? h->value[2] : h->value[0];

	if (h->type == JOINT_FLOATING)
		return h->value[3].x != 0 || h->value[4].x != 0 || h->value[5].x != 0;
	if (h->type == JOINT_PRISMATIC)
		return 0;
	angle_sincos(angle, &s, &c);
	return s.x != 0 && c.x != 0;
}

/* Operations of the torques as the joints are now; -1 and an error when memory runs out, or what is asked for is refused. */
static long cost(const struct trials *k)
{
	struct arena spare;
	struct analysis x;
	long flops = -1;

	arena_init(&spare, &k->of->arena->allocator);
	analysis_copy(&x, k->of, &spare, k->of->error);
	x.adjust = k->adjust;
	x.params.is_left = 1;
	if (!analysis_run(&x, PASS_ROBOT_SNAP, PASS_DAG_FUSE))
		flops = analysis_flops(&x);
	arena_free(&spare);
	return flops;
}

/* Turn each choice round, and leave it so where that is cheaper. Returns the least cost, -1 after an error. */
static long improve(const struct trials *k, const int *candidates, int count, long least)
{
	for (int i = 0; i < count && least >= 0; i++) {
		int *is_body = &k->joints[candidates[i]].is_body;
		long flops;

		*is_body = !*is_body;
		flops = cost(k);
		if (flops < 0 || flops >= least)
			*is_body = !*is_body;
		least = flops < 0 ? -1 : flops < least ? flops : least;
	}
	return least;
}

/* How many of `count` joints are tried one by one. */
static int tried(int count, long flops)
{
	return count <= CANDIDATES && count * flops <= WORK ? count : 0;
}

/* From all merged on, and, where that is dearer than all bodies, from there on. */
static enum rneagen_code choose(
	const struct trials *k, const int *held, int held_count, const int *candidates, int count, int *best)
{
	long merged = cost(k), bodies;

	merged = improve(k, candidates, tried(count, merged), merged);
	if (merged < 0)
		return k->of->error->code;
	for (int i = 0; i < held_count; i++) {
		best[i] = k->joints[held[i]].is_body;
		k->joints[held[i]].is_body = 1;
	}
	bodies = cost(k);
	if (bodies >= 0 && bodies < merged)
		bodies = improve(k, held, tried(held_count, bodies), bodies);
	for (int i = 0; i < held_count && bodies >= merged; i++)
		k->joints[held[i]].is_body = best[i];
	return k->of->error->code;
}

enum rneagen_code pass_holds_choose(struct analysis *a)
{
	const struct outcome *x = &a->outcome;
	struct trials k = {.of = a, .adjust = a->adjust, .joints = a->selection.joints};
	size_t most = (size_t)x->held_count;
	int *held, *candidates, *best, count = 0;

	if (!x->held_count)
		return RNEAGEN_OK;
	held = arena_alloc(a->arena, most, sizeof *held);
	candidates = arena_alloc(a->arena, most, sizeof *candidates);
	best = arena_alloc(a->arena, most, sizeof *best);
	if (!held || !candidates || !best)
		return error_memory(a->error);
	for (int i = 0; i < x->held_count; i++) {
		held[i] = x->held[i].joint;
		if (is_candidate(&x->held[i]))
			candidates[count++] = held[i];
	}
	k.adjust.prune = 0; /* its sampling takes long, and does not depend on this */
	return choose(&k, held, x->held_count, candidates, count, best);
}
