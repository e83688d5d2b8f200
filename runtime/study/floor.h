#ifndef RUNTIME_FLOOR_H
#define RUNTIME_FLOOR_H
/* A text like those of rneagen whose kernel moves the arrays of another and computes nothing: by element, the sum of the
   inputs, tau = q + qd + qdd where these are the arrays. It runs on both backends as they do, in the same blocks and
   threads. */

#include "dag/dag.h"
#include "rnea.h"

/* The text for `count` arrays of numbers of one type; `out` may fail. */
void floor_text(const struct argument *arrays, int count, enum rnea_scalar scalar, struct text *out);

#endif
