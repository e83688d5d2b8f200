#ifndef RNEA_ALONE_H
#define RNEA_ALONE_H
/* Kernels of the parts of the first function, each alone, which a launch of a large batch runs one after the other instead of the
   one kernel that has all parts along y. A robot without them runs all the same: what fails here is no failure of its opening,
   and the info then tells of no such kernels. */

#include "cuda/beside.h"
#include "cuda/tiles.h"

struct alone {
	const struct rnea_function *function; /* which tells how many there are, and from how many samples on; NULL: there are none */
	void *module;
	struct device_kernel *kernels;
};

/* Wait for the program, load it, and find what *info says of it; where that fails, *info says no more. The context must be
   current. */
void alone_load(struct alone *a, struct beside *b, const struct device *d, struct rnea_info *info);

/* Do they serve a launch over these arrays? Then maps are what they take beside its parameters. */
int alone_serve(
	const struct alone *a, const struct device *d, void *const *arrays, size_t count, struct tile_map maps[RNEA_TILE_LIMIT]);

/* With the maps after the other parameters. */
enum rnea_code alone_launch(const struct alone *a, const struct device *d, void **parameters, size_t count, void *stream,
	struct rnea_error *e);

/* Free what it took, but for the module. */
void alone_free(struct alone *a);

#endif
