#include "analysis.h"
#include <string.h>

static enum rneagen_code build(struct analysis *a, int strict, struct rneagen_error *e)
{
	struct dag raw;

	dag_init(&raw, &a->arena);
	ALGORITHMS[PASS_RNEA].build(&raw, &a->tree);
	dag_init(&a->dag, &a->arena);
	dag_fuse(&a->dag, &raw, strict);
	return raw.failed || a->dag.failed ? error_memory(e) : RNEAGEN_OK;
}

enum rneagen_code analysis_open(struct analysis *a, const char *urdf, size_t length, const struct rneagen_options *o,
	struct rneagen_error *e)
{
	const char *file = o->file ? o->file : "<input>";

	*a = (struct analysis){0};
	*e = (struct rneagen_error){0};
	arena_init(&a->arena, o->allocator);
	if (robot_read(&a->robot, urdf, length, file, &a->arena, e) || tree_build(&a->tree, &a->robot, o, &a->arena, e) ||
		build(a, o->strict, e)) {
		analysis_free(a);
		return e->code;
	}
	tree_warn(&a->tree, &a->robot, file, &a->arena);
	if (a->arena.failed) {
		error_memory(e);
		analysis_free(a);
	}
	return e->code;
}

void analysis_free(struct analysis *a)
{
	arena_free(&a->arena);
	*a = (struct analysis){0};
}

const struct joint *analysis_joint(const struct analysis *a, int i)
{
	for (int k = 0; k < a->robot.joint_count; k++)
		if (!strcmp(a->robot.joints[k].name, a->tree.joints[i].name))
			return &a->robot.joints[k];
	return NULL;
}
