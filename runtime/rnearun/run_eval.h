#ifndef RUNTIME_RUN_EVAL_H
#define RUNTIME_RUN_EVAL_H

/* rnearun eval: torques for arrays on disk. argv[0] is "eval"; returns the exit status. */
int run_eval(int argc, char **argv);

#endif
