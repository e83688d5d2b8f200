#ifndef RNEAGEN_EVAL_H
#define RNEAGEN_EVAL_H
/* The DAG's evaluator: what the generated text computes, in four precisions, with the magnitudes that were summed and a
   bound of the error: the lesser of the running one (Higham, Accuracy and Stability of Numerical Algorithms, 2002,
   section 3.3) and that of a sweep back over derivatives (Linnainmaa, Taylor expansion of the accumulated rounding
   error, BIT 16, 1976). */

#include "dag/dag.h"
#include "dag/eval_model.h"

/* Per output, in the order of dag->outputs. Either pointer may be NULL. */
struct eval_terms {
	double *size;  /* the sum of the magnitudes of all products that make the value */
	double *bound; /* |computed - exact| is at most this, exact as for eval_bound, whether products joined to sums are
			  rounded once or twice: the rounding of the file's decimals and of constants, sine and cosine and
			  underflow included; INFINITY after an overflow */
};

/* Evaluate one sample: in[k] points at the rows of argument k (NULL for outputs), out[k] at those of an output (NULL for
   inputs). Products joined to sums are rounded once. Returns 0 when memory runs out; work is malloc'ed and freed. */
int eval_f32(const struct dag *d, const float *const *in, float *const *out, const struct eval_terms *terms);
int eval_f64(const struct dag *d, const double *const *in, double *const *out, const struct eval_terms *terms);
int eval_real(const struct dag *d, const real *const *in, real *const *out, const struct eval_terms *terms);

/* For one sample, a bound of what any text that computes `d` in arithmetic `m` is off, whichever way its compiler joins
   products to sums: |tau_i - exact_i| <= bound[k][i], where argument k is the output. Exact is what the decimals of the URDF
   and of the scene give in exact arithmetic at these very inputs, after these replacements: an angle within 5e-15 rad of a
   multiple of pi/2 is that; constants that are zero, or equal, but for the rounding of the file's numbers, or of extended
   precision (1e-19 of their terms), are so; and what the scene changes (snap-angle, round-constants, drop-below) is as it leaves
   it. INFINITY where the text may overflow, or an input is not finite or an angle beyond what the model knows. Evaluated in
   extended precision, or in double where there is none: the bound then is up to five times larger in f64. Returns 0 when memory
   runs out. */
int eval_bound(const struct dag *d, const struct eval_model *m, const double *const *in, double *const *bound);

/* The value of a node that is no input, from the values by node of its operands; of an operation, from those. */
double eval_node(const struct node *n, const double *v);
double eval_operation(enum op op, double a, double b, double c);

/* The derivatives of that value by its operands, of which there are at most three. */
void eval_partials(const struct node *n, const double *v, double *out);

#if defined __SIZEOF_FLOAT128__ && defined RNEAGEN_QUAD
int eval_quad(
	const struct dag *d, const __float128 *const *in, __float128 *const *out, const struct eval_terms *terms);
#endif

#endif
