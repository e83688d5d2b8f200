#ifndef RNEAGEN_DUMP_H
#define RNEAGEN_DUMP_H
/* What --dump prints of a generation: what one of its passes has made. */

#include "passes/plans.h"

struct dumped {
	const struct analysis *analysis;
	const struct plans *plans;
};

typedef void dump_function(const struct dumped *d, struct text *out);

dump_function dump_robot, dump_scene, dump_tree, dump_params, dump_request, dump_dag, dump_plan, dump_parts, dump_segments,
	dump_limbs, dump_kernels;

#endif
