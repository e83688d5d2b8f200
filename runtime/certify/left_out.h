#ifndef RUNTIME_CERTIFY_LEFT_OUT_H
#define RUNTIME_CERTIFY_LEFT_OUT_H
/* Outputs of which a certificate states nothing, since the steps do not know what they read. */

#include "passes/analysis.h"

/* Why an output is left out; NULL: it is not. */
const char *left_out(const struct analysis *x, size_t output);

/* Into live[node] whether the output reads it. */
void left_out_reads(const struct dag *d, size_t output, unsigned char *live);

#endif
