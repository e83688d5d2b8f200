#ifndef RUNTIME_PEAKS_LANES_H
#define RUNTIME_PEAKS_LANES_H
/* Operations on many numbers at once, compiled for several widths of vectors. */

#include "dag/ops.h"
#include <stddef.h>
#include <stdint.h>

enum { LANES_VECTOR = 8 };

typedef double lanes_vector __attribute__((vector_size(LANES_VECTOR * sizeof(double))));

/* OP_NEG, OP_ADD, OP_SUB or OP_MUL of slots. */
struct lanes_step {
	enum op op;
	uint32_t to, a, b;
};

/* All steps; a slot is so many vectors of v. */
void lanes_run(const struct lanes_step *steps, size_t count, size_t width, lanes_vector *v);

/* Raises *most to the squares of a, or of a and b, lane by lane; b may be NULL. Numbers are finite. */
void lanes_squares(size_t width, const lanes_vector *a, const lanes_vector *b, lanes_vector *most);

/* The coefficients of a polynomial of t from its lanes, for m drives and n rates: constant, drives, rates, squares,
 * pairs. */
void lanes_coefficients(int m, int n, const double *v, double *c);

/* Lengths of (a, b), or of a alone where b is NULL. */
void lanes_lengths(int n, const double *a, const double *b, double *lengths);

#endif
