#ifndef ARRAYS_H
#define ARRAYS_H
/* The arrays of one robot on the device. */

#include "check.h"
#include <stdint.h>

enum { ARRAYS_LIMIT = RNEA_ARGUMENT_LIMIT };

/* For a number of samples: inputs filled with the reference's states, outputs poisoned. */
struct arrays {
	struct gpu_array array[ARRAYS_LIMIT];
	void *pointers[ARRAYS_LIMIT]; /* as rnea_launch wants them */
	size_t n, count, shift[ARRAYS_LIMIT]; /* shift: by how many bytes an array begins further on than its memory */
	void *host; /* room for the largest */
};

size_t arrays_bytes(const struct rnea_argument *a, size_t count);
struct arrays arrays_new(const struct gpu *g, const struct rnea_info *info, const struct reference *r, size_t count);

/* The same, of which every other array begins an element further on: at no multiple of 16 bytes. */
struct arrays arrays_new_shifted(const struct gpu *g, const struct rnea_info *info, const struct reference *r, size_t count);
void arrays_free(const struct gpu *g, struct arrays *a);

/* Read tau back and hold it against the reference; `what` is for the message. */
void check_torque(const struct gpu *g, struct item *it, const struct arrays *a, size_t tau, const struct reference *r,
	const char *what);

#endif
