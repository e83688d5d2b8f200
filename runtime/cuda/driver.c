#include "cuda/driver.h"
#include "cuda/compile/compilation.h"
#include "cuda/compile/macros.h"
#include "core/info_table.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { BLOCK_SIZES = 3, TRIAL_LIMIT = 2 * BLOCK_SIZES };

/* The compilations of one text that were tried, each loaded. */
struct trial {
	struct image images[TRIAL_LIMIT];
	void *modules[TRIAL_LIMIT];
	struct compilation compilations[TRIAL_LIMIT];
	size_t count;
};

/* NAME_info out of a loaded module: what was compiled, not what the text looks like. */
static enum rnea_code read_table(
	const struct device *d, void *module, const struct source *s, struct rnea_info *info, struct rnea_error *e)
{
	char symbol[SOURCE_NAME_LIMIT + 8];
	char *text;
	size_t size;

	snprintf(symbol, sizeof symbol, "%s_info", s->name);
	if (device_read(d, module, symbol, &text, &size, e))
		return e->code;
	rnea_info_read(text, size, s->name, info, e);
	free(text);
	return e->code;
}

unsigned driver_threads(const struct rnea_function *f, unsigned block)
{
	return block <= f->most_block ? block * f->sample_threads : block;
}

/* The kernel of the table's first function, by which compilations are judged, for blocks of `block` samples, 0: as the table
   has it; and the threads of these. */
static enum rnea_code find_first(const struct device *d, void *module, const struct source *s, unsigned block,
	struct device_kernel *k, unsigned *threads, struct rnea_error *e)
{
	struct rnea_info info;

	if (read_table(d, module, s, &info, e))
		return e->code;
	source_symbol(s->name, info.functions->name, "kernel", k->name);
	*threads = driver_threads(info.functions, block);
	if (!device_find(d, module, k, info.stage_bytes * (block ? block : info.block), e) && !k->function)
		rnea_error_set(e, RNEA_TEXT, "the text defines no kernel %s", k->name);
	rnea_info_free(&info);
	return e->code;
}

/* ---- compiling ---- */

/* Local memory beyond the text's own tables of sines, which it only uses for large angles. */
static size_t spilled_bytes(const struct device_kernel *k, const struct source *s)
{
	size_t own = macro_number(s, "RNEA_SINES_BYTES");

	return k->resources.local_bytes > own ? k->resources.local_bytes - own : 0;
}

/* The first kernel of a module, as a compilation to choose from. */
static enum rnea_code judge(const struct driver *c, const struct image_request *r, void *module, const struct image *i,
	struct compilation *made, struct rnea_error *e)
{
	struct device_kernel k;
	unsigned threads = 0;
	int blocks = 0;

	if (find_first(&c->device, module, r->source, i->block, &k, &threads, e) ||
		(i->block && device_resident(&c->device, &k, threads, &blocks, e)))
		return e->code;
	*made = (struct compilation){.block = i->block,
		.min_blocks = i->min_blocks,
		.spilled_bytes = spilled_bytes(&k, r->source),
		.resident = (unsigned)blocks * i->block};
	return RNEA_OK;
}

/* Compile and load once more, and see what came of it. */
static enum rnea_code attempt(const struct driver *c, const struct image_request *r, unsigned block, int unbounded,
	struct trial *t, struct rnea_error *e)
{
	struct image_request mine = *r;
	struct image *image = &t->images[t->count];
	void **module = &t->modules[t->count];

	if (t->count)
		mine.log = NULL; /* it has that of the first */
	if (!image_compile(&mine, block, unbounded, image, e) &&
		!device_load(&c->device, image->code.data, r->source->name, module, e) &&
		!judge(c, r, *module, image, &t->compilations[t->count], e)) {
		t->count++;
		return RNEA_OK;
	}
	device_unload(&c->device, *module);
	*module = NULL;
	image_free(image);
	return e->code;
}

/* Whether an error only means that these bounds, or this block size, are not for this kernel. */
static int is_unfit(const struct rnea_error *e)
{
	return e->code == RNEA_COMPILE || e->code == RNEA_DRIVER;
}

/* For one block size: as the text would have it and, if the kernel then spills, without its launch bound. */
static enum rnea_code attempt_bounds(
	const struct driver *c, const struct image_request *r, unsigned block, struct trial *t, struct rnea_error *e)
{
	struct rnea_error unbounded = {0};

	if (attempt(c, r, block, 0, t, e))
		return e->code;
	if (t->compilations[t->count - 1].spilled_bytes == 0 || image_is_bound(r) || image_bound(r, block) == 0)
		return RNEA_OK;
	if (attempt(c, r, block, 1, t, &unbounded) && !is_unfit(&unbounded))
		*e = unbounded;
	return e->code;
}

