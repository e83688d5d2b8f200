#ifndef TESTS_HARD_DECIMALS_H
#define TESTS_HARD_DECIMALS_H
/* Robots of which the decimals matter: their constants are small differences of what the file says, so that its numbers,
   rounded to doubles, are too far off. */

#include "reference/reference.h"

struct decimal_case {
	const char *name, *why;
	char *(*draw)(uint64_t seed); /* a URDF; the caller frees it */
};

extern const struct decimal_case DECIMAL_CASES[];
extern const int DECIMAL_CASE_COUNT;

/* A state of floats, so that every precision takes the same. All kinds but the first leave terms out, beside which a
   constant's error would not be seen. */
enum { DECIMAL_STATES = 5 };
void decimal_state(const struct reference *r, struct rng *rng, int kind, double *const state[3]);

#endif
