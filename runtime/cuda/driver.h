#ifndef RNEA_DRIVER_H
#define RNEA_DRIVER_H
/* The CUDA backend: a text compiled for a device, loaded, its kernels found, warmed and launched. */

#include "cuda/alone.h"
#include "cuda/limbs.h"
#include "cuda/relay.h"

struct driver {
	struct device device;
	void *module;
	const struct rnea_info *info;
	struct device_kernel *kernels; /* one for each of the info's functions */
	struct limbs limbs;  /* of the first function */
	struct relay relay;  /* likewise */
	struct alone alone;  /* likewise */
	unsigned block;	     /* samples per block of every launch but those of limbs and of parts alone */
	unsigned min_blocks; /* launch bound of the first function's kernel; 0: none */
	int cached;
	char compiler[640]; /* "NVRTC 13.0 (libnvrtc.so.13)"; "" if it was cached */
	char target[24];    /* "sm_90" */
};

/* Open device `ordinal`, compile the text of `r` for it (whose arch is not looked at) or take it from the cache, load
   it, and read its table into *info, which must outlive it. On failure both are empty, but for c->device.absent. */
enum rnea_code driver_open(
	struct driver *c, int ordinal, const struct image_request *r, struct rnea_info *info, struct rnea_error *e);
void driver_close(struct driver *c);

/* Threads of a block of a function's kernel that takes `block` samples. */
unsigned driver_threads(const struct rnea_function *f, unsigned block);

/* Enqueue a function of the info over `count` samples, at least one; `arrays` holds its device pointers. Errors: DRIVER,
   CONTEXT. */
enum rnea_code driver_launch(const struct driver *c, size_t function, void *const *arrays, size_t count, void *stream,
	struct rnea_error *e);

#endif
