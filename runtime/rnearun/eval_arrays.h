#ifndef RUNTIME_EVAL_ARRAYS_H
#define RUNTIME_EVAL_ARRAYS_H
/* The arrays of rnearun eval: which file each one is read from or written to, a slice of the samples at a time. */

#include "rnearun/npy.h"
#include "cli/pending.h"
#include "rnearun/signature.h"

struct eval_sink {
	const char *path;
	FILE *f; /* NULL: there is none */
	struct pending pending;
};

/* Zero, then what the command line says: in, out, paths. */
struct eval_arrays {
	const struct signature *s;
	const char *in, *out;             /* all inputs of samples that have no path, all outputs; NULL: none */
	const char *paths[DAG_ARGUMENTS]; /* of single arrays; NULL: none */
	enum rnea_scalar scalar;          /* of data, and of what is written */
	size_t slice;                     /* samples; 0: so many as SLICE_BYTES hold */
	struct npy all, files[DAG_ARGUMENTS];
	const struct npy *first;          /* whose samples are counted; NULL: there is one, which nothing is read for */
	struct eval_sink joined, sinks[DAG_ARGUMENTS];
	void *data[DAG_ARGUMENTS], *gathered; /* in the order of rnea_info(); outputs joined */
};

/* Is input i one of those that `in` has? */
int eval_is_joined(const struct eval_arrays *a, size_t i);

/* Open what is to be read. *is_wide: double precision is among it. Errors: READ, MEMORY. */
enum rneagen_code eval_open_inputs(struct eval_arrays *a, int *is_wide, struct rneagen_error *e);
enum rneagen_code eval_open_outputs(struct eval_arrays *a, struct rneagen_error *e);

/* Have the files the shapes that the arrays of `robot` need? Error: READ, which names array and shape. */
enum rneagen_code eval_check_shapes(const struct eval_arrays *a, const char *robot, struct rneagen_error *e);

/* Make room for a slice, and fill what does not come from files of samples. Errors: MEMORY, READ. */
enum rneagen_code eval_make(struct eval_arrays *a, struct rneagen_error *e);

uint64_t eval_samples(const struct eval_arrays *a);
void eval_put_headers(struct eval_arrays *a);
enum rneagen_code eval_read(struct eval_arrays *a, size_t count, struct rneagen_error *e);
enum rneagen_code eval_write(struct eval_arrays *a, size_t count, struct rneagen_error *e);

/* All that is written takes its name. Error: WRITE. */
enum rneagen_code eval_finish(struct eval_arrays *a, struct rneagen_error *e);

/* Close everything; what was not finished is gone. */
void eval_close(struct eval_arrays *a);

#endif
