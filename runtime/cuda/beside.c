#include "cuda/beside.h"
#include <stdlib.h>
#include <string.h>

static void *compile(void *build)
{
	struct beside *b = build;
	struct rnea_error ignored = {0};

	if (!image_compile(&b->request, b->request.block, 0, &b->image, &ignored))
		image_keep(&b->request, b->key, b->key_length, &b->image);
	return NULL;
}

int beside_begin(struct beside *b, const struct image_request *r, enum image_share share)
{
	memset(b, 0, sizeof *b);
	if (!image_has(r, share))
		return 0;
	b->request = *r;
	b->request.share = share;
	b->request.block = 0;
	b->request.log = NULL;
	b->request.unkept = NULL;
	b->key = image_key(&b->request, &b->key_length);
	b->cached = image_get(r->cache, b->key, b->key_length, &b->image);
	if (!b->cached)
		b->has_thread = pthread_create(&b->thread, NULL, compile, b) == 0;
	return 1;
}

static void wait_for(struct beside *b)
{
	if (b->has_thread)
		pthread_join(b->thread, NULL);
	b->has_thread = 0;
}

static void *load_image(const struct beside *b, const struct device *d)
{
	struct rnea_error ignored = {0};
	void *module = NULL;

	if (b->image.code.data && device_load(d, b->image.code.data, b->request.source->name, &module, &ignored))
		module = NULL;
	return module;
}

/* What was kept and the driver refuses is compiled again. */
void *beside_load(struct beside *b, const struct device *d)
{
	void *module;

	if (!b->request.source)
		return NULL;
	wait_for(b);
	if ((module = load_image(b, d)) != NULL || !b->cached)
		return module;
	image_free(&b->image);
	b->cached = 0;
	compile(b);
	return load_image(b, d);
}

void beside_end(struct beside *b)
{
	wait_for(b);
	image_free(&b->image);
	free(b->key);
	memset(b, 0, sizeof *b);
}
