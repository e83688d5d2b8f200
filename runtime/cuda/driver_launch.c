/* Which kernels a launch runs. */
#include "cuda/driver.h"
#include <stdint.h>

/* Samples of a block. In segments each thread takes several, where there are enough for all multiprocessors. */
static size_t samples_of_block(const struct rnea_function *f, unsigned block, size_t count)
{
	size_t room = f->across_bytes ? OWN_SHARED / (block * f->across_bytes) : 1,
		most = count / ((size_t)block * ENOUGH_BLOCKS);

	room = room < f->most_samples ? room : f->most_samples;
	most = most < room ? most : room;
	return block * (most ? most : 1);
}

static enum rnea_code launch_own(const struct driver *c, size_t function, void *const *arrays, void **parameters, size_t count,
	void *stream, struct rnea_error *e)
{
	const struct rnea_function *f = &c->info->functions[function];
	unsigned blocks = device_blocks(count, samples_of_block(f, c->block, count));
	struct tile_map maps[RNEA_TILE_LIMIT];

	if (function == 0 && count <= c->limbs.own.info.most) {
		if (!c->relay.threads && c->limbs.start.info.warps &&
			limbs_launch(&c->limbs.start, &c->device, parameters, count, stream, e))
			return e->code;
		return limbs_launch(&c->limbs.own, &c->device, parameters, count, stream, e);
	}
	parameters[f->input_count + f->output_count + 1] = maps;
	if (function == 0 && alone_serve(&c->alone, &c->device, arrays, count, maps))
		return alone_launch(&c->alone, &c->device, parameters, count, stream, e);
	if (function == 0 && relay_hands(&c->relay, &c->device, f, blocks, c->block, parameters, stream, e))
		return e->code;
	return device_launch(&c->device, &c->kernels[function], blocks, f->parts, driver_threads(f, c->block), parameters, stream, e);
}

/* A relay's first kernel. */
static enum rnea_code launch_start(const struct driver *c, void **parameters, size_t count, void *stream, struct rnea_error *e)
{
	if (count <= c->limbs.start.info.most)
		return limbs_launch(&c->limbs.start, &c->device, parameters, count, stream, e);
	return device_launch(&c->device, &c->relay.start, device_blocks(count, c->block), c->info->functions->start_parts,
		c->block, parameters, stream, e);
}

enum rnea_code driver_launch(const struct driver *c, size_t function, void *const *arrays, size_t count, void *stream,
	struct rnea_error *e)
{
	const struct rnea_function *f = &c->info->functions[function];
	size_t n = f->input_count + f->output_count;
	void *parameters[RNEA_ARGUMENT_LIMIT + 2];
	int pushed, has_relay = function == 0 && c->relay.threads;

	/* the driver only reads through these, though it does not say so */
	for (size_t i = 0; i < n; i++)
		parameters[i] = (void *)(uintptr_t)&arrays[i];
	parameters[n] = &count;
	if (device_enter(&c->device, &pushed, e))
		return e->code;
	if (has_relay)
		launch_start(c, parameters, count, stream, e);
	if (!e->code)
		launch_own(c, function, arrays, parameters, count, stream, e);
	if (has_relay && !e->code)
		relay_solve(&c->relay, &c->device, parameters, count, stream, e);
	if (function == 0 && !e->code)
		relay_transpose(&c->relay, &c->device, parameters, count, stream, e);
	device_leave(&c->device, pushed);
	return e->code;
}
