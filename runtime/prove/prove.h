#ifndef RUNTIME_PROVE_PROVE_H
#define RUNTIME_PROVE_PROVE_H
/* What holds for every state of a box: the ranges of outputs, and how far rounding takes a text off. Beside each stands
   what a search over the box has found. */

#include "range/box.h"
#include "rnearun/progress.h"

enum { PROVE_PRECISIONS = 4 };

struct prove_options {
	enum rneagen_precision precisions[PROVE_PRECISIONS];
	int precision_count;
	double seconds; /* for all of it, proof and search */
	unsigned threads; /* 0: one for each processor */
	double start;   /* since when the seconds count, as seconds_now has it; 0: since prove is called */
	/* the same outputs by the URDF's constants, for ranges, which are mostly closer so; NULL: as the text */
	const struct analysis *stated;
	struct record *record; /* what a certificate needs to know, for the DAG's outputs; NULL: nothing */
};

/* Why an error is not bounded: a value leaves the numbers of the arithmetic, or of the memory; an angle what sines
   take; an operation is none of those whose rounding is bounded. */
enum prove_why { PROVE_BOUNDED, PROVE_OVERFLOW, PROVE_STORED, PROVE_ANGLE, PROVE_OPERATION };

struct prove_gap {
	enum prove_why why;
	uint32_t node;     /* of the DAG */
	double size, most; /* what it may reach, and what there is room for */
};

/* One row of an output. */
struct prove_row {
	double low, high;             /* of the exact value, over the whole box */
	double found_low, found_high; /* that a search has found */
	double plain;                 /* plain intervals bound its magnitude by this */
	double error_bound[PROVE_PRECISIONS]; /* |text - exact| over the whole box; INFINITY: none is known */
	struct prove_gap gaps[PROVE_PRECISIONS]; /* where no bound is known */
	double error_found[PROVE_PRECISIONS]; /* the largest bound of a single state that a search has found */
};

struct proof {
	struct prove_row *rows; /* in the order of the DAG's outputs; the caller frees them */
};

/* For the text that a->options ask for, but for its precision. Errors: UNSUPPORTED, LIMIT, MEMORY. */
enum rneagen_code prove(struct proof *p, const struct analysis *a, const struct box *b, const struct prove_options *o,
	struct progress *progress, struct rneagen_error *e);

#endif
