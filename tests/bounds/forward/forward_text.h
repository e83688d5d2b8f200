#ifndef TESTS_BOUNDS_FORWARD_TEXT_H
#define TESTS_BOUNDS_FORWARD_TEXT_H
/* A text with three inputs of joints, one output and its bounds, compiled: --bounded, or --want qdd,qdd_bound. */

#include "target/target.h"
#include "solved.h"

struct forward_kind {
	const char *name;
	struct rneagen_options options;
	const char *flags[3];
};

struct forward_text {
	struct target target; /* its text and messages alone */
	void *library;
	union {
		void *address;
		void (*single)(const float *, const float *, const float *, float *);
		void (*wide)(const double *, const double *, const double *, double *);
	} plain; /* without bounds */
	union {
		void *address;
		void (*single)(const float *, const float *, const float *, float *, float *);
		void (*wide)(const double *, const double *, const double *, double *, double *);
	} bounded;
};

/* `function`: what is called with the bounds; `plain`: the same without, NULL: there is none. */
void forward_text_open(struct forward_text *x, const char *urdf, const struct rneagen_options *o, const struct forward_kind *kind,
	const char *function, const char *plain, const char *what);
void forward_text_close(struct forward_text *x);

/* The numbers of a sample, and how many. `in` are three arrays. The text's output and bound; the output once more, by the
   function without bounds, must have the same bits. */
void forward_text_run(const struct forward_text *x, const double *const *in, const int *rows, double *out, double *bound);

/* Prints and adds up how close bounds are. */
struct closeness {
	long finite, count;
	double error, bound, share; /* the largest error and finite bound; error over bound */
};

void closeness_add(struct closeness *c, const struct forward_text *x, int n, const double *got, const double *bound,
	const __float128 *want);
void closeness_print(const struct closeness *c, const struct forward_text *x);

#endif
