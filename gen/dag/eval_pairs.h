#ifndef RNEAGEN_EVAL_PAIRS_H
#define RNEAGEN_EVAL_PAIRS_H
/* What operations on pairs of floats (templates/arithmetic/f32x2.in, sincos/sincos_f32x2_core.in) take at known values; INFINITY
   where too little is known. */

#include "dag/eval_rounding.h"

double pairs_sum(struct known a, struct known b);
/* x: a b, and what the operands' errors make of it. The product has *left_out less, beside what is returned. */
double pairs_product(enum pair_products by, struct known a, struct known b, struct known x, double *left_out);
/* Of an angle that is a double, whose sine or cosine is `value`, which has *left_out less beside that. */
double pairs_turn(const struct eval_model *m, int is_sine, double angle, double value, double *left_out);

/* A double's first 24 bits. */
double pairs_head(double x);

#endif
