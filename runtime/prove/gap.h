#ifndef RUNTIME_PROVE_GAP_H
#define RUNTIME_PROVE_GAP_H
/* Why no error is bounded. */

#include "prove/prove.h"
#include "prove/rules.h"

/* At a node where rules_node has gone through: its value and error are more than the arithmetic holds, or its error is
   not known. */
struct prove_gap gap_of(const struct rules *r, uint32_t node, const struct eval_model *m);

/* The first that is met is kept. Returns INFINITY. */
double gap_note(struct prove_gap *gap, struct prove_gap found);

#endif
