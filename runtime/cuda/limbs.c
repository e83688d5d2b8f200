#include "cuda/limbs.h"
#include "core/info_table.h"
#include <stdio.h>
#include <string.h>

static int find(struct limbs_kernel *l, void *module, const struct device *d, const struct source *s, const char *function,
	const struct rnea_limbs *info)
{
	struct rnea_error ignored = {0};
	size_t bytes = info->bytes * info->groups;

	source_symbol(s->name, function, "limbs", l->one.name);
	if (device_find(d, module, &l->one, bytes, &ignored) || !l->one.function ||
		l->one.resources.max_block < LIMBS_LANES * info->warps * info->groups || (bytes > OWN_SHARED && !l->one.given_bytes))
		return 0;
	l->all = l->one;
	l->one.given_bytes = info->bytes;
	l->all.given_bytes = bytes;
	l->info = *info;
	return 1;
}

static int find_all(struct limbs *l, const struct device *d, const struct source *s, const struct rnea_function *f)
{
	char start[SOURCE_NAME_LIMIT];

	if (!find(&l->own, l->module, d, s, f->name, &f->limbs))
		return 0;
	if (!f->start_limbs.warps)
		return 1;
	snprintf(start, sizeof start, "%s_start", f->name);
	return find(&l->start, l->module, d, s, start, &f->start_limbs);
}

void limbs_load(struct limbs *l, struct beside *b, const struct device *d, struct rnea_info *info)
{
	const struct rnea_function *f = info->functions;

	memset(l, 0, sizeof *l);
	if (f->limbs.warps && (l->module = beside_load(b, d)) != NULL && find_all(l, d, b->request.source, f))
		return;
	device_unload(d, l->module);
	memset(l, 0, sizeof *l);
	rnea_info_without_limbs(info);
}

enum rnea_code limbs_launch(const struct limbs_kernel *l, const struct device *d, void **parameters, size_t count, void *stream,
	struct rnea_error *e)
{
	unsigned groups = count <= LIMBS_LANES ? 1 : l->info.groups, samples = groups * LIMBS_LANES;

	return device_launch(d, groups == 1 ? &l->one : &l->all, device_blocks(count, samples), l->info.parts,
		samples * l->info.warps, parameters, stream, e);
}
