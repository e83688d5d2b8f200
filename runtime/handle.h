#ifndef RNEA_HANDLE_H
#define RNEA_HANDLE_H
/* struct rnea_robot, for the files that make up the public interface. */

#include "cuda/driver.h"
#include "host/host.h"
#include "cuda/pipe.h"

struct rnea_robot {
	struct rnea_info info;
	struct rnea_build build;
	struct driver driver; /* build.backend says which of the two it is */
	struct host host;
	struct pipe_pool *pool;						 /* CUDA: for rnea_run */
	char kernels[RNEA_KERNEL_COUNT][SOURCE_SYMBOL_SIZE];	 /* what messages call them */
	struct cache_why unkept;
	char device[128], note[sizeof((struct rnea_error *)0)->message]; /* what build points to */
};

/* Whether the text has the kernel. */
int rnea_has(const struct rnea_robot *robot, enum rnea_kernel kernel);

/* Say that it has not. */
enum rnea_code rnea_no_kernel(const struct rnea_robot *robot, enum rnea_kernel kernel, struct rnea_error *e);

#endif
