#ifndef RNEAGEN_STAGE_H
#define RNEAGEN_STAGE_H
/* A kernel's shared memory: how much there is, and which arrays have a place in it where it stages its samples. */

#include "dag/dag.h"

/* Bytes of shared memory that a kernel has without asking; threads of a warp, the smallest block. */
enum { SHARED_BYTES = 48 << 10, WARP_THREADS = 32 };

/* Whose place an array takes: its own, but tau that of qdd: a joint's qdd is read before its torque is written. */
int stage_place(const struct dag *d, int argument);

/* Has it a place of its own? Not what all samples share. */
int stage_has_place(const struct dag *d, int argument);

#endif
