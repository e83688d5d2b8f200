#ifndef RUNTIME_RANGE_FIELD_H
#define RUNTIME_RANGE_FIELD_H
/* Outputs as functions of q whose values are polynomials: at each q, an output is
     f(q, x) = f0 + sum m_j a_j + sum b_j v_j + sum_{j <= k} c_jk v_j v_k
   in drives a (accelerations and other inputs that are linear) and rates v, each divided by the largest magnitude that its range
   has. The coefficients come from evaluating the DAG at a few x: its lanes. In each angle of q an output is a trigonometric
   polynomial of degree at most 2 for each body that turns by it, in each length a polynomial of degree at most 2. */

#include "range/box.h"
#include "relax/relax.h"

/* FIELD_DEGREE: of a polynomial in a sine and cosine that a grid is made for. */
enum { FIELD_DEGREE = 12, FIELD_DIMS = 64, FIELD_VECTOR = 8, FIELD_BALLS = RELAXED_BALLS };

/* Before a function with vectors: it is compiled for several widths of them. */
#if defined __x86_64__ && defined __GNUC__ && !defined __clang__ && !defined __SANITIZE_ADDRESS__ && !defined __SANITIZE_THREAD__
#define FIELD_CLONES __attribute__((target_clones("avx512f", "avx2", "default")))
#else
#define FIELD_CLONES
#endif

/* A row of q. */
struct field_dim {
	int row, is_angle, is_circle; /* is_circle: the range is every angle */
	int degree;                   /* of outputs in it, at most */
	double lower, upper;
	uint32_t value, sine, cosine; /* nodes; 0: not read */
};

/* A drive or rate: |x| <= scale, x / scale in range. Of drives with the same ball, counted from 1, the norm over their scale is
   at most 1. */
struct field_input {
	int argument, row, ball;
	double scale;
	struct interval range;
	uint32_t node;
};

/* A narrow value is the same in all lanes; ANEW spreads one over them. */
struct field_step {
	enum op op;
	int is_wide;
	uint32_t to, arg[3];
};

/* Outputs that depend on the same rows of q. */
struct field {
	const struct dag *d;
	struct field_dim dims[FIELD_DIMS];
	struct field_input drives[FIELD_DIMS], rates[FIELD_DIMS];
	int dim_count, drive_count, rate_count;
	int is_odd;        /* some term is linear in a rate */
	int has_grid;      /* outputs are of their degree in each dimension, and there are not too many */
	int *outputs;      /* of the DAG's */
	int output_count;
	size_t lane_count; /* rounded up */
	size_t coefficient_count; /* f0, m, b, c by rows of the upper triangle */
	double *noise;     /* by output: no coefficient is further from the exact one */
	double *plain;     /* by output: plain intervals give no larger magnitude over the box */
	struct field_step *steps;
	size_t step_count, narrow_count, wide_count;
	const uint32_t *slots;
	uint32_t *result; /* by output: its slot among the wide ones */
};

/* Angles' sine and cosine, or a length and 0; by dimension. */
struct field_point {
	double x[FIELD_DIMS][2];
};

/* Split the outputs of a relaxed DAG into fields; returns how many, in *fields, which live in `a`; -1 on failure. Errors:
   UNSUPPORTED, where an output is no such polynomial; LIMIT; MEMORY. */
int field_split(struct field **fields, const struct relaxed *r, struct arena *a, struct rneagen_error *e);

/* Numbers that field_evaluate works in; free() frees them. NULL when memory runs out. */
double *field_work(const struct field *f);

/* Coefficients of all outputs at q, [output][coefficient]. */
void field_evaluate(const struct field *f, const struct field_point *q, double *work, double *coefficients);

/* Numbers that field_values works in; free() frees them. NULL when memory runs out. */
double *field_scalars(const struct field *f);

/* Values of all outputs at q and at drives and rates x over their scales, in this order: far quicker than all coefficients. */
void field_values(const struct field *f, const struct field_point *q, const double *x, double *scalars, double *values);

/* The sine and cosine of an angle, or a length. */
void field_place(const struct field_dim *dim, double q, double x[2]);

/* A length of one value; an angle is over its whole circle somewhere. */
static inline int field_is_point(const struct field_dim *k)
{
	return !k->is_angle && k->lower == k->upper;
}

/* Where c_jk stands, j <= k. */
static inline size_t field_pair(const struct field *f, int j, int k)
{
	return (size_t)(1 + f->drive_count + f->rate_count + j * f->rate_count - j * (j + 1) / 2 + k);
}

#endif
