#ifndef RUNTIME_EVAL_RESUME_H
#define RUNTIME_EVAL_RESUME_H
/* The side file of --resume, OUT.resume: how many samples of OUT.part are complete, and what they were made of. A few
   lines of text; it is gone when OUT is complete. */

#include "eval/arrays.h"
#include "base/text.h"

struct eval_resume {
	struct arena arena;
	const char *path;    /* of the side file */
	struct text made_of; /* lines of version, text, inputs and outputs */
	int fd;              /* -1: closed */
	uint64_t done;       /* samples complete, from the first on */
};

/* Of the first output that is written, which there is; private until eval_resume_close. Error: MEMORY. */
enum rneagen_code eval_resume_open(struct eval_resume *r, struct eval_arrays *a, struct rneagen_error *e);

/* Is there something to go on with: a side file, and each output's PATH.part? */
int eval_resume_is_there(struct eval_resume *r, struct eval_arrays *a);

/* What this run is: of which bytes, the URDF's and the generated text's, and which files. Errors: READ, MEMORY. */
enum rneagen_code eval_resume_describe(
	struct eval_resume *r, struct eval_arrays *a, const char *urdf, size_t length, const char *text, struct rneagen_error *e);

/* Read how many samples are complete. Error: READ: the side file is of another run, and the message says by what. */
enum rneagen_code eval_resume_read(struct eval_resume *r, struct eval_arrays *a, struct rneagen_error *e);

/* Begin a side file: none are complete. Error: WRITE. */
enum rneagen_code eval_resume_begin(struct eval_resume *r, struct rneagen_error *e);

/* So many are, and are on the disk. Error: WRITE. */
enum rneagen_code eval_resume_record(struct eval_resume *r, uint64_t done, struct rneagen_error *e);

/* Take the side file of an earlier run away, if there is one. Error: WRITE: what stands there is no such file. */
enum rneagen_code eval_resume_clear(const struct eval_resume *r, struct rneagen_error *e);

void eval_resume_remove(const struct eval_resume *r);
void eval_resume_close(struct eval_resume *r);

#endif
