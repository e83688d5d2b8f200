#ifndef RNEAGEN_EVAL_ROUNDING_H
#define RNEAGEN_EVAL_ROUNDING_H
/* What an operation's own rounding may be at the values of one sample: closer than a relative error, since it is known between
   which powers of two, or of which floats, a value lies. */

#include "dag/eval_model.h"

/* A value, and how far what a text has for it may be off. */
struct known {
	double x, e;
};

/* Of an operation that is good to `unit`: relative to x of numbers that are pairs; else unit / 2^-24 or 2^-53 half units in the
   last place. */
double rounding_of_result(const struct eval_model *m, double unit, struct known x);

/* a + b = x, a b = x. Of x the error is that of the operands. */
double rounding_of_sum(const struct eval_model *m, struct known a, struct known b, struct known x);
/* The product has *left_out less, beside that; so the next two. */
double rounding_of_product(const struct eval_model *m, struct known a, struct known b, struct known x, double *left_out);

/* How large a product is that a compiler may round before a sum takes it; 0: it does not. */
double size_of_product(const struct eval_model *m, struct known a, struct known b);

/* An input as the text has it. */
double rounding_of_input(const struct eval_model *m, double x, double *left_out);

/* The sine or cosine of an angle that is `inherited` off, beside that. Nothing is known of angles beyond the model's domain. */
double rounding_of_turn(const struct eval_model *m, int is_sine, struct known angle, double value, double *left_out);

/* What the error of a quotient by b, and of the root of a, is beside its part that is linear in the operands' errors. */
double rest_of_quotient(double value, double b, double of_a, double of_b);
double rest_of_root(double value, double a, double of_a);

/* The power of two at or below |x|; 0 of what is below the normal doubles. */
double rounding_place(double x);

#endif
