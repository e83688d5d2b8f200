#ifndef RUNTIME_RELAX_PLAIN_H
#define RUNTIME_RELAX_PLAIN_H
/* Plain intervals of all values. */

#include "norms/interval.h"

/* Into v, by node; of dead ones nothing. `uses` as dag_uses has it. */
void plain_ranges(struct interval *v, const struct dag *d, struct interval *const *rows, const uint32_t *uses);

#endif
