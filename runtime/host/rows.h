#ifndef RNEA_HOST_ROWS_H
#define RNEA_HOST_ROWS_H
/* A text of layout soa, whose loop over samples compilers make vectors of, on arrays of layout aos: each piece of a
   batch is turned on its way in and out, while it is in the processor's cache. */

#include "host/host.h"

/* As host_run, on arrays [sample][row] of the function `f` of the table. Returns 0 when memory runs out. */
int host_run_aos(const struct host *h, const struct host_function *f, const struct rnea_function *table,
	void *const *arrays, size_t count);

#endif
