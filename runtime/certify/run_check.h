#ifndef RUNTIME_CERTIFY_RUN_CHECK_H
#define RUNTIME_CERTIFY_RUN_CHECK_H

#include "ranks/ranks.h"

/* rnearun check-certificate: is it true? On the first rank. argv[0] is "check-certificate"; returns the exit status. */
int run_check(struct ranks *ranks, int argc, char **argv);

#endif
