#ifndef RNEAGEN_TURNS_H
#define RNEAGEN_TURNS_H
/* Parts of kernels that run one after the other and leave numbers for each other in rows of the last array: in what order these
   are written and read. Parts of one kernel run in any order. */

#include "plan/grid/parts.h"

/* Does each part read what another one has left before it writes there, does no part of a kernel store what another of the kernel
   stores or reads, and has what is read been stored by kernels before, by no more than `most`? 0 too when memory runs out. */
int turns_serve(const struct part *parts, int count, int rows, int most, struct arena *a);

/* Put each store of a row of the last array behind the lines that read the row. Returns 0 when memory runs out. */
int turns_delay_stores(struct plan *p, struct arena *a);

#endif
