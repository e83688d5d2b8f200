#ifndef RUNTIME_PROVED_RUN_PROVE_H
#define RUNTIME_PROVED_RUN_PROVE_H

#include "ranks/ranks.h"

/* rnearun prove: what holds for every state within the limits, on the first rank. argv[0] is "prove"; returns the exit status. */
int run_prove(struct ranks *ranks, int argc, char **argv);

#endif