/* The same for every block size that is asked for; one that does not compile, for want of shared memory in a text of before
   launches gave it, is passed over as long as another does. */
static enum rnea_code attempt_blocks(
	const struct driver *c, const struct image_request *r, struct trial *t, struct rnea_error *e)
{
	static const unsigned sizes[BLOCK_SIZES] = {64, 128, 256};
	struct rnea_error first = {0};

	if (r->block != RNEA_BLOCK_OCCUPANCY)
		return attempt_bounds(c, r, r->block, t, e);
	for (int i = 0; i < BLOCK_SIZES; i++) {
		struct rnea_error tried = {0};

		if (attempt_bounds(c, r, sizes[i], t, &tried) && !is_unfit(&tried)) {
			*e = tried;
			return e->code;
		}
		if (!first.code)
			first = tried;
	}
	if (t->count == 0)
		*e = first;
	return e->code;
}

static void trial_free(const struct driver *c, struct trial *t)
{
	for (size_t i = 0; i < t->count; i++) {
		device_unload(&c->device, t->modules[i]);
		image_free(&t->images[i]);
	}
}

/* Take over a module, and what is to be told of its image. */
static void take(struct driver *c, void *module, const struct image *i, int cached)
{
	c->module = module;
	c->block = i->block;
	c->min_blocks = i->min_blocks;
	c->cached = cached;
	snprintf(c->target, sizeof c->target, "%s_%d", i->code.is_ptx ? "compute" : "sm", i->code.arch);
	snprintf(c->compiler, sizeof c->compiler, "%s", i->code.compiler);
}

static enum rnea_code compile(
	struct driver *c, const struct image_request *r, const char *key, size_t length, struct rnea_error *e)
{
	struct trial t = {0};

	if (!attempt_blocks(c, r, &t, e)) {
		size_t best = compilation_best(t.compilations, t.count, macro_value(r->source, "RNEA_BLOCK"));

		take(c, t.modules[best], &t.images[best], 0);
		t.modules[best] = NULL;
		image_keep(r, key, length, &t.images[best]);
	}
	trial_free(c, &t);
	return e->code;
}

/* What was kept and the driver refuses is compiled again. */
static enum rnea_code load(struct driver *c, const struct image_request *r, struct rnea_error *e)
{
	size_t length;
	char *key = image_key(r, &length);
	struct rnea_error refused = {.code = RNEA_DRIVER};
	struct image kept;
	void *module;

	if (image_get(r->cache, key, length, &kept)) {
		refused.code = RNEA_OK;
		if (!device_load(&c->device, kept.code.data, r->source->name, &module, &refused))
			take(c, module, &kept, 1);
		image_free(&kept);
	}
	if (refused.code == RNEA_DRIVER)
		compile(c, r, key, length, e);
	else
		*e = refused;
	free(key);
	return e->code;
}

/* ---- what was loaded ---- */

static enum rnea_code read_info(struct driver *c, const struct source *s, struct rnea_info *info, struct rnea_error *e)
{
	if (read_table(&c->device, c->module, s, info, e))
		return e->code;
	if (c->block)
		info->block = c->block; /* the table has the text's default */
	c->block = info->block;
	c->info = info;
	if (!(c->kernels = calloc(info->function_count, sizeof *c->kernels)))
		rnea_error_memory(e);
	return e->code;
}

static enum rnea_code check_block(const struct device_kernel *k, unsigned threads, struct rnea_error *e)
{
	if (k->resources.max_block >= threads)
		return RNEA_OK;
	return rnea_error_set(e, RNEA_ARGUMENT, "%s cannot run in blocks of %u threads: its %d registers allow %u",
		k->name, threads, k->resources.registers, k->resources.max_block);
}

/* Only what the table names, where it names any: a call of the driver that fails is an error to tools that watch them. */
static enum rnea_code find_kernels(
	struct driver *c, const struct source *s, struct rnea_info *info, struct rnea_error *e)
{
	for (size_t i = 0; i < info->function_count;) {
		const struct rnea_function *f = &info->functions[i];
		struct device_kernel *k = &c->kernels[i];

		source_symbol(s->name, f->name, "kernel", k->name);
		if (device_find(&c->device, c->module, k, f->stage_bytes * c->block, e))
			return e->code;
		if (k->function && check_block(k, driver_threads(f, c->block), e))
			return e->code;
		if (k->function)
			i++;
		else if (!rnea_info_lacks(info, i))
			return rnea_error_set(e, RNEA_TEXT, "the text defines no kernel %s, which %s_info names",
				k->name, s->name);
	}
	if (relay_find(&c->relay, &c->device, c->module, s, info->functions, c->block, e) ||
		(c->relay.threads && check_block(&c->relay.start, c->block, e)))
		return e->code;
	for (unsigned i = 0; i < c->relay.hand_kernels && !e->code; i++)
		check_block(&c->relay.hands[i], c->block, e);
	return e->code;
}

