#ifndef RNEA_JIT_H
#define RNEA_JIT_H
/* From CUDA C to an image that the driver loads, by NVRTC. Needs no device. */

#include "core/failure.h"
#include <stddef.h>

struct jit_request {
	const char *source; /* NUL-terminated */
	const char *file;   /* what messages call it */
	int arch;           /* 90 is sm_90 */
	const char *const *options; /* further options for NVRTC, option_count of them */
	size_t option_count;
	char *log; /* as in struct rnea_options; the caller has emptied it */
	size_t log_size;
};

struct jit_image {
	char *data; /* malloc; to be released with jit_free */
	size_t size;
	int arch;   /* what it was compiled for: 90 is sm_90, or compute_90 */
	char compiler[600]; /* "NVRTC 13.0 (libnvrtc.so.13)" */
	int is_ptx; /* NVRTC is older than the architecture: PTX for the newest it knows, which the driver finishes */
};

/* Compile. On failure *image is empty. Errors: NO_COMPILER, COMPILER (no way from this NVRTC to this architecture, an
   option that it does not know), COMPILE (the message has the first error, its line and that line's text), MEMORY. */
enum rnea_code jit_compile(const struct jit_request *r, struct jit_image *image, struct rnea_error *e);
void jit_free(struct jit_image *image);

#endif
