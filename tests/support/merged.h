#ifndef TESTS_MERGED_H
#define TESTS_MERGED_H
/* The tree of a robot and what is asked of it, with all held joints merged: no search for those that are better bodies. */

#include "passes/analysis.h"

/* All that the passes made is in `a`; errors are theirs. */
static inline enum rneagen_code merged_analysis(struct analysis **x, const struct robot *r,
	const struct rneagen_options *o, struct arena *a, struct rneagen_error *e)
{
	*x = arena_alloc(a, 1, sizeof **x);
	if (!*x)
		return error_memory(e);
	**x = (struct analysis){.robot = *r, .options = *o, .arena = a, .error = e};
	(*x)->options.file = o->file ? o->file : "<input>";
	return analysis_run(*x, PASS_SCENE_PARSE, PASS_SCENE_SELECT) ? e->code
		: analysis_run(*x, PASS_ROBOT_SNAP, PASS_REQUEST_RESOLVE);
}

/* Without a scene by the URDF's constants, which tests of trees are about. */
static inline enum rneagen_code merged_tree(struct tree *t, struct request *k, const struct robot *r,
	const struct rneagen_options *o, struct arena *a, struct rneagen_error *e)
{
	struct rneagen_options said = *o;
	struct analysis *x;

	*t = (struct tree){0};
	*k = (struct request){0};
	if (!said.scene)
		said.scene = "params urdf\n";
	if (merged_analysis(&x, r, &said, a, e))
		return e->code;
	*t = x->tree;
	*k = x->request;
	return RNEAGEN_OK;
}

#endif
