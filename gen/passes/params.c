/* Which constants the model is computed by: the URDF's inertias in its frames, or base parameters in frames of their own. */
#include "passes/analysis.h"
#include "passes/search.h"
#include "tree/lumps.h"
#include <string.h>

/* Operations of what is asked for, of a tree; -1 and an error. */
static long cost(const struct analysis *a, const struct tree *t)
{
	struct arena spare;
	struct analysis x;
	long flops = -1;

	arena_init(&spare, &a->arena->allocator);
	analysis_copy(&x, a, &spare, a->error);
	x.tree = *t;
	x.adjust.prune = 0; /* its sampling takes long */
	if (!analysis_run(&x, PASS_REQUEST_RESOLVE, PASS_DAG_FUSE))
		flops = analysis_flops(&x);
	arena_free(&spare);
	return flops;
}

/* What is read of a joint's wrench, or is an input of a body's inertia, is the body's own; what is dropped at the ground has a
   mass, and a potential. */
static enum rneagen_code find_kept(const struct analysis *a, char *keeps)
{
	struct arena spare;
	struct analysis x;
	const struct request *k = &x.request;

	arena_init(&spare, &a->arena->allocator);
	analysis_copy(&x, a, &spare, a->error);
	if (!pass_request_resolve(&x)) {
		for (int i = 0; i < k->freed_count; i++)
			if (k->freed[i].kind != FREED_GRAVITY && k->freed[i].kind != FREED_OFFSET)
				keeps[k->freed[i].body] = 1;
		for (int i = 0; i < k->want_count; i++)
			if (k->wants[i].kind == WANT_WRENCH)
				keeps[k->wants[i].body] = 1;
		for (int i = 0; i < a->tree.body_count; i++) {
			int parent = a->tree.bodies[i].parent;

			if ((request_wants(k, WANT_POTENTIAL) && parent < 0) ||
				(request_wants_any(k, OF_MASSES) && lumps_is_held(&a->tree, parent)))
				keeps[i] = 1;
		}
	}
	arena_free(&spare);
	return a->error->code;
}

/* The cheaper of both for what is asked for. */
static enum rneagen_code choose(struct analysis *a, const struct tree *base, int is_auto)
{
	struct params_choice *p = &a->params;

	p->is_auto = is_auto;
	p->is_base = 1;
	if (is_auto) {
		p->flops[0] = cost(a, &a->stated);
		p->flops[1] = p->flops[0] < 0 ? -1 : cost(a, base);
		p->is_base = p->flops[1] >= 0 && p->flops[1] < p->flops[0];
	}
	if (p->is_base)
		a->tree = *base;
	return a->error->code;
}

enum rneagen_code pass_params_choose(struct analysis *a)
{
	const struct scene_choice *c = scene_next(&a->scene, SCENE_PARAMS, NULL);
	size_t bodies = (size_t)a->tree.body_count;
	struct restatement *by;
	struct tree base;
	char *keeps;

	if (!c || !strcmp(c->value, "urdf") || a->params.is_left)
		return RNEAGEN_OK;
	by = arena_alloc(a->arena, bodies, sizeof *by);
	keeps = arena_alloc(a->arena, bodies, 1);
	if (!by || !keeps)
		return error_memory(a->error);
	if (find_kept(a, keeps) || search_params(by, &a->stated, keeps, &a->arena->allocator, a->error))
		return a->error->code;
	if (!tree_restate(&base, &a->stated, by, a->arena))
		return error_memory(a->error);
	return choose(a, &base, !strcmp(c->value, "auto"));
}
