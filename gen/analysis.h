#ifndef RNEAGEN_ANALYSIS_H
#define RNEAGEN_ANALYSIS_H
/* The robot behind a text, for those who want its numbers: the DAG of its torques, which eval.h evaluates, and the
   URDF's joint behind each row of q. */

#include "dynamics/registry.h"
#include "rneagen.h"

/* Not to be moved once it is open. */
struct analysis {
	struct robot robot;
	struct tree tree;
	struct dag dag; /* q, qd, qdd -> tau, products joined to sums as in the text */
	struct arena arena;
};

/* From `length` bytes of URDF; of `o` what says which torques are wanted is used. On failure *a is empty. Errors: as
   rneagen_generate. */
enum rneagen_code analysis_open(struct analysis *a, const char *urdf, size_t length, const struct rneagen_options *o,
	struct rneagen_error *e);

/* The DAG of a tree's torques, fused. Returns 0 when memory runs out. */
int analysis_dag(struct dag *d, const struct tree *t, int strict, struct arena *a);

/* What a fused DAG costs, an FMA for two; -1 where it has failed. */
long analysis_flops(const struct dag *d);

void analysis_free(struct analysis *a);

#endif
