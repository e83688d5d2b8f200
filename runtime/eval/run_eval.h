#ifndef RUNTIME_RUN_EVAL_H
#define RUNTIME_RUN_EVAL_H

#include "ranks/ranks.h"

/* rnearun eval: torques for arrays on disk. argv[0] is "eval"; returns the exit status. */
int run_eval(struct ranks *ranks, int argc, char **argv);

#endif
