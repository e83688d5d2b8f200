/* The public calls that make a robot, and those that ask about it; launch.c has those that run it. */
#define _POSIX_C_SOURCE 200809L /* clock_gettime */
#include "handle.h"
#include "core/seconds.h"
#include "cuda/backend.h"
#include "evaluator/backend.h"
#include "host/backend.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { BLOCK_LIMIT = 1024 };

/* In the order in which RNEA_BACKEND_ANY tries them: the next one where a machine has nothing of the one before. */
static const struct backend *const backends[] = {&backend_cuda, &backend_host};

enum { BACKENDS = sizeof backends / sizeof *backends };

static const struct backend *find_backend(enum rnea_backend name)
{
	for (int i = 0; i < BACKENDS; i++)
		if (backends[i]->name == name)
			return backends[i];
	return NULL;
}

/* ---- opening ---- */

/* Open by one backend, whose failure leaves the robot as it was. */
static enum rnea_code open_by(
	struct rnea_robot *robot, const struct backend *b, const struct backend_request *r, int *absent, struct rnea_error *e)
{
	*absent = 0;
	if (b->refusal && !r->source->is_cuda)
		return rnea_error_set(e, RNEA_ARGUMENT, "%s: %s", r->file, b->refusal);
	if (b->open(&robot->state, r, &robot->info, &robot->build, absent, e))
		return e->code;
	robot->backend = b;
	return RNEA_OK;
}

/* The first backend that takes the text; the next one, where the machine has nothing of that. If all fail, all are told. */
static enum rnea_code open_any(struct rnea_robot *robot, const struct backend_request *r, struct rnea_error *e)
{
	int absent = 1;

	for (int i = 0; i < BACKENDS && absent; i++) {
		const struct backend *b = backends[i];
		struct rnea_error tried = {0};

		if (b->refusal && !r->source->is_cuda)
			continue;
		if (!open_by(robot, b, r, &absent, &tried)) {
			rnea_error_start(e, NULL);
			return RNEA_OK;
		}
		if (e->code) {
			e->code = RNEA_OK;
			rnea_error_set(e, tried.code, "%.1000s (the host was tried because: %.800s)", tried.message, robot->note);
		} else {
			*e = tried;
		}
		if (absent)
			snprintf(robot->note, sizeof robot->note, "%s", tried.message);
	}
	return e->code;
}

static enum rnea_code open_backend(struct rnea_robot *robot, const struct source *s, const struct rnea_evaluator *evaluator,
	const struct rnea_options *o, const struct cache *cache, struct rnea_error *e)
{
	char name[SOURCE_NAME_LIMIT + 4];
	const struct backend_request r = {
		.source = s, .file = o->file ? o->file : name, .options = o, .cache = cache, .unkept = &robot->unkept,
		.evaluator = evaluator};
	int absent;

	snprintf(name, sizeof name, "%s.%s", s->name, s->is_cuda ? "cu" : "c");
	if (evaluator)
		return open_by(robot, &backend_evaluator, &r, &absent, e);
	if (o->backend == RNEA_BACKEND_ANY)
		return open_any(robot, &r, e);
	return open_by(robot, find_backend(o->backend), &r, &absent, e);
}

/* Open a text that was read; `s` stays the caller's. With an evaluator nothing is compiled. */
static enum rnea_code open_source(const struct source *s, const struct rnea_evaluator *evaluator, const struct rnea_options *o,
	 struct rnea_robot **out, struct rnea_error *e)
{
	struct rnea_robot *robot = calloc(1, sizeof *robot);
	double start = seconds_now();
	struct cache cache;

	if (!robot)
		return rnea_error_memory(e);
	if (o->log && o->log_size)
		o->log[0] = '\0';
	cache_open(&cache, o->cache);
	if (open_backend(robot, s, evaluator, o, &cache, e)) {
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
	if (o->backend != RNEA_BACKEND_ANY && !find_backend(o->backend))
		return rnea_error_set(e, RNEA_ARGUMENT, "there is no backend %d that compiles texts%s", (int)o->backend,
			o->backend == RNEA_BACKEND_EVALUATOR ? "; rnea_open_evaluator opens the evaluator" : "");
	if (o->block > BLOCK_LIMIT && o->block != RNEA_BLOCK_OCCUPANCY)
		return rnea_error_set(
			e, RNEA_ARGUMENT, "a block of %u threads: a device takes %d at most", o->block, BLOCK_LIMIT);
	return check_compile(o, e);
}

enum rnea_code rnea_open_evaluator(const char *source, size_t length, const struct rnea_evaluator *evaluator,
	const struct rnea_options *options, struct rnea_robot **robot, struct rnea_error *error)
{
	const struct rnea_options defaults = {0}, *o = options ? options : &defaults;
	struct rnea_error spare, *e = rnea_error_start(error, &spare);
	struct source s;

	if (!robot)
		return rnea_error_set(e, RNEA_ARGUMENT, "there is no place for the robot (robot is NULL)");
	*robot = NULL;
	if (!source || !evaluator || !evaluator->evaluate)
		return rnea_error_set(e, RNEA_ARGUMENT, "there is no %s", source ? "evaluator" : "text (source is NULL)");
	if (source_copy(&s, source, length, o->file ? o->file : "<memory>", e))
		return e->code;
	open_source(&s, evaluator, o, robot, e);
	source_free(&s);
	return e->code;
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
	open_source(&s, NULL, o, robot, e);
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
	open_source(&s, NULL, &o, robot, e);
	source_free(&s);
	return e->code;
}

void rnea_close(struct rnea_robot *robot)
{
	if (!robot)
		return;
	if (robot->backend)
		robot->backend->close(robot->state);
	rnea_info_free(&robot->info);
	free(robot);
}

/* ---- asking ---- */

int rnea_device_count(struct rnea_error *error)
{
	struct rnea_error spare;

	return device_count(rnea_error_start(error, &spare));
}

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

int rnea_bind_role(const struct rnea_robot *robot, const char *function, enum rnea_role role, const char *of)
{
	size_t i = function ? rnea_info_function(&robot->info, function) : robot->info.function_count;
	const struct rnea_function *f = &robot->info.functions[i];

	for (size_t k = 0; i < robot->info.function_count && k < f->input_count + f->output_count; k++)
		if (f->arguments[k].role == role && (!of || strcmp(f->arguments[k].of, of) == 0))
			return (int)k;
	return -1;
}
