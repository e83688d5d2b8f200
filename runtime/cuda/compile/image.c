#include "cuda/compile/image.h"
#include "cuda/compile/macros.h"
#include "cuda/compile/nvrtc.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const char bound_macro[] = "RNEA_MIN_BLOCKS";

static const char *bound_option(const struct image_request *r)
{
	for (size_t i = 0; i < r->option_count; i++)
		if (strstr(r->options[i], bound_macro))
			return r->options[i];
	return NULL;
}

int image_is_bound(const struct image_request *r)
{
	return bound_option(r) != NULL;
}

unsigned image_bound(const struct image_request *r, unsigned block)
{
	const char *option = bound_option(r);
	const char *value = option ? strchr(strstr(option, bound_macro), '=') : NULL;

	if (option)
		return value ? (unsigned)strtoul(value + 1, NULL, 10) : 1;
	return macro_min_blocks(r->source, block);
}

/* What leaves a share out; the macro that a text with such kernels defines; what leaves all others out. */
static const struct {
	const char *without, *macro, *only;
} shares[] = {[IMAGE_LIMBS] = {"-DRNEA_NO_LIMBS", "RNEA_LIMBS", "-DRNEA_ONLY_LIMBS"},
	[IMAGE_ALONE] = {"-DRNEA_NO_PART_KERNELS", "RNEA_PART_KERNELS", "-DRNEA_ONLY_PART_KERNELS"}};

int image_has(const struct image_request *r, enum image_share share)
{
	for (size_t i = 0; i < r->option_count; i++)
		if (strstr(r->options[i], shares[share].without + strlen("-D")))
			return 0;
	return macro_number(r->source, shares[share].macro) > 0;
}

/* Appends one or two. */
static size_t put_share(enum image_share share, const char **options)
{
	switch (share) {
	case IMAGE_ALL:
		return 0;
	case IMAGE_MAIN:
		options[0] = shares[IMAGE_LIMBS].without;
		options[1] = shares[IMAGE_ALONE].without;
		return 2;
	default:
		options[0] = shares[share == IMAGE_LIMBS ? IMAGE_ALONE : IMAGE_LIMBS].without;
		options[1] = shares[share].only;
		return 2;
	}
}

enum rnea_code image_compile(
	const struct image_request *r, unsigned block, int unbounded, struct image *i, struct rnea_error *e)
{
	const char **options = calloc(r->option_count + 4, sizeof *options);
	struct jit_request j = {.source = r->source->text,
		.file = r->file,
		.arch = r->arch,
		.options = options,
		.option_count = r->option_count,
		.log = r->log,
		.log_size = r->log_size};
	char define[40];

	memset(i, 0, sizeof *i);
	if (!options)
		return rnea_error_memory(e);
	for (size_t o = 0; o < r->option_count; o++)
		options[o] = r->options[o];
	if (block) {
		snprintf(define, sizeof define, "-DRNEA_BLOCK=%u", block);
		options[j.option_count++] = define;
	}
	if (unbounded)
		options[j.option_count++] = "-DRNEA_MIN_BLOCKS=0";
	j.option_count += put_share(r->share, options + j.option_count);
	if (!jit_compile(&j, &i->code, e)) {
		i->block = block;
		i->min_blocks = unbounded ? 0 : image_bound(r, block);
	}
	free(options);
	return e->code;
}

/* ---- keeping ---- */

/* Append `size` bytes to the key, if there is one already; its length grows in any case. */
static void append(char *key, size_t *length, const void *bytes, size_t size)
{
	if (key)
		memcpy(key + *length, bytes, size);
	*length += size;
}

/* All that the image depends on. The name of the file is in it, as debugging information, only where an option asks for
   that; what files an option names cannot be seen. */
static size_t write_key(const struct image_request *r, const char *nvrtc, char *key)
{
	char head[128];
	size_t length = 0;
	int n = snprintf(head, sizeof head, "rnea CUDA image 1, sm_%d, block %u, share %d, %zu options", r->arch, r->block,
		(int)r->share, r->option_count);

	append(key, &length, head, (size_t)n + 1);
	append(key, &length, nvrtc, strlen(nvrtc) + 1);
	for (size_t i = 0; i < r->option_count; i++)
		append(key, &length, r->options[i], strlen(r->options[i]) + 1);
	if (r->option_count)
		append(key, &length, r->file, strlen(r->file) + 1);
	append(key, &length, r->source->text, strlen(r->source->text));
	return length;
}

char *image_key(const struct image_request *r, size_t *length)
{
	char nvrtc[2048], *key;

	if (!r->cache->folder[0] || !nvrtc_identity(nvrtc, sizeof nvrtc))
		return NULL;
	key = malloc(write_key(r, nvrtc, NULL));
	*length = key ? write_key(r, nvrtc, key) : 0;
	return key;
}

static const char head_format[] = "rnea image 1: ptx %d arch %d block %u bound %u\n";

/* Take what the cache holds, a line and the image, apart. */
static int take_kept(char *data, size_t size, struct image *i)
{
	const char *end = memchr(data, '\n', size);
	char again[128];

	*i = (struct image){.code.data = data};
	if (!end || sscanf(data, head_format, &i->code.is_ptx, &i->code.arch, &i->block, &i->min_blocks) != 4)
		return 0;
	snprintf(again, sizeof again, head_format, i->code.is_ptx, i->code.arch, i->block, i->min_blocks);
	if (strlen(again) != (size_t)(end + 1 - data) || memcmp(again, data, strlen(again)) != 0)
		return 0;
	i->code.size = size - strlen(again);
	memmove(data, end + 1, i->code.size + 1); /* with its NUL; the driver wants an image aligned */
	return i->code.size != 0;
}

int image_get(const struct cache *c, const char *key, size_t length, struct image *i)
{
	char *data;
	size_t size;

	memset(i, 0, sizeof *i);
	if (!key || !cache_get(c, key, length, &data, &size))
		return 0;
	if (take_kept(data, size, i))
		return 1;
	image_free(i);
	return 0;
}

static void put(const struct cache *c, const char *key, size_t length, const struct image *i, struct cache_why *why)
{
	char head[128];
	size_t n =
		(size_t)snprintf(head, sizeof head, head_format, i->code.is_ptx, i->code.arch, i->block, i->min_blocks);
	char *data = key ? malloc(n + i->code.size) : NULL;

	if (!data)
		return;
	memcpy(data, head, n);
	memcpy(data + n, i->code.data, i->code.size);
	cache_put(c, key, length, data, n + i->code.size, why);
	free(data);
}

void image_keep(const struct image_request *r, const char *key, size_t length, const struct image *i)
{
	size_t n;
	char *now = key ? image_key(r, &n) : NULL;

	if (now && n == length && memcmp(now, key, n) == 0)
		put(r->cache, key, length, i, r->unkept);
	free(now);
}

void image_free(struct image *i)
{
	jit_free(&i->code);
	memset(i, 0, sizeof *i);
}
