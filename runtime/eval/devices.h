#ifndef RUNTIME_EVAL_DEVICES_H
#define RUNTIME_EVAL_DEVICES_H
/* The GPUs of rnearun eval: one, or several that take slices side by side. */

#include "ranks/ranks.h"
#include "rnearun/command.h"

enum { EVAL_DEVICES = 64 };

struct eval_devices {
	int is_named, are_all;  /* by --device; by --device all */
	int list[EVAL_DEVICES]; /* `count` of them; a device may stand here twice */
	size_t count;
};

/* The word of --device: all, or numbers by commas. 0; 2 and a message. */
int eval_devices_take(struct eval_devices *d, const char *command, const char *word);

/* From what the command line names to what this rank takes, one at least: named devices are shared out among the ranks
   of a machine; where none is named each rank has its own, as far as there are. */
void eval_devices_choose(struct eval_devices *d, enum rnea_backend backend, const struct ranks *r);

#endif
