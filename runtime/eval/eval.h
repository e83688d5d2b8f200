#ifndef RUNTIME_EVAL_H
#define RUNTIME_EVAL_H
/* What the parts of rnearun eval share. */

#include "eval/arrays.h"
#include "eval/devices.h"
#include "eval/resume.h"
#include "rnearun/progress.h"

enum { EVAL_Q, EVAL_QD, EVAL_QDD, EVAL_PARTS };

extern const char *const EVAL_PART_NAMES[EVAL_PARTS]; /* "q", "qd", "qdd" */

/* NAME=FILE, as the command line has them. */
struct eval_words {
	const char *list[DAG_ARGUMENTS];
	size_t count;
};

struct eval {
	struct command command;
	const char *parts[EVAL_PARTS]; /* names of files */
	struct eval_words inputs, outputs;
	struct eval_devices devices;
	size_t slice;                  /* 0: as it comes */
	int resumes, goes_on;          /* --resume; there is something to go on with */
	struct file_content urdf;
	struct analysis analysis;
	struct signature signature;
	struct eval_arrays arrays;
	struct eval_resume resume;
	struct rneagen_result text;
	struct rnea_robot *robot;
	struct progress progress;
	struct rneagen_error error;
};

/* Take NAME=FILE: 0; 2 and a message. */
int eval_take_pair(struct eval_words *w, const char *name, const char *option, const char *word);

/* Note a file that is read, or written; NULL is none: -1, or the exit status and a message. What is written does not
   promise by its name what is not in it. */
int eval_note_input(struct eval *v, const char *what, const char *path);
int eval_note_output(struct eval *v, const char *what, const char *path);
int eval_note_parts(struct eval *v); /* what --resume, and ranks, write beside outputs */

/* Paths for arrays; then, whether what must have a file has one, and what has none is told. -1, or the exit status and
   a message. */
int eval_name_files(struct eval *v);
int eval_check_inputs(const struct eval *v);

#endif
