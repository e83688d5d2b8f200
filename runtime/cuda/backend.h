#ifndef RNEA_CUDA_BACKEND_H
#define RNEA_CUDA_BACKEND_H
/* The record of CUDA, and its state. */

#include "core/backend.h"
#include "cuda/pipe.h"

extern const struct backend backend_cuda;

struct cuda {
	struct driver driver;
	struct pipe_pool *pool; /* for rnea_run */
};

#endif
