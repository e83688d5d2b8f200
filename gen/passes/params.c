/* Which constants the model is computed by: the URDF's, or base inertial parameters in frames of their own, chosen by counted
   operations. */
#include "passes/analysis.h"
#include "passes/frames.h"
#include <string.h>
#include <stdio.h>
#include <stdlib.h>

struct search {
	const struct analysis *of;
	struct restatement *by; /* by body */
	char *keeps;            /* by body: nothing goes to its parent */
	struct adjust adjust;
	struct tree now;
	struct arena now_arena;
	long least;
	int trials;
};

/* Operations of the torques, or of what is asked for; -1 and an error. */
static long cost(const struct analysis *a, const struct tree *t, const struct adjust *adjust)
{
	struct arena spare;
	struct analysis x;
	long flops = -1;

	arena_init(&spare, &a->arena->allocator);
	analysis_copy(&x, a, &spare, a->error);
	x.tree = *t;
	x.adjust = *adjust;
	if (!analysis_run(&x, PASS_REQUEST_RESOLVE, PASS_DAG_FUSE))
		flops = analysis_flops(&x);
	arena_free(&spare);
	return flops;
}

static long try(struct search *s)
{
	struct arena spare;
	struct tree t;
	long flops = -1;

	arena_init(&spare, &s->of->arena->allocator);
	s->trials++;
	if (tree_restate(&t, &s->of->stated, s->by, &spare))
		flops = cost(s->of, &t, &s->adjust);
	else
		error_memory(s->of->error);
	arena_free(&spare);
	return flops;
}

static int take(struct search *s)
{
	arena_free(&s->now_arena);
	arena_init(&s->now_arena, &s->of->arena->allocator);
	return tree_restate(&s->now, &s->of->stated, s->by, &s->now_arena);
}

static int improve(struct search *s, int body, const struct frames *f)
{
	struct restatement best = s->by[body];
	int found = 0;

	for (int i = 0; i < f->count; i++) {
		long flops;

		s->by[body] = f->of[i];
		flops = try(s);
		if (flops < 0)
			return -1;
		if (flops < s->least) {
			s->least = flops;
			best = f->of[i];
			found = 1;
		}
	}
	s->by[body] = best;
	if (found && !take(s))
		return -1;
	return found;
}

static int improve_regroup(struct search *s, int body)
{
	struct frames f = {.count = 0};

	for (int i = 0; i < REGROUP_COUNT; i++)
		if (i != (int)s->by[body].regroup && (!s->keeps[body] || !i)) {
			f.of[f.count] = s->by[body];
			f.of[f.count++].regroup = (enum regroup)i;
		}
	return improve(s, body, &f);
}

static int sweep(struct search *s)
{
	struct frames f;
	int found = 0;

	for (int b = s->now.body_count - 1; b >= 0; b--) {
		frames_turned(&f, &s->now, s->by, b);
		found |= improve(s, b, &f) > 0;
		frames_split(&f, &s->now, s->by, b);
		found |= improve(s, b, &f) > 0;
		frames_slid(&f, &s->now, s->by, b);
		found |= improve(s, b, &f) > 0;
		found |= improve_regroup(s, b) > 0;
	}
	return found;
}

enum rneagen_code pass_params_choose(struct analysis *a)
{
	const struct scene_choice *c = scene_next(&a->scene, SCENE_PARAMS, NULL);
	struct search s = {.of = a, .adjust = a->adjust};
	size_t n = (size_t)a->tree.body_count;

	if (!c || !strcmp(c->value, "urdf"))
		return RNEAGEN_OK;
	s.by = arena_alloc(a->arena, n, sizeof *s.by);
	s.keeps = arena_alloc(a->arena, n, 1);
	for (size_t i = 0; i < n; i++)
		s.by[i] = (struct restatement){.turn = TURN_NONE, .ahead = TURN_NONE, .regroup = REGROUP_SECOND};
	s.adjust.prune = 0;
	take(&s);
	s.least = try(&s);
	if (getenv("P_TRACE"))
		fprintf(stderr, "urdf %ld regrouped %ld\n", cost(a, &a->stated, &s.adjust), s.least);
	if (!getenv("P_NOFRAMES"))
		for (int i = 0; i < 4; i++) {
			int found = sweep(&s);

			if (getenv("P_TRACE"))
				fprintf(stderr, "sweep %d: %ld after %d trials\n", i, s.least, s.trials);
			if (!found)
				break;
		}
	if (!tree_restate(&a->tree, &a->stated, s.by, a->arena))
		return error_memory(a->error);
	arena_free(&s.now_arena);
	return a->error->code;
}
