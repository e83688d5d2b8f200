#ifndef RUNTIME_RELAX_QUADRIC_H
#define RUNTIME_RELAX_QUADRIC_H
/* Expressions of a quaternion alone, as affine expressions of its rotation's elements. */

#include "dag/dag.h"

/* Coefficients of 1, x, y, z, w, xx, xy, xz, xw, yy, yz, yw, zz, zw, ww. */
enum { QUADRIC_TERMS = 15 };

struct quadric {
	real c[QUADRIC_TERMS];
};

struct quadric quadric_const(real c);
struct quadric quadric_input(int which); /* 0 to 3: x y z w */
struct quadric quadric_add(struct quadric a, struct quadric b, real sign);
/* Returns 0 where a term would be of a higher degree. */
int quadric_mul(struct quadric *out, struct quadric a, struct quadric b);

/* c + sum of weights w[j][k] by elements R_jk. */
struct rotated {
	real c, w[3][3];
};

/* Returns 0 where it is no such expression. */
int quadric_rotated(const struct quadric *q, struct rotated *r);

/* No magnitude of it is larger for a rotation. */
double rotated_size(const struct rotated *r);

/* It is the element `*row` of R^T g for a vector g, which is given. */
int rotated_is_row(const struct rotated *r, int *row, real g[3]);

#endif
