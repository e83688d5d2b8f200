#ifndef RNEA_TILES_H
#define RNEA_TILES_H
/* Tensor maps, by which a device's copy engine moves tiles: some rows of a block's samples. */

#include "cuda/device.h"

struct tile_map { /* CUtensorMap */
	_Alignas(64) unsigned char bytes[128];
};

/* Those of a function's kernels of parts, in blocks of so many threads. Returns 0 where these cannot run on such arrays, or so
   many samples, for rows have to begin at multiples of 16 bytes, or do not pay. A device without such an engine needs no maps. */
int tiles_make(struct tile_map maps[RNEA_TILE_LIMIT], const struct device *d, const struct rnea_function *f, void *const *arrays,
	size_t count);

#endif
