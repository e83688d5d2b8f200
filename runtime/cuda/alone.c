#include "cuda/alone.h"
#include "core/info_table.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static int find(struct alone *a, const struct device *d, const struct source *s, const char *function)
{
	struct rnea_error ignored = {0};

	for (unsigned i = 0; i < a->count; i++) {
		struct device_kernel *k = &a->kernels[i];
		char part[SOURCE_NAME_LIMIT];

		snprintf(part, sizeof part, "%s_part%u", function, i);
		source_symbol(s->name, part, "kernel", k->name);
		if (device_find(d, a->module, k, 0, &ignored) || !k->function || k->resources.max_block < a->block)
			return 0;
	}
	return 1;
}

void alone_load(struct alone *a, struct beside *b, const struct device *d, struct rnea_info *info, unsigned block)
{
	const struct rnea_function *f = info->functions;

	*a = (struct alone){.count = f->parts, .block = block, .least = f->part_kernels};
	if (a->least && (a->module = beside_load(b, d)) != NULL && (a->kernels = calloc(a->count, sizeof *a->kernels)) != NULL &&
		find(a, d, b->request.source, f->name))
		return;
	device_unload(d, a->module);
	alone_free(a);
	rnea_info_without_part_kernels(info);
}

enum rnea_code alone_launch(const struct alone *a, const struct device *d, void **parameters, size_t count, void *stream,
	struct rnea_error *e)
{
	for (unsigned i = 0; i < a->count && !e->code; i++)
		device_launch(d, &a->kernels[i], device_blocks(count, a->block), 1, a->block, parameters, stream, e);
	return e->code;
}

void alone_free(struct alone *a)
{
	free(a->kernels);
	memset(a, 0, sizeof *a);
}
