#ifndef RUNTIME_JUDGE_H
#define RUNTIME_JUDGE_H
/* How far outputs are off: the DAG evaluated in more precision than any text has, over the samples of one set. */

#include "passes/analysis.h"
#include "draw/draw.h"

struct workers;

#if defined __SIZEOF_FLOAT128__ && defined RNEAGEN_QUAD
typedef __float128 exact;
#define JUDGE_TEXT "quad precision, 113 bits"
#else
typedef real exact;
#define JUDGE_TEXT "extended precision: this build has no quad precision"
#endif

/* One output array: its rows among those of all. */
struct judge_output {
	int argument; /* of the DAG */
	size_t first, rows;
	int is_bound; /* of what qdd is off: it is nothing that could be off itself, but what qdd is held against */
};

/* For one precision; out and size are [sample][row], the rows of all output arrays after one another. */
struct judge {
	enum rneagen_precision precision;
	struct arena arena;  /* of the inputs */
	struct drawn inputs; /* rounded to the type of numbers in memory */
	size_t count, rows;
	struct judge_output outputs[DAG_ARGUMENTS];
	int output_count;
	const struct judge_output *qdd; /* NULL: it is no output */
	struct workers *workers; /* share the samples */
	exact *out;   /* the reference, on the same rounded inputs */
	double *size; /* S_i: the magnitudes that are summed */
};

/* Over the samples of a judge, each by its worst output array; one that is 0 as its reference is is not off. NAN where there is
   nothing to say: all references are 0, and no array that is compared with them is. */
struct judge_errors {
	double max, rms; /* of ||out - ref|| / ||ref||; for the plain torques of a robot, ||tau - ref|| / ||ref|| */
	double terms;    /* largest |out_i - ref_i| / (eps S_i), eps of the numbers in memory */
};

/* Whether the numbers in memory are single precision. */
int judge_is_f32(enum rneagen_precision precision);

/* Draw the inputs, and evaluate, by as many threads as workers_open takes. Returns 0 when memory runs out. */
int judge_open(struct judge *j, const struct analysis *a, enum rneagen_precision precision, const struct draw_options *o,
	unsigned threads);
void judge_free(struct judge *j);

/* The largest norm of an output array's reference in the samples. */
double judge_scale(const struct judge *j, const struct judge_output *o);

/* The largest bound of a sample, of an output array's norm over the reference's, for the text that `o` asks for: of the
   distance from what the URDF's decimals give, as eval_bound has it. NAN where none is known, or all references are 0 and no
   bound is. Returns 0 when memory runs out. */
int judge_bound(const struct judge *j, const struct analysis *a, const struct rneagen_options *o, int on_gpu, double *max);

/* Is any output judged? A bound alone is none. */
int judge_has_outputs(const struct dag *d);

/* Outputs [sample][row] of the judge's samples, as `out` is. What is not finite is off by INFINITY, and so is a qdd that is off
   by more than its bound, where that is an output too. */
struct judge_errors judge_results(const struct judge *j, const double *out);

#endif
