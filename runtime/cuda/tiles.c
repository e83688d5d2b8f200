#include "cuda/tiles.h"
#include <stdint.h>

/* Of cuda.h; the first devices with the engine. */
enum { DATA_TYPE_FLOAT32 = 7, DATA_TYPE_FLOAT64 = 8, FIRST_ARCH = 90 };

static int make(struct tile_map *map, const struct device *d, const struct rnea_argument *a, const struct rnea_tile *t,
	unsigned block, void *array, size_t count)
{
	int is_double = a->scalar == RNEA_F64;
	const uint64_t size[] = {count, a->rows}, pitch[] = {count * (is_double ? sizeof(double) : sizeof(float))};
	const uint32_t box[] = {block, t->rows}, step[] = {1, 1};

	return !d->api.tensor_map_encode_tiled(
		map, is_double ? DATA_TYPE_FLOAT64 : DATA_TYPE_FLOAT32, 2, array, size, pitch, box, step, 0, 0, 0, 0);
}

int tiles_make(struct tile_map maps[RNEA_TILE_LIMIT], const struct device *d, const struct rnea_function *f, void *const *arrays,
	size_t count)
{
	if (d->arch < FIRST_ARCH)
		return d->arch >= (int)f->part_arch;
	if (f->tile_count && (!d->api.tensor_map_encode_tiled || count > (size_t)INT32_MAX - f->part_block))
		return 0;
	for (unsigned i = 0; i < f->tile_count; i++) {
		const struct rnea_tile *t = &f->tiles[i];

		if (!make(&maps[i], d, &f->arguments[t->argument], t, f->part_block, arrays[t->argument], count))
			return 0;
	}
	return 1;
}
