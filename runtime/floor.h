#ifndef RUNTIME_FLOOR_H
#define RUNTIME_FLOOR_H
/* A text like those of rneagen whose kernel moves the arrays of a robot and computes nothing: tau = q + qd + qdd by
   element. It runs on both backends as they do, in the same blocks and threads. */

#include "rnea.h"

/* Rows of q, and of qd, qdd and tau; the text is malloc'ed, NULL when memory runs out. */
char *floor_text(size_t nq, size_t nv, enum rnea_scalar scalar);

#endif
