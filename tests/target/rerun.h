#ifndef TESTS_RERUN_H
#define TESTS_RERUN_H
/* A DAG computed operation by operation as its text says, with the text's own sine and cosine: what the compiled text
   must give to the last bit. */

#include "dag/dag.h"
#include "target/target.h"

/* in[k]: the rows of argument k (NULL for outputs), out[k] those of an output, all of the target's precision though
   kept as double. `fused`: does the compiled text have a fused multiply-add? */
void rerun(const struct dag *d, const struct target *t, int fused, const double *const *in, double *const *out);

#endif
