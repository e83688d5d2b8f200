#ifndef RUNTIME_JUDGE_H
#define RUNTIME_JUDGE_H
/* How far torques are off: the DAG evaluated in more precision than any text has, over the states of one set. */

#include "analysis.h"
#include "sample.h"

#if defined __SIZEOF_FLOAT128__ && defined RNEAGEN_QUAD
typedef __float128 exact;
#define JUDGE_TEXT "quad precision, 113 bits"
#else
typedef real exact;
#define JUDGE_TEXT "extended precision: this build has no quad precision"
#endif

/* For one precision; all arrays are [sample][row of tau]. */
struct judge {
	enum rneagen_precision precision;
	struct states states; /* rounded to the type of numbers in memory */
	exact *tau;           /* the reference, on the same rounded states */
	double *size;         /* S_i: the magnitudes that are summed */
};

/* Over the samples of a judge. NAN where there is nothing to say: all reference torques are 0. */
struct judge_errors {
	double max, rms; /* of ||tau - ref|| / ||ref|| */
	double terms;    /* largest |tau_i - ref_i| / (eps S_i), eps of the numbers in memory */
};

/* Whether the numbers in memory are single precision. */
int judge_is_f32(enum rneagen_precision precision);

/* Draw the states, and evaluate. Returns 0 when memory runs out. */
int judge_open(struct judge *j, const struct analysis *a, enum rneagen_precision precision, const struct sample_options *o);
void judge_free(struct judge *j);

/* The largest bound of a sample, of its norm over the reference's, for the text that `o` asks for: NAN where none is
   known, or all reference torques are 0. Returns 0 when memory runs out. */
int judge_bound(const struct judge *j, const struct analysis *a, const struct rneagen_options *o, int on_gpu, double *max);

/* Torques [sample][row] of the judge's states. What is not finite is off by INFINITY. */
struct judge_errors judge_torques(const struct judge *j, const double *tau);

#endif
