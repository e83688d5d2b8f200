#ifndef RUNTIME_PROVE_RUN_PROVE_H
#define RUNTIME_PROVE_RUN_PROVE_H

/* rnearun prove: what holds for every state within the limits. argv[0] is "prove"; returns the exit status. */
int run_prove(int argc, char **argv);

#endif
