#ifndef RNEAGEN_NORMS_H
#define RNEAGEN_NORMS_H
/* Intervals of all values of a DAG over a box, where rotations keep lengths: |(c x + s y, c y - s x)| = |(x, y)|.
   Beside the interval of each value stand norms of sets of a few values:
   - of a set with both values of a rotation, or one, it is at most that of the set with x and y in their place;
   - of a set of sums, at most that of the first terms and that of the second ones together;
   - of a set without one of its values, it is the other side of a right angle;
   - of sums of multiples of others and of products, what norms_form.h says;
   - of any set, at most the root of the sum of its squares. */

#include "norms/interval.h"

enum { NORMS_SET = 4 };

struct norms_form;

struct norms_set {
	uint32_t nodes[NORMS_SET], last; /* ascending; last: the largest */
	int count;
	uint32_t one, other; /* 1 + the sets that it is bounded by; 0: none */
	uint32_t rest, apart; /* 1 + the set without a node, and that node; 0: none */
	const struct norms_form *form; /* norms_form.h; NULL: none */
};

/* Drives and rates are x = middle + half t, t from -1 to 1: a value is a polynomial of t whose coefficients are
   intervals, in the order of struct field's: the closer, the smaller the box. Or a value is one interval, which takes
   less time, and is closer for large boxes. */
struct norms_input {
	int argument, row, lane; /* of t */
};

struct norms {
	const struct dag *d;
	struct norms_set *sets; /* those that others need come first */
	uint32_t set_count, set_limit;
	uint32_t *table, table_size; /* 1 + set, by what is in it */
	uint32_t *uses;              /* by node */
	struct arena *arena;
	uint32_t *order, *first; /* sets by `last`: those of node i are order[first[i]] to order[first[i + 1] - 1] */
	int drive_count, rate_count;
	size_t lanes;                 /* of a wide value; of others there is one, the constant */
	struct norms_input *inputs;   /* drives, then rates */
	unsigned char *is_wide, *is_wide_set;
	uint32_t *at, *set_at;        /* where a value's lower bounds begin, its upper ones behind them; where a set's norms do */
	size_t value_count, norm_count;
};

/* What norms_evaluate fills. */
struct norms_values {
	double *bounds, *norm;
	double *size; /* by node: no magnitude is larger */
	double *most, *most_norm; /* what is known apart of all boxes, of one lane: by node, and by set; NULL: nothing */
};

/* Values of polynomials of t where has_lanes, and there are not too many. Returns 0 when memory runs out. */
int norms_make(struct norms *x, const struct dag *d, int has_lanes, struct arena *a);

/* 1 + the set of two nodes, made before norms_lay; 0: there is no room. */
uint32_t norms_pair(struct norms *x, uint32_t a, uint32_t b);

/* The same of up to NORMS_SET nodes, none with a sign. */
uint32_t norms_set(struct norms *x, const uint32_t *nodes, int count);

/* When all sets are there. Returns 0 when memory runs out. */
int norms_lay(struct norms *x, struct arena *a);

/* The norm of a set that norms_pair has given: no norm of its values is larger. */
double norms_of_pair(const struct norms *x, const struct norms_values *v, uint32_t pair);

/* So many magnitudes of which nothing is known, for `most` and `most_norm`; NULL when memory runs out. */
double *norms_unknown(size_t count, struct arena *a);

int norms_values_make(struct norms_values *v, const struct norms *x, struct arena *a);

/* All values over a box: rows[argument] are those of an input. */
void norms_evaluate(const struct norms *x, const struct interval *const *rows, struct norms_values *v);

/* The range of a node's value. */
struct interval norms_range(const struct norms *x, const struct norms_values *v, uint32_t node);

#endif
