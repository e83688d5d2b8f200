#ifndef RNEA_PIPE_H
#define RNEA_PIPE_H
/* The first function of a text on arrays of the program's own. A batch is cut into slices; each goes through one of a few
   buffers, which have a stream, page-locked memory and device memory each: while one slice is computed, the next is packed and
   copied in and the last is copied out. A pipe is one set of buffers and serves one call at a time; a pool keeps those
   that are not in use. */

#include "cuda/driver.h"

struct pipe_pool;

/* A pool for an open robot, which packs with up to `threads` threads (0: one for each processor); `driver` and `info`
   must outlive it. On failure *pool is NULL. Errors: MEMORY. */
enum rnea_code pipe_open(struct pipe_pool **pool, const struct driver *driver, const struct rnea_info *info,
	unsigned threads, struct rnea_error *e);

/* NULL is a no-op. The context must be current, unless it is `lost`, and all that was in it. */
void pipe_close(struct pipe_pool *pool, int lost);

/* rnea_run: the pointers are checked, `count` is not 0. */
enum rnea_code pipe_run(struct pipe_pool *pool, void *const *arrays, size_t count, struct rnea_error *e);

/* How many samples a slice of a larger batch has. */
size_t pipe_slice(const struct pipe_pool *pool);

#endif
