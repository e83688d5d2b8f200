#ifndef RUNTIME_EVAL_ARRAYS_H
#define RUNTIME_EVAL_ARRAYS_H
/* The arrays of rnearun eval: which file each one is read from or written to. */

#include "cli/pending.h"
#include "ranks/ranks.h"
#include "rnearun/npy.h"
#include "rnearun/signature.h"

/* A pipe, a device or standard output is written in order, through f; any other file at the samples' places, through `file`. */
struct eval_sink {
	const char *path;       /* NULL: there is none */
	FILE *f;
	struct pending pending;
	struct ranks_file *file;
	int is_other;           /* another process has begun it */
	size_t rows;
	uint64_t data;          /* the byte where the first sample goes */
};

/* Zero, then what the command line says: in, out, paths. */
struct eval_arrays {
	const struct signature *s;
	const char *in, *out;             /* all inputs of samples that have no path, all outputs; NULL: none */
	const char *paths[DAG_ARGUMENTS]; /* of single arrays; NULL: none */
	enum rnea_scalar scalar;          /* of what is computed and written */
	struct npy all, files[DAG_ARGUMENTS];
	const struct npy *first;          /* whose samples are counted; NULL: there is one, which nothing is read for */
	struct eval_sink joined, sinks[DAG_ARGUMENTS];
};

/* Is input i one of those that `in` has? */
int eval_is_joined(const struct eval_arrays *a, size_t i);

/* Is input i read a slice at a time, and not one for all samples? */
int eval_is_read_by_sample(const struct eval_arrays *a, size_t i);

/* Open what is to be read. *is_wide: double precision is among it. Errors: READ, MEMORY. */
enum rneagen_code eval_open_inputs(struct eval_arrays *a, int *is_wide, struct rneagen_error *e);

/* Where outputs go, from the command line's names; what links lead to is of the arena. */
void eval_name_sinks(struct eval_arrays *a, struct arena *arena);

/* After that: the outputs that are written, joined and single, in the order of the arrays, to `sinks`;
   returns how many. */
size_t eval_sinks(struct eval_arrays *a, struct eval_sink *sinks[DAG_ARGUMENTS + 1]);

/* Is everything read and written at places, in any order? Else the message says what is not. Error: USAGE. */
enum rneagen_code eval_check_places(struct eval_arrays *a, struct rneagen_error *e);

/* Have the files the shapes that the arrays of `robot` need? Error: READ, which names array and shape. */
enum rneagen_code eval_check_shapes(const struct eval_arrays *a, const char *robot, struct rneagen_error *e);

uint64_t eval_samples(const struct eval_arrays *a);
size_t eval_scalar_size(const struct eval_arrays *a);

/* Bytes of an output's file with so many samples, its header among them. */
uint64_t eval_bytes(const struct eval_arrays *a, const struct eval_sink *s, uint64_t samples);

/* How an output file is begun. */
enum eval_begin {
	EVAL_ALONE, /* under a name that nobody else knows */
	EVAL_PART,  /* as PATH.part, for ranks, or for another run to go on with */
	EVAL_GO_ON, /* PATH.part is there and stays */
};

/* Begin the files that are written, in one process; write their headers there, and have the other processes know how
   long they are; then open them in every process for the samples. Unless they stay, a signal removes also what another
   process has begun. Errors: WRITE, LIMIT, MEMORY. */
enum rneagen_code eval_open_outputs(struct eval_arrays *a, enum eval_begin begin, struct rneagen_error *e);
enum rneagen_code eval_put_headers(struct eval_arrays *a, struct rneagen_error *e);
enum rneagen_code eval_join_outputs(struct eval_arrays *a, struct ranks *r, int stays, struct rneagen_error *e);

/* What this process has written is on the disk. Error: WRITE. */
enum rneagen_code eval_sync(struct eval_arrays *a, struct rneagen_error *e);

/* All is written: close the files that eval_join_outputs opened; then, in the process that began them, give them their names.
   Error: WRITE. */
enum rneagen_code eval_leave(struct eval_arrays *a, struct rneagen_error *e);
enum rneagen_code eval_finish(struct eval_arrays *a, struct rneagen_error *e);

/* Outputs that are not finished stay, as PATH.part. */
void eval_keep(struct eval_arrays *a);

/* Close everything; what was not finished is gone, unless it stays, or another process has begun it. */
void eval_close(struct eval_arrays *a);

#endif
