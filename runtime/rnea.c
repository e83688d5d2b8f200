/* The public calls that make a robot, and those that ask about it; launch.c has those that run it. */
#define _POSIX_C_SOURCE 200809L /* clock_gettime, uname */
#include "handle.h"
#include "core/info_table.h"
#include "core/seconds.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/utsname.h>

enum { BLOCK_LIMIT = 1024 };

/* ---- opening ---- */

static void name_kernels(struct rnea_robot *robot, const char *suffix)
{
	for (int i = 0; i < RNEA_KERNEL_COUNT; i++)
		source_symbol(robot->info.name, (enum rnea_kernel)i, suffix, robot->kernels[i]);
}

static enum rnea_code open_cuda(struct rnea_robot *robot, const struct source *s, const struct rnea_options *o,
	const char *file, const struct cache *cache, struct rnea_error *e)
{
	struct image_request r = {.source = s,
		.file = file,
		.options = o->compile,
		.option_count = o->compile_count,
		.block = o->block,
		.cache = cache,
		.unkept = &robot->unkept,
		.log = o->log,
		.log_size = o->log_size};
	struct driver *c = &robot->driver;

	if (!s->is_cuda)
		return rnea_error_set(e, RNEA_ARGUMENT,
			"%s: a text for target c has no kernel; generate it for target cuda, or open it on the host",
			file);
	if (driver_open(c, o->device, &r, &robot->info, e) || pipe_open(&robot->pool, c, &robot->info, o->threads, e))
		return e->code;
	robot->build = (struct rnea_build){.backend = RNEA_BACKEND_CUDA,
		.device = c->device.name,
		.compiler = c->compiler,
		.target = c->target,
		.cached = c->cached,
		.min_blocks = c->min_blocks};
	name_kernels(robot, "kernel");
	return RNEA_OK;
}

static enum rnea_code open_host(struct rnea_robot *robot, const struct source *s, const struct rnea_options *o,
	const char *file, const struct cache *cache, struct rnea_error *e)
{
	struct host_request r = {.source = s->text,
		.file = file,
		.name = s->name,
		.options = o->compile,
		.option_count = o->compile_count,
		.cache = cache,
		.unkept = &robot->unkept,
		.threads = o->threads,
		.log = o->log,
		.log_size = o->log_size};
	struct host *h = &robot->host;
	struct utsname machine;

	if (host_open(h, &r, e) || rnea_info_read(h->info, strlen(h->info), s->name, &robot->info, e))
		return e->code;
	h->sample_ns = host_sample_ns(&robot->info);
	snprintf(robot->device, sizeof robot->device, "%s", uname(&machine) < 0 ? "host" : machine.machine);
	robot->build = (struct rnea_build){.backend = RNEA_BACKEND_HOST,
		.device = robot->device,
		.compiler = h->cached ? "" : h->compiler,
		.target = "native",
		.cached = h->cached,
		.threads = h->threads};
	name_kernels(robot, "slice");
	return RNEA_OK;
}

/* The host, where there is no CUDA at all; both failures are told if that fails too. */
static enum rnea_code open_instead(struct rnea_robot *robot, const struct source *s, const struct rnea_options *o,
	const char *file, const struct cache *cache, struct rnea_error *e)
{
	struct rnea_error host = {0};

	snprintf(robot->note, sizeof robot->note, "%s", e->message);
	if (!open_host(robot, s, o, file, cache, &host)) {
		rnea_error_start(e, NULL);
		return RNEA_OK;
	}
	e->code = RNEA_OK;
	return rnea_error_set(e, host.code, "%.1000s (the host was tried because: %.800s)", host.message, robot->note);
}

