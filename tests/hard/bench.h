#ifndef TESTS_HARD_BENCH_H
#define TESTS_HARD_BENCH_H
/* Errors of one case in one precision, by the evaluated DAG against the reference in quad precision. */

#include "cases.h"

enum { BENCH_SEED = 1 };

/* What one precision comes to. Errors are relative, in the 2-norm, where the true torques are not all zero. */
struct outcome {
	double max, rms;
	double model, arithmetic; /* what rounded constants do, computed exactly; what computing with them does */
	double terms;		  /* largest |tau_i - ref_i| / (eps S_i) */
	double of_max;		  /* largest bound of a sample over the largest error of one */
	double typical, least;	  /* bound / error: median of the samples, in norms; least of all torques */
	int broken, overflowed;	  /* torques beyond the bound, torques not finite */
};

/* *flops: operations, a fused one counted as two. */
struct outcome bench_measure(const struct hard_case *c, int f32, unsigned *flops);

#endif
