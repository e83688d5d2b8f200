#include "cuda/backend.h"
#include <stdlib.h>

static void cuda_close(void *state)
{
	struct cuda *c = state;
	struct rnea_error ignored = {0};
	int pushed = 0;

	if (c->pool) {
		device_enter(&c->driver.device, &pushed, &ignored);
		pipe_close(c->pool, ignored.code != RNEA_OK);
		device_leave(&c->driver.device, pushed);
	}
	driver_close(&c->driver);
	free(c);
}

static enum rnea_code cuda_open(void **state, const struct backend_request *r, struct rnea_info *info, struct rnea_build *build,
	int *absent, struct rnea_error *e)
{
	const struct rnea_options *o = r->options;
	struct image_request image = {.source = r->source,
		.file = r->file,
		.options = o->compile,
		.option_count = o->compile_count,
		.block = o->block,
		.cache = r->cache,
		.unkept = r->unkept,
		.log = o->log,
		.log_size = o->log_size};
	struct cuda *c = calloc(1, sizeof *c);

	if (!c)
		return rnea_error_memory(e);
	if (driver_open(&c->driver, o->device, &image, info, e) || pipe_open(&c->pool, &c->driver, info, o->threads, e)) {
		*absent = c->driver.device.absent;
		cuda_close(c);
		return e->code;
	}
	*state = c;
	*build = (struct rnea_build){.backend = RNEA_BACKEND_CUDA,
		.device = c->driver.device.name,
		.compiler = c->driver.compiler,
		.target = c->driver.target,
		.cached = c->driver.cached,
		.min_blocks = c->driver.min_blocks};
	return RNEA_OK;
}

static enum rnea_code cuda_launch(
	const void *state, size_t function, void *const *arrays, size_t count, void *stream, struct rnea_error *e)
{
	const struct cuda *c = state;

	return driver_launch(&c->driver, function, arrays, count, stream, e);
}

static enum rnea_code cuda_run(const void *state, void *const *arrays, size_t count, struct rnea_error *e)
{
	const struct cuda *c = state;

	return pipe_run(c->pool, arrays, count, e);
}

static struct rnea_resources cuda_resources(const void *state, size_t function)
{
	const struct cuda *c = state;

	return c->driver.kernels[function].resources;
}

const struct backend backend_cuda = {.name = RNEA_BACKEND_CUDA,
	.symbols = "kernel",
	.refusal = "a text for target c has no kernel; generate it for target cuda, or open it on the host",
	.has_streams = 1,
	.open = cuda_open,
	.close = cuda_close,
	.launch = cuda_launch,
	.run = cuda_run,
	.resources = cuda_resources};