static enum rnea_code open_backend(struct rnea_robot *robot, const struct source *s, const struct rnea_options *o,
	const struct cache *cache, struct rnea_error *e)
{
	char name[SOURCE_NAME_LIMIT + 4];
	const char *file = o->file ? o->file : name;

	snprintf(name, sizeof name, "%s.%s", s->name, s->is_cuda ? "cu" : "c");
	if (o->backend == RNEA_BACKEND_HOST || (o->backend == RNEA_BACKEND_ANY && !s->is_cuda))
		return open_host(robot, s, o, file, cache, e);
	if (open_cuda(robot, s, o, file, cache, e) && o->backend == RNEA_BACKEND_ANY && robot->driver.device.absent)
		return open_instead(robot, s, o, file, cache, e);
	return e->code;
}

/* Open a text that was read; `s` stays the caller's. */
static enum rnea_code open_source(
	const struct source *s, const struct rnea_options *o, struct rnea_robot **out, struct rnea_error *e)
{
	struct rnea_robot *robot = calloc(1, sizeof *robot);
	double start = seconds_now();
	struct cache cache;

	if (!robot)
		return rnea_error_memory(e);
	if (o->log && o->log_size)
		o->log[0] = '\0';
	cache_open(&cache, o->cache);
	if (open_backend(robot, s, o, &cache, e)) {
		rnea_close(robot);
		return e->code;
	}
	robot->build.note = robot->note;
	robot->build.unkept = robot->unkept.text;
	robot->build.seconds = seconds_now() - start;
	*out = robot;
	return RNEA_OK;
}

/* ---- checks ---- */

/* What the options for the compiler may not do: be NULL, or decide the block size behind our back. */
static enum rnea_code check_compile(const struct rnea_options *o, struct rnea_error *e)
{
	for (size_t i = 0; i < o->compile_count; i++) {
		const char *option = o->compile ? o->compile[i] : NULL,
			   *block = option ? strstr(option, "RNEA_BLOCK") : NULL;

		if (!option)
			return rnea_error_set(e, RNEA_ARGUMENT, "option %zu for the compiler is NULL", i);
		if (block && strchr("= ", block[strlen("RNEA_BLOCK")]))
			return rnea_error_set(e, RNEA_ARGUMENT,
				"option \"%s\" for the compiler: the block size is set by rnea_options.block", option);
	}
	return RNEA_OK;
}

static enum rnea_code check_options(const struct rnea_options *o, struct rnea_robot **robot, struct rnea_error *e)
{
	if (!robot)
		return rnea_error_set(e, RNEA_ARGUMENT, "there is no place for the robot (robot is NULL)");
	*robot = NULL;
	if ((unsigned)o->backend > RNEA_BACKEND_HOST)
		return rnea_error_set(e, RNEA_ARGUMENT, "there is no backend %d", (int)o->backend);
	if (o->block > BLOCK_LIMIT && o->block != RNEA_BLOCK_OCCUPANCY)
		return rnea_error_set(
			e, RNEA_ARGUMENT, "a block of %u threads: a device takes %d at most", o->block, BLOCK_LIMIT);
	return check_compile(o, e);
}

enum rnea_code rnea_open(const char *source, size_t length, const struct rnea_options *options,
	struct rnea_robot **robot, struct rnea_error *error)
{
	const struct rnea_options defaults = {0}, *o = options ? options : &defaults;
	struct rnea_error spare, *e = rnea_error_start(error, &spare);
	struct source s;

	if (check_options(o, robot, e))
		return e->code;
	if (!source)
		return rnea_error_set(e, RNEA_ARGUMENT, "there is no text (source is NULL)");
	if (source_copy(&s, source, length, o->file ? o->file : "<memory>", e))
		return e->code;
	open_source(&s, o, robot, e);
	source_free(&s);
	return e->code;
}

enum rnea_code rnea_open_file(
	const char *path, const struct rnea_options *options, struct rnea_robot **robot, struct rnea_error *error)
{
	struct rnea_options o = options ? *options : (struct rnea_options){0};
	struct rnea_error spare, *e = rnea_error_start(error, &spare);
	struct source s;

	if (check_options(&o, robot, e))
		return e->code;
	if (!path)
		return rnea_error_set(e, RNEA_ARGUMENT, "there is no file (path is NULL)");
	if (!o.file)
		o.file = path;
	if (source_read(&s, path, e))
		return e->code;
	open_source(&s, &o, robot, e);
	source_free(&s);
	return e->code;
}

