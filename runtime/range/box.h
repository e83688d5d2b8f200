#ifndef RUNTIME_RANGE_BOX_H
#define RUNTIME_RANGE_BOX_H
/* The box of inputs for which something is proved: an interval for each row of each input that an output reads. */

#include "passes/analysis.h"
#include "norms/interval.h"

struct box {
	struct interval *rows[DAG_ARGUMENTS]; /* by argument of the DAG; NULL for outputs */
};

/* By the limits of the joints and by the scene's ranges, which count more. A continuous joint has -pi to pi, which stands for
   every angle. Arrays live in `a`. Errors: SCENE, with the names of all inputs that have no limit and no range; MEMORY. */
enum rneagen_code box_make(struct box *b, const struct analysis *x, struct arena *a, struct rneagen_error *e);

/* A row of an argument as --range calls it: "qdd.elbow" where it is a joint's, else "payload_hand[3]". */
void box_put_name(const struct analysis *x, int argument, int row, struct text *out);

/* A copy of its rows, in `a`. Returns 0 when memory runs out. */
int box_copy(struct interval *rows[DAG_ARGUMENTS], const struct box *b, const struct dag *d, struct arena *a);

#endif
