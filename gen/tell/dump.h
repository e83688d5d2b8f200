#ifndef RNEAGEN_DUMP_H
#define RNEAGEN_DUMP_H
/* What --dump prints of a generation: what one of its passes has made. */

#include "passes/analysis.h"
#include "plan/grid/relay.h"

struct dumped {
	const struct analysis *analysis;
	const struct function *functions; /* function_count of them, the main one first */
	int function_count;
	const struct part *parts;
	int part_count;
	const struct relay *relay; /* NULL: there is none */
	const struct part *rounds; /* whose limbs serve small batches; NULL: the function's do */
};

typedef void dump_function(const struct dumped *d, struct text *out);

dump_function dump_robot, dump_scene, dump_tree, dump_params, dump_request, dump_dag, dump_plan, dump_parts, dump_segments,
	dump_limbs;

#endif
