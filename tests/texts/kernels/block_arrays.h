#ifndef TESTS_BLOCK_ARRAYS_H
#define TESTS_BLOCK_ARRAYS_H
/* The arrays of a launch by a text's table, and what outputs should be. */

#include "rnea.h"
#include <stddef.h>

/* Samples: of blocks of 1024 one, and a piece of another. */
enum { COUNT = 1100, SEED = 20261125 };

struct arrays {
	size_t count, inputs;
	struct rnea_argument a[RNEA_ARGUMENT_LIMIT];
	int aos;
	void *data[RNEA_ARGUMENT_LIMIT];
	double *expected[RNEA_ARGUMENT_LIMIT]; /* [sample][row], of outputs */
};

/* Inputs by the seed, of numbers that a float holds; outputs spoilt. arrays_free frees what it allocates. */
void arrays_new(struct arrays *x, const struct rnea_info *info);
void arrays_free(struct arrays *x);

/* Outputs are no numbers until somebody writes them. */
void arrays_spoil(struct arrays *x);

double arrays_get(const struct arrays *x, size_t i, size_t sample, size_t row);

#endif
