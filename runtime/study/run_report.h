#ifndef RUNTIME_RUN_REPORT_H
#define RUNTIME_RUN_REPORT_H

#include "ranks/ranks.h"

/* rnearun report: every variant of a robot, its speed and its error. argv[0] is "report"; returns the exit status. */
int run_report(struct ranks *ranks, int argc, char **argv);

#endif
