#include "cuda/alone.h"
#include "cuda/relay.h"
#include "core/info_table.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static int find(struct alone *a, const struct beside *b, const struct device *d, const struct rnea_function *f)
{
	const struct source *s = b->request.source;
	struct rnea_error ignored = {0};

	for (unsigned i = 0; i < f->part_count; i++) {
		char which[16];

		snprintf(which, sizeof which, "part%u", i);
		if (relay_kernel(d, a->module, s, f, which, 0, &a->kernels[i], &ignored) ||
			a->kernels[i].resources.max_block < f->part_block)
			return 0;
	}
	return 1;
}

void alone_load(struct alone *a, struct beside *b, const struct device *d, struct rnea_info *info)
{
	const struct rnea_function *f = info->functions;

	*a = (struct alone){.function = f};
	if (f->part_kernels && (a->module = beside_load(b, d)) != NULL &&
		(a->kernels = calloc(f->part_count, sizeof *a->kernels)) != NULL && find(a, b, d, f))
		return;
	device_unload(d, a->module);
	alone_free(a);
	rnea_info_without_part_kernels(info);
}

int alone_serve(
	const struct alone *a, const struct device *d, void *const *arrays, size_t count, struct tile_map maps[RNEA_TILE_LIMIT])
{
	return a->function && count >= a->function->part_kernels && tiles_make(maps, d, a->function, arrays, count);
}

enum rnea_code alone_launch(const struct alone *a, const struct device *d, void **parameters, size_t count, void *stream,
	struct rnea_error *e)
{
	const struct rnea_function *f = a->function;

	for (unsigned i = 0; i < f->part_count && !e->code; i++)
		device_launch(d, &a->kernels[i], device_blocks(count, f->part_block), 1, f->part_block, parameters, stream, e);
	return e->code;
}

void alone_free(struct alone *a)
{
	free(a->kernels);
	memset(a, 0, sizeof *a);
}
