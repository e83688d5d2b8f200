#ifndef TESTS_BENCH_SIX_OPERATIONS_H
#define TESTS_BENCH_SIX_OPERATIONS_H
/* One spatial operation of one robot as a text of its own, through the generator's DAG, plan and emitter: what a call of
   such a small function costs beside the whole algorithm. */

#include "rneagen.h"

/* With twists v, accelerations a and wrenches f linear then angular, in the URDF frame of a body's link. The body is the
   last one whose joint turns about or slides along an axis; S is that joint's axis, I the body's inertia. Featherstone,
   Rigid Body Dynamics Algorithms, 2008, 2.31 to 2.33. */
enum operation {
	OPERATION_CROSS_OPERATOR, /* v[6] -> crm[36] = [[w], [v]; 0, [w]], row by row */
	OPERATION_MXS,            /* v[6], qd[1] -> a[6] = v x S qd */
	OPERATION_VXIV,           /* v[6] -> f[6] = v x* I v */
	OPERATION_COUNT
};

/* "cross_operator", "mxS", "vxIv" */
extern const char *const OPERATION_NAMES[OPERATION_COUNT];

/* The text for a URDF, in the arena. Its functions are those that the whole algorithm's text has for it, named
   NAME_OPERATION_rnea; it has no other pass. Of the options, target, precision and layout count. Errors: those of
   rneagen_generate, and NO_JOINTS where no joint has an axis. */
enum rneagen_code operation_text(const char *urdf, size_t length, enum operation operation,
	const struct rneagen_options *options, struct arena *a, const char **text, struct rneagen_error *e);

#endif
