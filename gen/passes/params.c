/* Which constants the model is computed by: the URDF's inertias in its frames, or base parameters in frames of their own. */
#include "passes/analysis.h"
#include "passes/search.h"
#include "tree/lumps.h"
#include <string.h>

/* Where the scene says nothing, base parameters are taken if they need less than this share of the operations by the URDF's
   constants: where less is saved, measured times go either way (gen/scene/README.md), and a text in the URDF's frames is easier
   to follow. */
static const double WORTH_IT = 0.925;

/* The same of gradients of torques in doubles, whose texts are longer than the instruction cache: atlas saves 7.4 %. */
static const double WORTH_IT_LONG = 0.93;

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

static double worth_of(const struct request *k, const struct rneagen_options *o)
{
	int has_gradients = request_wants(k, WANT_DTAU_DQ) || request_wants(k, WANT_DTAU_DQD);

	return has_gradients && o->precision == RNEAGEN_F64 ? WORTH_IT_LONG : WORTH_IT;
}

/* What is read of a joint's wrench, or is an input of a body's inertia, is the body's own; what is dropped at the ground has a
   mass, and a potential. And what base parameters must save. */
static enum rneagen_code look_at_request(const struct analysis *a, char *keeps, double *worth)
{
	struct arena spare;
	struct analysis x;
	const struct request *k = &x.request;

	arena_init(&spare, &a->arena->allocator);
	analysis_copy(&x, a, &spare, a->error);
	if (!pass_request_resolve(&x)) {
		*worth = worth_of(k, &a->options);
		for (int i = 0; i < k->freed_count; i++)
			if (k->freed[i].columns)
				keeps[k->freed[i].body] = 1;
		for (int i = 0; i < k->want_count; i++)
			if (k->wants[i].kind == WANT_WRENCH)
				keeps[k->wants[i].body] = 1;
		for (int i = 0; i < a->tree.body_count; i++) {
			int parent = a->tree.bodies[i].parent;

			if ((request_wants(k, WANT_POTENTIAL) || request_wants_any(k, OF_MASSES)) && lumps_is_held(&a->tree, parent))
				keeps[i] = 1;
		}
	}
	arena_free(&spare);
	return a->error->code;
}

/* Base parameters, where they take less than this share of the operations by the URDF's; 0: however many. */
static enum rneagen_code choose(struct analysis *a, const struct tree *base, double share)
{
	struct params_choice *p = &a->params;

	p->is_auto = share > 0;
	p->is_base = 1;
	if (p->is_auto) {
		p->flops[0] = cost(a, &a->stated);
		p->flops[1] = p->flops[0] < 0 ? -1 : cost(a, base);
		p->is_base = p->flops[1] >= 0 && (double)p->flops[1] < share * (double)p->flops[0];
	}
	if (p->is_base)
		a->tree = *base;
	return a->error->code;
}

/* Does the URDF stand without a trial? Also where constants are to have few digits: sums of them have many again. */
static int is_by_urdf(const struct analysis *a, const struct scene_choice *said)
{
	return a->params.is_left || (said ? !strcmp(said->value, "urdf") : a->adjust.digits != 0);
}

enum rneagen_code pass_params_choose(struct analysis *a)
{
	const struct scene_choice *said = scene_next(&a->scene, SCENE_PARAMS, NULL);
	size_t bodies = (size_t)a->tree.body_count;
	struct restatement *restated;
	struct tree base;
	double worth = WORTH_IT;
	char *keeps;

	if (is_by_urdf(a, said))
		return RNEAGEN_OK;
	restated = arena_alloc(a->arena, bodies, sizeof *restated);
	keeps = arena_alloc(a->arena, bodies, 1);
	if (!restated || !keeps)
		return error_memory(a->error);
	if (look_at_request(a, keeps, &worth) || search_params(restated, &a->stated, keeps, &a->arena->allocator, a->error))
		return a->error->code;
	if (!tree_restate(&base, &a->stated, restated, a->arena))
		return error_memory(a->error);
	return choose(a, &base, !said ? worth : !strcmp(said->value, "auto"));
}
