/* The public calls that run a robot. */
#include "handle.h"
#include <limits.h>
#include <stdint.h>

/* Name and alignment of array i of a kernel. */
static const char *describe(const struct rnea_robot *robot, enum rnea_kernel kernel, size_t i, size_t *align)
{
	static const char *const forward[DRIVER_PASS_ARRAYS] = {"v", "a", "f"};
	static const char *const backward[DRIVER_PASS_ARRAYS] = {"q", "f", "tau"};
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
			return rnea_error_set(
				e, RNEA_POINTER, "%s: array %zu, \"%s\", is NULL", robot->kernels[kernel], i, name);
		if ((uintptr_t)arguments[i] % align)
			return rnea_error_set(e, RNEA_POINTER, "%s: array %zu, \"%s\", is not aligned to %zu bytes",
				robot->kernels[kernel], i, name, align);
	}
	return RNEA_OK;
}

/* What does not depend on the backend. */
static enum rnea_code check(const struct rnea_robot *robot, enum rnea_kernel kernel, void *const *arguments,
	size_t count, struct rnea_error *e)
{
	size_t block = robot->info.block, grid = count / block + (count % block != 0);

	if (!arguments)
		return rnea_error_set(
			e, RNEA_ARGUMENT, "%s: there are no arrays (arguments is NULL)", robot->kernels[kernel]);
	if (check_pointers(robot, kernel, arguments, rnea_argument_count(robot, kernel), e))
		return e->code;
	if (grid > INT_MAX)
		return rnea_error_set(e, RNEA_LIMIT, "%s: %zu samples are more than %d blocks of %zu",
			robot->kernels[kernel], count, INT_MAX, block);
	return RNEA_OK;
}

enum rnea_code rnea_launch_kernel(const struct rnea_robot *robot, enum rnea_kernel kernel, void *const *arguments,
	size_t count, void *stream, struct rnea_error *error)
{
	struct rnea_error spare, *e = rnea_error_start(error, &spare);

	if (!rnea_has(robot, kernel))
		return rnea_no_kernel(robot, kernel, e);
	if (count == 0 || check(robot, kernel, arguments, count, e))
		return e->code;
	if (robot->build.backend == RNEA_BACKEND_CUDA)
		return driver_launch(
			&robot->driver, kernel, arguments, rnea_argument_count(robot, kernel), count, stream, e);
	if (stream)
		return rnea_error_set(e, RNEA_ARGUMENT,
			"%s: a stream was given, and the robot is on the host, which has none", robot->kernels[kernel]);
	host_run(&robot->host, kernel, arguments, count);
	return RNEA_OK;
}

enum rnea_code rnea_launch(
	const struct rnea_robot *robot, void *const *arguments, size_t count, void *stream, struct rnea_error *error)
{
	return rnea_launch_kernel(robot, RNEA_KERNEL_RNEA, arguments, count, stream, error);
}

enum rnea_code rnea_run(const struct rnea_robot *robot, void *const *arguments, size_t count, struct rnea_error *error)
{
	struct rnea_error spare, *e = rnea_error_start(error, &spare);

	if (robot->build.backend != RNEA_BACKEND_CUDA)
		return rnea_launch(robot, arguments, count, NULL, error);
	if (count == 0 || check(robot, RNEA_KERNEL_RNEA, arguments, count, e))
		return e->code;
	return pipe_run(robot->pool, arguments, count, e);
}