void rnea_close(struct rnea_robot *robot)
{
	struct rnea_error ignored = {0};
	int pushed = 0;

	if (!robot)
		return;
	if (robot->pool) {
		device_enter(&robot->driver.device, &pushed, &ignored);
		pipe_close(robot->pool, ignored.code != RNEA_OK);
		device_leave(&robot->driver.device, pushed);
	}
	driver_close(&robot->driver);
	host_close(&robot->host);
	rnea_info_free(&robot->info);
	free(robot);
}

/* ---- asking ---- */

const struct rnea_info *rnea_info(const struct rnea_robot *robot)
{
	return &robot->info;
}

const struct rnea_build *rnea_build(const struct rnea_robot *robot)
{
	return &robot->build;
}

static int find_array(const struct rnea_info *info, const char *name)
{
	for (size_t i = 0; i < info->input_count + info->output_count; i++)
		if (strcmp(info->arguments[i].name, name) == 0)
			return (int)i;
	return -1;
}

/* Is it the array's name with other characters where that has '_', and then the suffix? */
static int is_word_of(const char *array, const char *word, const char *suffix)
{
	static const char letters[] = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_";

	for (; *word && *array; word++, array++)
		if (*array != (strchr(letters, *word) ? *word : '_'))
			return 0;
	return !*word && strcmp(array, suffix) == 0;
}

int rnea_bind(const struct rnea_robot *robot, const char *name)
{
	const struct rnea_info *info = &robot->info;
	int found = name ? find_array(info, name) : -1;

	if (!name || found >= 0)
		return found;
	for (size_t i = 0; i < info->input_count + info->output_count; i++) {
		if (is_word_of(info->arguments[i].name, name, "_2"))
			return -1;
		if (is_word_of(info->arguments[i].name, name, ""))
			found = (int)i;
	}
	return found;
}

int rnea_has(const struct rnea_robot *robot, enum rnea_kernel kernel)
{
	if ((unsigned)kernel >= RNEA_KERNEL_COUNT)
		return 0;
	return robot->build.backend == RNEA_BACKEND_CUDA ? robot->driver.kernels[kernel].function != NULL
							 : robot->host.slices[kernel] != NULL;
}

enum rnea_code rnea_no_kernel(const struct rnea_robot *robot, enum rnea_kernel kernel, struct rnea_error *e)
{
	if ((unsigned)kernel >= RNEA_KERNEL_COUNT)
		return rnea_error_set(e, RNEA_KERNEL, "there is no kernel %d", (int)kernel);
	return rnea_error_set(
		e, RNEA_KERNEL, "the text of \"%s\" has no kernel %s", robot->info.name, robot->kernels[kernel]);
}

size_t rnea_argument_count(const struct rnea_robot *robot, enum rnea_kernel kernel)
{
	if (!rnea_has(robot, kernel))
		return 0;
	if (kernel == RNEA_KERNEL_RNEA)
		return robot->info.input_count + robot->info.output_count;
	return kernel == RNEA_KERNEL_FPASS ? robot->info.input_count + DRIVER_PASS_ARRAYS : DRIVER_PASS_ARRAYS;
}

enum rnea_code rnea_resources(const struct rnea_robot *robot, enum rnea_kernel kernel, struct rnea_resources *resources,
	struct rnea_error *error)
{
	struct rnea_error spare, *e = rnea_error_start(error, &spare);

	*resources = (struct rnea_resources){0};
	if (!rnea_has(robot, kernel))
		return rnea_no_kernel(robot, kernel, e);
	*resources = robot->driver.kernels[kernel].resources; /* all 0 on the host */
	return RNEA_OK;
}
