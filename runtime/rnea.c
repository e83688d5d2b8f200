#include "rnea.h"
#include "device.h"
#include "info.h"
#include "jit.h"
#include "source.h"
#include <limits.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { PASS_ARRAYS = 3, BLOCK_LIMIT = 1024 };

struct rnea_robot {
	struct device device;
	void *module;
	struct rnea_info info;
	struct device_kernel kernels[RNEA_KERNEL_COUNT];
};

static const char *const kernel_suffixes[RNEA_KERNEL_COUNT] = {"rnea", "fpass", "bpass"};

/* ---- opening ---- */

static enum rnea_code compile(
	const struct source *s, const struct rnea_options *o, int arch, struct jit_image *image, struct rnea_error *e)
{
	const char **options = calloc(o->compile_count + 1, sizeof *options);
	char block[40], file[SOURCE_NAME_LIMIT + 4];
	struct jit_request r = {.source = s->text,
		.file = o->file ? o->file : file,
		.arch = arch,
		.options = options,
		.log = o->log,
		.log_size = o->log_size};

	if (!options)
		return rnea_error_memory(e);
	snprintf(file, sizeof file, "%s.cu", s->name);
	for (size_t i = 0; i < o->compile_count; i++)
		options[r.option_count++] = o->compile[i];
	if (o->block) {
		snprintf(block, sizeof block, "-DRNEA_BLOCK=%u", o->block);
		options[r.option_count++] = block;
	}
	jit_compile(&r, image, e);
	free(options);
	return e->code;
}

/* Read NAME_info back from the loaded module: what was compiled, not what the text looks like. */
static enum rnea_code read_info(struct rnea_robot *robot, const struct source *s, unsigned block, struct rnea_error *e)
{
	char symbol[SOURCE_NAME_LIMIT + 8];
	char *text;
	size_t size;

	snprintf(symbol, sizeof symbol, "%s_info", s->name);
	if (device_read(&robot->device, robot->module, symbol, &text, &size, e))
		return e->code;
	rnea_info_parse(text, size, &robot->info, e);
	free(text);
	if (e->code)
		return e->code;
	if (strcmp(robot->info.name, s->name) != 0)
		return rnea_error_set(e, RNEA_TABLE, "info table: %s calls the robot \"%s\"", symbol, robot->info.name);
	if (block)
		robot->info.block = block; /* the table has the text's default */
	return RNEA_OK;
}

static enum rnea_code find_kernels(struct rnea_robot *robot, struct rnea_error *e)
{
	for (int i = 0; i < RNEA_KERNEL_COUNT; i++) {
		struct device_kernel *k = &robot->kernels[i];

		snprintf(k->name, sizeof k->name, "%.*s_%s_kernel", SOURCE_NAME_LIMIT, robot->info.name,
			kernel_suffixes[i]);
		if (device_find(&robot->device, robot->module, k, e))
			return e->code;
		if (k->function && k->resources.max_block < robot->info.block)
			return rnea_error_set(e, RNEA_ARGUMENT,
				"%s cannot run in blocks of %u threads: its %d registers allow %u", k->name,
				robot->info.block, k->resources.registers, k->resources.max_block);
	}
	if (!robot->kernels[RNEA_KERNEL_RNEA].function)
		return rnea_error_set(
			e, RNEA_TEXT, "the text defines no kernel %s", robot->kernels[RNEA_KERNEL_RNEA].name);
	return RNEA_OK;
}

/* Run every kernel over no samples: the driver makes room for local memory at the first launch, and that must not
   happen in a launch of the caller's, which may be inside a capture. */
static enum rnea_code warm(const struct rnea_robot *robot, struct rnea_error *e)
{
	void *null = NULL, *stream;
	size_t count = 0;

	if (device_stream(&robot->device, &stream, e))
		return e->code;
	for (int i = 0; i < RNEA_KERNEL_COUNT && !e->code; i++) {
		size_t n = rnea_argument_count(robot, (enum rnea_kernel)i);
		void *parameters[RNEA_ARGUMENT_LIMIT + PASS_ARRAYS + 1];

		for (size_t j = 0; j < n; j++)
			parameters[j] = &null;
		parameters[n] = &count;
		if (n)
			device_launch(&robot->device, &robot->kernels[i], 1, robot->info.block, parameters, stream, e);
	}
	return device_finish(&robot->device, stream, e);
}

