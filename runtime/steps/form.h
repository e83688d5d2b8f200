#ifndef RUNTIME_STEPS_FORM_H
#define RUNTIME_STEPS_FORM_H
/* What an output of the DAG is made of, and its derivatives by each of these values, as sums, products and turns: c x + s y,
   where c and s are the cosine and sine of one angle, is seen as a whole wherever both terms are among those of a sum. */

#include "steps/outward.h"
#include "dag/dag.h"

enum form_kind { FORM_CONST, FORM_INPUT, FORM_SINE, FORM_COSINE, FORM_PRODUCT, FORM_SUM, FORM_TURN };

/* A form with a sign. */
struct operand {
	uint32_t form;
	int is_minus;
};

/* PRODUCT: a b; SUM: a + b; TURN: cosine a + sine b; SINE, COSINE: of a. Parts are earlier forms. */
struct form {
	enum form_kind kind;
	struct operand a, b;
	uint32_t sine, cosine;
	int argument, row; /* INPUT */
	struct span constant;
};

enum { FORM_ZERO, FORM_ONE }; /* the first two */

struct forms {
	const struct dag *d;
	struct arena *arena;
	struct form *list;
	size_t count, capacity;
	uint32_t dag_count;         /* nodes of the DAG up to the output's */
	uint32_t *uses;
	struct operand *value, *slope; /* by node of the DAG; FORM_ZERO: it is 0, or does not matter */
	struct operand root;
	int is_unknown;             /* an operation that has no form */
};

/* Of one output; has_slopes: its derivatives too, but none by angles. It lives in `a`. Returns 0 when memory runs out, or where
   an operation is not known: x->is_unknown. */
int forms_make(struct forms *x, const struct dag *d, size_t output, int has_slopes, struct arena *a);

/* A product with the sine or cosine of an angle. */
struct turn_term {
	uint32_t angle, wave; /* forms */
	int is_sine;
	struct operand other;
};
int turn_term(const struct forms *x, struct operand a, struct operand b, struct turn_term *t);

#endif
