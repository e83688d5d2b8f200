#include "analysis.h"
#include "hold.h"
#include "plan/plan.h"
#include <string.h>

int analysis_dag(struct dag *d, const struct tree *t, int strict, struct arena *a)
{
	struct dag raw;
	int good;

	dag_init(&raw, a);
	ALGORITHMS[0]->build(&raw, t);
	dag_close(&raw);
	dag_init(d, a);
	dag_fuse(d, &raw, strict);
	good = !raw.failed && !d->failed;
	dag_free(&raw);
	return good;
}

long analysis_flops(const struct dag *d)
{
	const struct plan p = {.dag = d}; /* without lines: sines and cosines are not counted */

	return d->failed ? -1 : (long)plan_flops(plan_operations(&p));
}

enum rneagen_code analysis_open(struct analysis *a, const char *urdf, size_t length, const struct rneagen_options *o,
	struct rneagen_error *e)
{
	const char *file = o->file ? o->file : "<input>";

	*a = (struct analysis){0};
	*e = (struct rneagen_error){0};
	arena_init(&a->arena, o->allocator);
	if (robot_read(&a->robot, urdf, length, file, &a->arena, e) || keep_build(&a->tree, &a->robot, o, &a->arena, e) ||
		!analysis_dag(&a->dag, &a->tree, o->strict, &a->arena)) {
		error_memory(e); /* if nothing else */
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
