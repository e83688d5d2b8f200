#ifndef RNEA_PACKING_H
#define RNEA_PACKING_H
/* Copies between the program's arrays and page-locked memory, by several threads: one alone cannot keep up with the bus. */

#include "cuda/device.h"
#include "core/workers.h"

/* Arrays that are packed or unpacked together; zero-initialise. */
struct packing {
	struct device_lines lines[RNEA_ARGUMENT_LIMIT];
	char *locked[RNEA_ARGUMENT_LIMIT];	/* where the lines of array k follow one another */
	size_t first[RNEA_ARGUMENT_LIMIT + 1];	/* array k has the pieces from first[k] on */
	size_t count, bytes;
	int in; /* into page-locked memory; else out of it */
};

/* One array more; RNEA_ARGUMENT_LIMIT at most. */
void packing_add(struct packing *p, const struct device_lines *l, char *locked);

/* Copy all of them; done when it returns. */
void packing_run(struct packing *p, struct workers *w);

#endif
