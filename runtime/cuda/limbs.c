#include "cuda/limbs.h"
#include "core/info_table.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static void *compile(void *build)
{
	struct limbs_build *b = build;
	struct rnea_error ignored = {0};

	if (!image_compile(&b->request, 0, 0, &b->image, &ignored))
		image_keep(&b->request, b->key, b->key_length, &b->image);
	return NULL;
}

int limbs_begin(struct limbs_build *b, const struct image_request *r)
{
	memset(b, 0, sizeof *b);
	if (!image_has_limbs(r))
		return 0;
	b->request = *r;
	b->request.half = IMAGE_LIMBS;
	b->request.block = 0; /* it has blocks of its own */
	b->request.log = NULL;
	b->request.unkept = NULL;
	b->key = image_key(&b->request, &b->key_length);
	b->cached = image_get(r->cache, b->key, b->key_length, &b->image);
	if (!b->cached)
		b->has_thread = pthread_create(&b->thread, NULL, compile, b) == 0;
	return 1;
}

static void wait_for(struct limbs_build *b)
{
	if (b->has_thread)
		pthread_join(b->thread, NULL);
	b->has_thread = 0;
}

static int load_image(struct limbs *l, const struct limbs_build *b, const struct device *d)
{
	struct rnea_error ignored = {0};

	return b->image.code.data && !device_load(d, b->image.code.data, b->request.source->name, &l->module, &ignored);
}

/* What was kept and the driver refuses is compiled again. */
static int load(struct limbs *l, struct limbs_build *b, const struct device *d)
{
	wait_for(b);
	if (load_image(l, b, d))
		return 1;
	if (!b->cached)
		return 0;
	image_free(&b->image);
	b->cached = 0;
	compile(b);
	return load_image(l, b, d);
}

static int find(struct limbs_kernel *l, void *module, const struct device *d, const struct source *s, const char *function,
	const struct rnea_limbs *info)
{
	struct rnea_error ignored = {0};

	source_symbol(s->name, function, "limbs", l->one.name);
	if (device_find(d, module, &l->one, 0, &ignored) || !l->one.function ||
		l->one.resources.max_block < LIMBS_LANES * info->warps * info->groups)
		return 0;
	l->all = l->one;
	l->one.given_bytes = info->bytes;
	l->all.given_bytes = info->bytes * info->groups;
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

void limbs_load(struct limbs *l, struct limbs_build *b, const struct device *d, struct rnea_info *info)
{
	const struct rnea_function *f = info->functions;

	memset(l, 0, sizeof *l);
	if (f->limbs.warps && b->request.source && load(l, b, d) && find_all(l, d, b->request.source, f))
		return;
	device_unload(d, l->module);
	memset(l, 0, sizeof *l);
	rnea_info_without_limbs(info);
}

void limbs_end(struct limbs_build *b)
{
	wait_for(b);
	image_free(&b->image);
	free(b->key);
	memset(b, 0, sizeof *b);
}

enum rnea_code limbs_launch(const struct limbs_kernel *l, const struct device *d, void **parameters, size_t count, void *stream,
	struct rnea_error *e)
{
	unsigned groups = count <= LIMBS_LANES ? 1 : l->info.groups, samples = groups * LIMBS_LANES;

	return device_launch(d, groups == 1 ? &l->one : &l->all, device_blocks(count, samples), l->info.parts,
		samples * l->info.warps, parameters, stream, e);
}
