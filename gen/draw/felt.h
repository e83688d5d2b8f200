#ifndef RNEAGEN_FELT_H
#define RNEAGEN_FELT_H
/* Which terms of sums the outputs feel, by derivatives in drawn samples. */

#include "draw/draw.h"

/* By node of `d`: bit k is set where node is a live sum or difference whose operand k no output feels: |derivative of the
   output by the operand times its value| stays below this fraction of the largest magnitude of the output, each in all
   samples of FELT_SAMPLES. Felt are operands of what a root is taken of or that divides, and all whose part of an output is
   no finite number in some sample. In memory of `a`; NULL when that runs out. */
unsigned char *felt_find(const struct dag *d, const struct tree *t, const struct request *k, double fraction, struct arena *a);

/* Inputs drawn over their ranges, each for itself; others than those that effects are measured by. */
extern const struct draw_options FELT_SAMPLES;

#endif