static enum rnea_code load(struct rnea_robot *robot, const struct source *s, const struct jit_image *image,
	unsigned block, struct rnea_error *e)
{
	int pushed;

	if (device_enter(&robot->device, &pushed, e))
		return e->code;
	if (!device_load(&robot->device, image->data, s->name, &robot->module, e) && !read_info(robot, s, block, e) &&
		!find_kernels(robot, e))
		warm(robot, e);
	device_leave(&robot->device, pushed);
	return e->code;
}

/* Open a text that was read; `s` stays the caller's. */
static enum rnea_code open_source(
	const struct source *s, const struct rnea_options *o, struct rnea_robot **out, struct rnea_error *e)
{
	struct rnea_robot *robot = calloc(1, sizeof *robot);
	struct jit_image image = {0};

	if (!robot)
		return rnea_error_memory(e);
	if (!device_open(&robot->device, o->device, e) && !compile(s, o, robot->device.arch, &image, e))
		load(robot, s, &image, o->block, e);
	jit_free(&image);
	if (e->code)
		rnea_close(robot);
	else
		*out = robot;
	return e->code;
}

static enum rnea_code check_options(const struct rnea_options *o, struct rnea_robot **robot, struct rnea_error *e)
{
	if (!robot)
		return rnea_error_set(e, RNEA_ARGUMENT, "there is no place for the robot (robot is NULL)");
	*robot = NULL;
	if (o->block > BLOCK_LIMIT)
		return rnea_error_set(
			e, RNEA_ARGUMENT, "a block of %u threads: a device takes %d at most", o->block, BLOCK_LIMIT);
	for (size_t i = 0; i < o->compile_count; i++)
		if (!o->compile || !o->compile[i])
			return rnea_error_set(e, RNEA_ARGUMENT, "option %zu for NVRTC is NULL", i);
	return RNEA_OK;
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
	struct rnea_error ignored, *e = rnea_error_start(NULL, &ignored);
	int pushed;

	if (!robot)
		return;
	if (robot->module && !device_enter(&robot->device, &pushed, e)) {
		device_unload(&robot->device, robot->module);
		device_leave(&robot->device, pushed);
	}
	device_close(&robot->device);
	rnea_info_free(&robot->info);
	free(robot);
}

/* ---- asking ---- */

const struct rnea_info *rnea_info(const struct rnea_robot *robot)
{
	return &robot->info;
}

int rnea_bind(const struct rnea_robot *robot, const char *name)
{
	size_t count = robot->info.input_count + robot->info.output_count;

	for (size_t i = 0; name && i < count; i++)
		if (strcmp(robot->info.arguments[i].name, name) == 0)
			return (int)i;
	return -1;
}

/* The kernel, or NULL where the text has none. */
static const struct device_kernel *kernel_of(const struct rnea_robot *robot, enum rnea_kernel kernel)
{
	if ((unsigned)kernel >= RNEA_KERNEL_COUNT || !robot->kernels[kernel].function)
		return NULL;
	return &robot->kernels[kernel];
}

static enum rnea_code no_kernel(const struct rnea_robot *robot, enum rnea_kernel kernel, struct rnea_error *e)
{
	if ((unsigned)kernel >= RNEA_KERNEL_COUNT)
		return rnea_error_set(e, RNEA_KERNEL, "there is no kernel %d", (int)kernel);
	return rnea_error_set(
		e, RNEA_KERNEL, "the text of \"%s\" has no kernel %s", robot->info.name, robot->kernels[kernel].name);
}

size_t rnea_argument_count(const struct rnea_robot *robot, enum rnea_kernel kernel)
{
	if (!kernel_of(robot, kernel))
		return 0;
	if (kernel == RNEA_KERNEL_RNEA)
		return robot->info.input_count + robot->info.output_count;
	return kernel == RNEA_KERNEL_FPASS ? robot->info.input_count + PASS_ARRAYS : PASS_ARRAYS;
}

