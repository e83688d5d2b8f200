#ifndef RNEA_CUDA_BACKEND_H
#define RNEA_CUDA_BACKEND_H
/* The state of backend_cuda. */

#include "cuda/pipe.h"

struct cuda {
	struct driver driver;
	struct pipe_pool *pool; /* for rnea_run */
};

#endif
