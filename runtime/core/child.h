#ifndef RNEA_CHILD_H
#define RNEA_CHILD_H
/* Another program, run to its end without a shell, or to that of this process. */

#include <stddef.h>

enum { CHILD_OUTPUT_LIMIT = 1 << 20 };

struct child {
	int status;   /* the exit status; CHILD_UNKNOWN: the process reaps its children elsewhere, so nobody can tell */
	int signal;   /* that killed it; 0: none */
	char *output; /* the first CHILD_OUTPUT_LIMIT bytes of both streams and a NUL; malloc */
};

enum { CHILD_UNKNOWN = -1 };

/* Who may end it, as rnea_options.stop has it. */
struct child_stop {
	int (*ask)(void *context); /* NULL: nobody */
	void *context;
};

/* Run the program at `path` with the arguments argv[0] to a NULL. It has this process' environment, with each of
   `variables` ("NAME=value", to a NULL) instead of the variable of that name, nothing to read, the default answers to
   all signals, and none of this process' descriptors where the C library can see to that. Other threads may do as they
   like meanwhile. With all that it starts it is a group of processes. Where `stop` (NULL: nobody) asks for its end the group is
   killed, and where this process ends before it SIGIO ends the group, but for programs that have closed their descriptor 3.
   Returns 0, with end->output to be freed, or the errno that kept the program from running. */
int child_run(const char *path, const char *const *argv, const char *const *variables, const struct child_stop *stop,
	struct child *end);

#endif
