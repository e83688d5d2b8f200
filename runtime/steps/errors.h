#ifndef RUNTIME_STEPS_ERRORS_H
#define RUNTIME_STEPS_ERRORS_H
/* What holds over one box: an output's range, and how far rounding takes it off. */

#include "steps/lengths.h"
#include "dag/eval_model.h"

enum { STEPS_PRECISIONS = 4 };

/* Two operations whose roundings are bounded together, by Cauchy and Schwarz: the products c x and s x, two turns that are mates,
   or a sine and cosine. */
struct twins {
	uint32_t one, other;   /* nodes of the DAG */
	uint32_t values;       /* 1 + the set of their values; 0: the norm is that of `factor`, or 1 */
	uint32_t factor;       /* of products: the form x */
	uint32_t slopes;       /* 1 + the set of the derivatives by them */
};

struct errors {
	const struct dag *d;
	const struct eval_model *models; /* `count` of them; 0: values alone */
	int count;
	struct forms forms;
	struct lengths lengths;
	struct twins *twins;
	size_t twin_count;
	double *off;             /* by node of the DAG: how far what is computed is from the exact value */
	/* what the rounding of a product, and of a sum, sine or cosine, takes from the exact value; of these also what the angle
	   is off */
	double *product, *sum;
};

struct box_bound {
	double errors[STEPS_PRECISIONS]; /* by model; INFINITY: something may overflow */
	struct span value;
};

/* Of one output. Returns 0 when memory runs out, or where an operation is not known. */
int errors_make(struct errors *x, const struct dag *d, size_t output, const struct eval_model *models, int count,
	struct arena *a);

/* Over the box rows[argument]. */
void errors_evaluate(struct errors *x, struct span *const *rows, struct box_bound *bound);

#endif
