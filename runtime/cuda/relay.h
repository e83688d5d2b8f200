#ifndef RNEA_RELAY_H
#define RNEA_RELAY_H
/* A relay: a launch of the first function runs three kernels, one after the other, and its own is the second of them; or two, a
   kernel for hands and its own; of robots with long arms more kernels for hands. After any of these one that transposes outputs
   may run. */

#include "cuda/device.h"
#include "rnea.h"

struct relay {
	struct device_kernel start, solve;
	unsigned threads; /* of the third, for each sample; 0: there is no relay */
	unsigned samples; /* of a block of the third */
	unsigned room;    /* blocks of the third beyond which more along y gain nothing */
	struct device_kernel hands[RNEA_HANDS_LIMIT];
	unsigned hand_kernels; /* so many are there */
	struct device_kernel transpose;
	unsigned transposed_samples, transposed_threads, outputs; /* of the kernel that transposes outputs; no samples: there is none */
};

/* Find NAME_FUNCTION_which_kernel, which stages in `bytes` a block. Errors: TEXT where it is not there, DRIVER. */
enum rnea_code relay_kernel(const struct device *d, void *module, const struct source *s, const struct rnea_function *f,
	const char *which, size_t bytes, struct device_kernel *k, struct rnea_error *e);

/* Find them, where the function has a relay, or hands, which stage in blocks of `block`. Errors: TEXT where one is not there,
   DRIVER, ARGUMENT where the device has less shared memory than the third takes. */
enum rnea_code relay_find(struct relay *r, const struct device *d, void *module, const struct source *s,
	const struct rnea_function *f, unsigned block, struct rnea_error *e);

/* Launch those of hands, so many blocks along x. */
enum rnea_code relay_hands(const struct relay *r, const struct device *d, const struct rnea_function *f, unsigned blocks,
	unsigned block, void **parameters, void *stream, struct rnea_error *e);

/* Launch the kernel that transposes outputs, where there is one. Without samples it does nothing. */
enum rnea_code relay_transpose(const struct relay *r, const struct device *d, void **parameters, size_t count, void *stream,
	struct rnea_error *e);

/* Launch the third. Without samples it does nothing. */
enum rnea_code relay_solve(const struct relay *r, const struct device *d, void **parameters, size_t count, void *stream,
	struct rnea_error *e);

#endif
