#include "cuda/alone.h"
#include "cuda/compile/macros.h"
#include "cuda/relay.h"
#include "core/info_table.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* In blocks of as many threads as the program was made for. */
static int find(struct alone *a, const struct beside *b, const struct device *d, const struct rnea_function *f)
{
	const struct source *s = b->request.source;
	struct rnea_error ignored = {0};

	a->block = b->request.block ? b->request.block : macro_value(s, "RNEA_BLOCK");
	for (unsigned i = 0; i < a->count; i++) {
		char which[16];

		snprintf(which, sizeof which, "part%u", i);
		if (relay_kernel(d, a->module, s, f, which, 0, &a->kernels[i], &ignored) ||
			a->kernels[i].resources.max_block < a->block)
			return 0;
	}
	return 1;
}

void alone_load(struct alone *a, struct beside *b, const struct device *d, struct rnea_info *info)
{
	const struct rnea_function *f = info->functions;

	*a = (struct alone){.count = f->parts, .least = f->part_kernels};
	if (a->least && (a->module = beside_load(b, d)) != NULL && (a->kernels = calloc(a->count, sizeof *a->kernels)) != NULL &&
		find(a, b, d, f))
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
