#ifndef RUNTIME_STEPS_POINTS_H
#define RUNTIME_STEPS_POINTS_H
/* An output at single points of q, as a polynomial of drives a and rates v, each over the largest magnitude in its range:
     f(q, x) = f0 + sum m_i a_i + sum b_j v_j + sum_{j <= k} c_jk v_j v_k.
   That it is one, and of which degree it is in the sine and cosine of each angle and in each length, is found out on the DAG. */

#include "dag/dag.h"
#include "steps/outward.h"

enum { POINT_DIMS = 16, POINT_INPUTS = 10, POINT_VECTOR = 8, POINT_DEGREE = 4 };

/* A row of q. */
struct point_dim {
	int row, is_angle;
	int degree;               /* of the output; in an angle, of the trigonometric polynomial */
	struct span range;
	uint32_t value, sine, cosine; /* places among the narrow values; UINT32_MAX: not read */
};

struct point_input {
	int argument, row;
	double scale;
	struct span range;        /* over its scale */
};

struct point_step {
	enum op op;
	int is_wide;
	uint32_t to, arg[3];      /* places */
};

struct points {
	struct point_dim dims[POINT_DIMS];
	struct point_input drives[POINT_INPUTS], rates[POINT_INPUTS];
	int dim_count, drive_count, rate_count, is_odd;
	size_t lanes, coefficients;
	struct point_step *steps;
	size_t step_count, narrow_count, wide_count;
	double *narrow;           /* what constants there are */
	double **wide;            /* lanes of inputs, by place; NULL: a step makes them */
	uint32_t root;
	double size, noise;       /* of a coefficient: its magnitude over all angles, and how far it may be off */
};

/* Of one output over the box rows[argument]; `position` is the argument q. It lives in `a`. 1; 0 when memory runs out; -1 where
   the output is no such polynomial, or has more rows than there is room for. */
int points_make(struct points *p, const struct dag *d, size_t output, struct span *const *rows, int position, struct arena *a);

/* Numbers that points_at works in; free() frees them. */
double *points_work(const struct points *p);

/* Coefficients at a point: of each dimension its sine and cosine, or its length and nothing. */
void points_at(const struct points *p, const double (*q)[2], double *work, double *coefficients);

/* Where c_jk stands, j <= k. */
static inline size_t points_pair(const struct points *p, int j, int k)
{
	return (size_t)(1 + p->drive_count + p->rate_count + j * p->rate_count - j * (j + 1) / 2 + k);
}

/* No value of sign times the polynomial is above this, over all drives and rates in their ranges; where it is not above `floor`,
   something below that may be returned. */
double points_above(const struct points *p, const double *coefficients, int sign, double floor);

#endif
