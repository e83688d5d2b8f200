#ifndef RNEA_CUDA_H
#define RNEA_CUDA_H
/* The CUDA backend: a text compiled for a device, loaded, its kernels found, warmed and launched. */

#include "device.h"
#include "image.h"

/* Arrays of a pass besides the inputs of the text. */
enum { CUDA_PASS_ARRAYS = 3, CUDA_ARRAY_LIMIT = RNEA_ARGUMENT_LIMIT + CUDA_PASS_ARRAYS };

struct cuda {
	struct device device;
	void *module;
	struct device_kernel kernels[RNEA_KERNEL_COUNT];
	unsigned block;	     /* threads per block of every launch */
	unsigned min_blocks; /* launch bound of the rnea kernel; 0: none */
	int cached;
	char compiler[640]; /* "NVRTC 13.0 (libnvrtc.so.13)"; "" if it was cached */
	char target[24];    /* "sm_90" */
};

/* Open device `ordinal`, compile the text of `r` for it (whose arch is not looked at) or take it from the cache, load
   it, and read its table into *info. On failure both are empty, but for c->device.absent. */
enum rnea_code cuda_open(
	struct cuda *c, int ordinal, const struct image_request *r, struct rnea_info *info, struct rnea_error *e);
void cuda_close(struct cuda *c);

/* Enqueue a kernel over `count` samples, at least one; `arrays` holds its `n` device pointers. Errors: DRIVER, CONTEXT.
 */
enum rnea_code cuda_launch(const struct cuda *c, enum rnea_kernel kernel, void *const *arrays, size_t n, size_t count,
	void *stream, struct rnea_error *e);

#endif
