#ifndef RUNTIME_PROVE_GAP_H
#define RUNTIME_PROVE_GAP_H
/* Why no error is bounded. */

#include "dag/eval_model.h"
#include "prove/prove.h"

/* At a node with these magnitudes of its value and of its first operand, whose value and error are more than the arithmetic holds, or
   whose error is not known. */
struct prove_gap gap_of(const struct dag *d, uint32_t node, const double sizes[2], double error, const struct eval_model *m);

/* The first that is met is kept. Returns INFINITY. */
double gap_note(struct prove_gap *gap, struct prove_gap found);

#endif
