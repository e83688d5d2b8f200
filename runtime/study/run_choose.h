#ifndef RUNTIME_RUN_CHOOSE_H
#define RUNTIME_RUN_CHOOSE_H

#include "ranks/ranks.h"

/* rnearun choose: the fastest variant that is close enough. argv[0] is "choose"; returns the exit status. */
int run_choose(struct ranks *ranks, int argc, char **argv);

#endif
