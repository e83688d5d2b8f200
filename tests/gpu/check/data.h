#ifndef DATA_H
#define DATA_H
/* Reference data: states and their torques in double precision, written by rnea_reference as NumPy arrays. */

#include "rnea.h"
#include <stddef.h>

/* [count][rows], of the file's little-endian doubles. */
struct samples {
	double *values; /* malloc */
	size_t count, rows;
};

struct reference {
	struct samples q, qd, qdd, tau;
};

/* Read FOLDER/q.npy and its companions. Returns 0, having told standard error why, if they are not there or do not
   belong together. */
int reference_read(struct reference *r, const char *folder);
void reference_free(struct reference *r);

/* The samples by the name of an array of the signature, or NULL. */
const struct samples *reference_find(const struct reference *r, const char *name);

/* `count` samples in `scalar` and `layout`, the given ones over and over. `host` has room for them. */
void samples_tile(const struct samples *s, void *host, size_t count, enum rnea_scalar scalar, enum rnea_layout layout);

struct difference {
	double max, rms; /* of ||x - s|| / ||s|| over the samples; max is infinite where x is not finite */
	double scaled;   /* the largest ||x - s|| / max(||s||, a tenth of the rms of ||s||): torques that happen to
			    cancel are not held to a digit that no sum can keep */
	size_t worst;    /* the sample of `scaled` */
};

/* The same samples against what was computed. */
struct difference samples_compare(
	const struct samples *s, const void *host, size_t count, enum rnea_scalar scalar, enum rnea_layout layout);

#endif
