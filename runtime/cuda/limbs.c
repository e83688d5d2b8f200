#include "cuda/limbs.h"
#include "core/info_table.h"
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

static int find(struct limbs *l, const struct device *d, const struct source *s, const struct rnea_function *f)
{
	struct rnea_error ignored = {0};

	source_symbol(s->name, f->name, "limbs", l->one.name);
	if (device_find(d, l->module, &l->one, 0, &ignored) || !l->one.function ||
		l->one.resources.max_block < LIMBS_LANES * f->limbs * f->limb_groups)
		return 0;
	l->all = l->one;
	l->one.given_bytes = f->limb_bytes;
	l->all.given_bytes = f->limb_bytes * f->limb_groups;
	l->warps = f->limbs;
	l->groups = f->limb_groups;
	l->most = f->limb_most;
	return 1;
}

void limbs_load(struct limbs *l, struct limbs_build *b, const struct device *d, struct rnea_info *info)
{
	const struct rnea_function *f = info->functions;

	memset(l, 0, sizeof *l);
	if (f->limbs && b->request.source && load(l, b, d) && find(l, d, b->request.source, f))
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
