#ifndef RNEAGEN_EVAL_MODEL_H
#define RNEAGEN_EVAL_MODEL_H
/* Arithmetic as the analysis of errors sees it: how far each operation of a text may be from the exact one. */

#include "base/within.h"

/* How products of pairs of floats are made: with a fused multiply-add, by halves of the factors, or either way in all
   of a text. */
enum pair_products { PAIRS_EITHER, PAIRS_FUSED, PAIRS_BY_HALVES };

struct eval_model {
	double add, mul;	     /* a sum x is off by at most add |x| + tiny, a product or a root by mul |x| + tiny */
	double quotient;     /* a quotient by quotient |x| + tiny */
	double terms;		     /* a sum of a and b by terms (|a| + |b|) more: numbers are pairs of floats */
	enum pair_products products;
	double tiny;
	double input;		     /* an input x is off by at most input |x| + tiny where the text rounds it, else 0; not
					where it is an angle of sine and cosine */
	int fused;		     /* a product joined to a sum is not rounded by itself */
	double largest;		     /* what is larger may overflow */
	double sincos, sine, cosine; /* a sine s is off by at most sincos |s| + sine + tiny, a cosine likewise */
	double angle;		     /* the largest for which that is known */
	double store, store_tiny;    /* a result x is off by at most store |x| + store_tiny more where memory rounds it */
	double store_largest;
	real (*constant)(real value); /* as the text has it */
	double own;		     /* an operation takes own |x| more, for the evaluator's own arithmetic; in models 0 */
	const struct eval_model *wide; /* of wide numbers, which NARROW rounds by `add`; NULL: they are of this type */
};

#endif