enum rnea_code rnea_resources(const struct rnea_robot *robot, enum rnea_kernel kernel, struct rnea_resources *resources,
	struct rnea_error *error)
{
	struct rnea_error spare, *e = rnea_error_start(error, &spare);
	const struct device_kernel *k = kernel_of(robot, kernel);

	*resources = k ? k->resources : (struct rnea_resources){0};
	return k ? RNEA_OK : no_kernel(robot, kernel, e);
}

/* ---- launching ---- */

/* Name and alignment of array i of a kernel. */
static const char *describe(const struct rnea_robot *robot, enum rnea_kernel kernel, size_t i, size_t *align)
{
	static const char *const forward[PASS_ARRAYS] = {"v", "a", "f"};
	static const char *const backward[PASS_ARRAYS] = {"q", "f", "tau"};
	const struct rnea_info *info = &robot->info;
	enum rnea_scalar scalar = info->precision;
	const char *name;

	if (kernel == RNEA_KERNEL_BPASS) {
		name = backward[i];
	} else if (kernel == RNEA_KERNEL_FPASS && i >= info->input_count) {
		name = forward[i - info->input_count];
	} else {
		name = info->arguments[i].name;
		scalar = info->arguments[i].scalar;
	}
	*align = scalar == RNEA_F64 ? sizeof(double) : sizeof(float);
	return name;
}

static enum rnea_code check_pointers(
	const struct rnea_robot *robot, enum rnea_kernel kernel, void *const *arguments, size_t n, struct rnea_error *e)
{
	for (size_t i = 0; i < n; i++) {
		size_t align;
		const char *name = describe(robot, kernel, i, &align);

		if (!arguments[i])
			return rnea_error_set(e, RNEA_POINTER, "%s: array %zu, \"%s\", is NULL",
				robot->kernels[kernel].name, i, name);
		if ((uintptr_t)arguments[i] % align)
			return rnea_error_set(e, RNEA_POINTER, "%s: array %zu, \"%s\", is not aligned to %zu bytes",
				robot->kernels[kernel].name, i, name, align);
	}
	return RNEA_OK;
}

static enum rnea_code enqueue(const struct rnea_robot *robot, const struct device_kernel *k, void *const *arguments,
	size_t n, size_t count, void *stream, struct rnea_error *e)
{
	size_t block = robot->info.block, grid = count / block + (count % block != 0);
	void *parameters[RNEA_ARGUMENT_LIMIT + PASS_ARRAYS + 1];
	int pushed;

	if (grid > INT_MAX)
		return rnea_error_set(e, RNEA_LIMIT, "%s: %zu samples are more than %d blocks of %zu", k->name, count,
			INT_MAX, block);
	/* the driver only reads through these, though it does not say so */
	for (size_t i = 0; i < n; i++)
		parameters[i] = (void *)(uintptr_t)&arguments[i];
	parameters[n] = &count;
	if (device_enter(&robot->device, &pushed, e))
		return e->code;
	device_launch(&robot->device, k, (unsigned)grid, (unsigned)block, parameters, stream, e);
	device_leave(&robot->device, pushed);
	return e->code;
}

enum rnea_code rnea_launch_kernel(const struct rnea_robot *robot, enum rnea_kernel kernel, void *const *arguments,
	size_t count, void *stream, struct rnea_error *error)
{
	struct rnea_error spare, *e = rnea_error_start(error, &spare);
	const struct device_kernel *k = kernel_of(robot, kernel);
	size_t n = rnea_argument_count(robot, kernel);

	if (!k)
		return no_kernel(robot, kernel, e);
	if (count == 0)
		return RNEA_OK;
	if (!arguments)
		return rnea_error_set(e, RNEA_ARGUMENT, "%s: there are no arrays (arguments is NULL)", k->name);
	if (check_pointers(robot, kernel, arguments, n, e))
		return e->code;
	return enqueue(robot, k, arguments, n, count, stream, e);
}

enum rnea_code rnea_launch(
	const struct rnea_robot *robot, void *const *arguments, size_t count, void *stream, struct rnea_error *error)
{
	return rnea_launch_kernel(robot, RNEA_KERNEL_RNEA, arguments, count, stream, error);
}
