/* The public calls that run a robot, and what they need to know of a function. */
#include "handle.h"
#include <limits.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

/* What messages call a function: NAME_rnea_kernel. */
struct symbol {
	char s[SOURCE_SYMBOL_SIZE];
};

static struct symbol symbol_of(const struct rnea_robot *robot, size_t function)
{
	struct symbol symbol;

	source_symbol(robot->info.name, robot->info.functions[function].name, robot->backend->symbols, symbol.s);
	return symbol;
}

/* Its index in *i. Errors: KERNEL. */
static enum rnea_code find(const struct rnea_robot *robot, const char *function, size_t *i, struct rnea_error *e)
{
	const struct rnea_info *info = &robot->info;
	char names[512] = "";

	if (!function)
		return rnea_error_set(e, RNEA_KERNEL, "no function is named (function is NULL): a name is wanted, such as \"%s\"",
			info->functions->name);
	if ((*i = rnea_info_function(info, function)) < info->function_count)
		return RNEA_OK;
	for (size_t k = 0, used = 0; k < info->function_count && used < sizeof names; k++)
		used += (size_t)snprintf(names + used, sizeof names - used, "%s%s", k ? ", " : "", info->functions[k].name);
	return rnea_error_set(
		e, RNEA_KERNEL, "the text of \"%s\" has no function \"%.200s\"; it has %s", info->name, function, names);
}

static enum rnea_code check_pointers(
	const struct rnea_robot *robot, size_t function, void *const *arguments, struct rnea_error *e)
{
	const struct rnea_function *f = &robot->info.functions[function];

	for (size_t i = 0; i < f->input_count + f->output_count; i++) {
		size_t align = f->arguments[i].scalar == RNEA_F64 ? sizeof(double) : sizeof(float);

		if (!arguments[i])
			return rnea_error_set(e, RNEA_POINTER, "%s: array %zu, \"%s\", is NULL", symbol_of(robot, function).s, i,
				f->arguments[i].name);
		if ((uintptr_t)arguments[i] % align)
			return rnea_error_set(e, RNEA_POINTER, "%s: array %zu, \"%s\", is not aligned to %zu bytes",
				symbol_of(robot, function).s, i, f->arguments[i].name, align);
	}
	return RNEA_OK;
}

/* What does not depend on the backend. */
static enum rnea_code check(
	const struct rnea_robot *robot, size_t function, void *const *arguments, size_t count, struct rnea_error *e)
{
	size_t block = robot->info.block, grid = count / block + (count % block != 0);

	if (!arguments)
		return rnea_error_set(
			e, RNEA_ARGUMENT, "%s: there are no arrays (arguments is NULL)", symbol_of(robot, function).s);
	if (check_pointers(robot, function, arguments, e))
		return e->code;
	if (grid > INT_MAX)
		return rnea_error_set(e, RNEA_LIMIT, "%s: %zu samples are more than %d blocks of %zu",
			symbol_of(robot, function).s, count, INT_MAX, block);
	return RNEA_OK;
}

static enum rnea_code launch(const struct rnea_robot *robot, size_t function, void *const *arguments, size_t count,
	void *stream, struct rnea_error *e)
{
	if (count == 0 || check(robot, function, arguments, count, e))
		return e->code;
	if (stream && !robot->backend->has_streams)
		return rnea_error_set(e, RNEA_ARGUMENT, "%s: a stream was given, and the robot is on the host, which has none",
			symbol_of(robot, function).s);
	return robot->backend->launch(robot->state, function, arguments, count, stream, e);
}

enum rnea_code rnea_launch_kernel(const struct rnea_robot *robot, const char *function, void *const *arguments,
	size_t count, void *stream, struct rnea_error *error)
{
	struct rnea_error spare, *e = rnea_error_start(error, &spare);
	size_t i;

	return find(robot, function, &i, e) ? e->code : launch(robot, i, arguments, count, stream, e);
}

enum rnea_code rnea_launch(
	const struct rnea_robot *robot, void *const *arguments, size_t count, void *stream, struct rnea_error *error)
{
	struct rnea_error spare;

	return launch(robot, 0, arguments, count, stream, rnea_error_start(error, &spare));
}

enum rnea_code rnea_run(const struct rnea_robot *robot, void *const *arguments, size_t count, struct rnea_error *error)
{
	struct rnea_error spare, *e = rnea_error_start(error, &spare);

	if (count == 0 || check(robot, 0, arguments, count, e))
		return e->code;
	return robot->backend->run(robot->state, arguments, count, e);
}

enum rnea_code rnea_run_aos(const struct rnea_robot *robot, void *const *arguments, size_t count, struct rnea_error *error)
{
	struct rnea_error spare, *e = rnea_error_start(error, &spare);

	if (count == 0 || check(robot, 0, arguments, count, e))
		return e->code;
	if (robot->info.layout == RNEA_AOS)
		return robot->backend->run(robot->state, arguments, count, e);
	if (robot->backend->run_aos)
		return robot->backend->run_aos(robot->state, arguments, count, e);
	return rnea_error_set(e, RNEA_ARGUMENT,
		"%s: its layout is soa, and this backend does not turn arrays: generate the text with --layout aos",
		symbol_of(robot, 0).s);
}

size_t rnea_argument_count(const struct rnea_robot *robot, const char *function)
{
	const struct rnea_info *info = &robot->info;
	size_t i = function ? rnea_info_function(info, function) : info->function_count;

	return i < info->function_count ? info->functions[i].input_count + info->functions[i].output_count : 0;
}

enum rnea_code rnea_resources(const struct rnea_robot *robot, const char *function, struct rnea_resources *resources,
	struct rnea_error *error)
{
	struct rnea_error spare, *e = rnea_error_start(error, &spare);
	size_t i;

	*resources = (struct rnea_resources){0};
	if (!find(robot, function, &i, e) && robot->backend->resources)
		*resources = robot->backend->resources(robot->state, i);
	return e->code;
}
