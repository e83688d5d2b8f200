#ifndef RUNTIME_RUN_CHOOSE_H
#define RUNTIME_RUN_CHOOSE_H

/* rnearun choose: the fastest variant that is close enough. argv[0] is "choose"; returns the exit status. */
int run_choose(int argc, char **argv);

#endif
