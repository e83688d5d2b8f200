#ifndef TESTS_MODEL_H
#define TESTS_MODEL_H
/* A URDF taken through the generator's passes and through the reference, for tests that compare the two. */

#include "emit/emit.h"
#include "dag/eval.h"
#include "reference/reference.h"
#include "dynamics/registry.h"
#include "support/read.h"

/* The DAGs of a model are by their number in the registry: the torques' and the halves'. */
enum { MODEL_DAGS = ALGORITHM_bpass + 1 };

struct model {
	struct arena arena;
	struct robot robot;
	struct tree tree;
	struct request request;
	struct dag raw[MODEL_DAGS], dag[MODEL_DAGS];
	struct reference *reference;
};

/* Aborts the test with a message when the text is refused; `what` names it. */
void model_open(struct model *m, const char *urdf, size_t length, const struct rneagen_options *o, const char *what);
void model_close(struct model *m);

/* Errors of the DAG evaluated in one precision over seeded samples. */
struct model_error {
	double max, rms;    /* of ||tau - ref|| / ||ref||; 0 where both are zero */
	double terms;       /* largest |tau_i - ref_i| / (eps S_i), S_i the magnitudes that were summed */
	double bound;       /* largest |tau_i - ref_i| over the running error bound: above 1, the bound is wrong */
};

struct model_error model_error_f64(struct model *m, uint64_t seed, int samples);
struct model_error model_error_f32(struct model *m, uint64_t seed, int samples);

#endif