/* Run every kernel over no samples: the driver makes room for local memory at the first launch, and that must not
   happen in a launch of the caller's, which may be inside a capture. */
static enum rnea_code warm(const struct driver *c, struct rnea_error *e)
{
	unsigned long long zero = 0; /* a null pointer, and a count of 0 */
	void *parameters[RNEA_ARGUMENT_LIMIT + 2], *stream;
	struct tile_map maps[RNEA_TILE_LIMIT] = {0};

	for (int i = 0; i < RNEA_ARGUMENT_LIMIT + 2; i++)
		parameters[i] = &zero;
	if (device_stream(&c->device, &stream, e))
		return e->code;
	for (size_t i = 0; i < c->info->function_count && !e->code; i++)
		device_launch(&c->device, &c->kernels[i], 1, 1, driver_threads(&c->info->functions[i], c->block), parameters, stream, e);
	if (c->relay.threads && !e->code && !device_launch(&c->device, &c->relay.start, 1, 1, c->block, parameters, stream, e))
		relay_solve(&c->relay, &c->device, parameters, 0, stream, e);
	for (unsigned i = 0; i < c->relay.hand_kernels && !e->code; i++)
		device_launch(&c->device, &c->relay.hands[i], 1, 1, c->block, parameters, stream, e);
	if (!e->code)
		relay_transpose(&c->relay, &c->device, parameters, 0, stream, e);
	parameters[c->info->functions->input_count + c->info->functions->output_count + 1] = maps;
	if (c->alone.function && !e->code)
		alone_launch(&c->alone, &c->device, parameters, 0, stream, e);
	if (c->limbs.own.info.warps && !e->code)
		limbs_launch(&c->limbs.own, &c->device, parameters, 0, stream, e);
	if (c->limbs.start.info.warps && !e->code)
		limbs_launch(&c->limbs.start, &c->device, parameters, 0, stream, e);
	return device_finish(&c->device, stream, e);
}

/* What is compiled meanwhile. */
static void load_beside(struct driver *c, struct beside *limbs, struct beside *alone, struct rnea_info *info)
{
	limbs_load(&c->limbs, limbs, &c->device, info);
	alone_load(&c->alone, alone, &c->device, info);
	c->cached = c->cached && (!c->limbs.module || limbs->cached) && (!c->alone.module || alone->cached);
}

static void open_text(struct driver *c, const struct image_request *r, struct rnea_info *info, struct rnea_error *e)
{
	struct image_request mine = *r;
	struct beside limbs, alone;
	int has_limbs, has_alone;

	mine.arch = c->device.arch;
	has_limbs = beside_begin(&limbs, &mine, IMAGE_LIMBS); /* both have blocks of their own */
	has_alone = beside_begin(&alone, &mine, IMAGE_ALONE);
	if (has_limbs || has_alone)
		mine.share = IMAGE_MAIN;
	if (!load(c, &mine, e) && !read_info(c, r->source, info, e) && !find_kernels(c, r->source, info, e)) {
		load_beside(c, &limbs, &alone, info);
		warm(c, e);
	}
	beside_end(&limbs);
	beside_end(&alone);
}

enum rnea_code driver_open(
	struct driver *c, int ordinal, const struct image_request *r, struct rnea_info *info, struct rnea_error *e)
{
	int pushed, absent;

	memset(c, 0, sizeof *c);
	memset(info, 0, sizeof *info);
	if (!device_open(&c->device, ordinal, e) && !device_enter(&c->device, &pushed, e)) {
		open_text(c, r, info, e);
		device_leave(&c->device, pushed);
	}
	if (!e->code)
		return RNEA_OK;
	absent = c->device.absent;
	driver_close(c);
	rnea_info_free(info);
	c->device.absent = absent;
	return e->code;
}

void driver_close(struct driver *c)
{
	struct rnea_error ignored = {0};
	int pushed;

	/* where the context is dead, so is the module */
	if (c->module && !device_enter(&c->device, &pushed, &ignored)) {
		device_unload(&c->device, c->module);
		device_unload(&c->device, c->limbs.module);
		device_unload(&c->device, c->alone.module);
		device_leave(&c->device, pushed);
	}
	device_close(&c->device);
	alone_free(&c->alone);
	free(c->kernels);
	memset(c, 0, sizeof *c);
}
