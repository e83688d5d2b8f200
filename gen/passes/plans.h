#ifndef RNEAGEN_PLANS_H
#define RNEAGEN_PLANS_H
/* The second half of the passes: from the fused DAG to what a text will say, before it is text. */

#include "passes/analysis.h"
#include "plan/kernels.h"

struct plans {
	struct function functions[ALGORITHM_COUNT]; /* function_count of them, the main one first; set before: algorithms, DAGs */
	int function_count;
	struct relay *relay;  /* plans_parts; NULL: there is one kernel */
	struct part *parts;   /* plans_parts: of the main function, or of the relay's second kernel */
	int part_count;       /* 0: it is whole */
	int is_transposed;    /* plan/transposed.h */
	struct part *rounds;  /* plans_limbs: whose limbs serve small batches (plan/grid/found/found_limbs.h); NULL: the function's do */
	struct kernels kernels; /* plans_kernels */
};

/* One pass each, in this order. plans_parts is the last that needs the analysis' DAG as it was before it was fused, and gives
   it back. Errors: USAGE, MEMORY. */
enum rneagen_code plans_build(struct plans *p, struct analysis *a);
enum rneagen_code plans_parts(struct plans *p, struct analysis *a);
enum rneagen_code plans_segments(struct plans *p, struct analysis *a);
enum rneagen_code plans_limbs(struct plans *p, struct analysis *a);
enum rneagen_code plans_kernels(struct plans *p, struct analysis *a);

#endif
