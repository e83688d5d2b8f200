#ifndef RNEAGEN_STAGE_H
#define RNEAGEN_STAGE_H
/* Which arrays have a place in a kernel's shared memory, where it stages its samples. */

#include "dag/dag.h"

/* Whose place an array takes: its own, but tau that of qdd: a joint's qdd is read before its torque is written. */
int stage_place(const struct dag *d, int argument);

/* Has it a place of its own? Not what all samples share. */
int stage_has_place(const struct dag *d, int argument);

#endif
