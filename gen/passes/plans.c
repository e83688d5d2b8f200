#include "passes/plans.h"
#include "emit/target_type.h"
#include "plan/grid/beside.h"
#include "plan/grid/found/found_limbs.h"
#include "plan/lanes/lanes.h"
#include "plan/limbs/limb_limits.h"
#include "plan/segments.h"
#include "plan/stage.h"
#include "plan/tiles/tiles.h"
#include "plan/transposed.h"

enum rneagen_code plans_build(struct plans *p, struct analysis *a)
{
	for (int i = 0; i < p->function_count; i++)
		if (!plan_build(&p->functions[i].plan, &p->functions[i].dag, &a->tree, a->arena))
			return error_memory(a->error);
	if (!plan_order(&p->functions[0], &a->tree, &a->request, &a->options, ORDERED_WHOLE, a->arena))
		error_memory(a->error);
	return a->error->code;
}

/* What kernels and parts are planned of. */
static struct parts_of divided(struct plans *p, struct analysis *a, const struct rneagen_options *o, int is_transposed)
{
	return (struct parts_of){.whole = &p->functions[0], .raw = &a->raw, .tree = &a->tree, .request = &a->request, .options = o,
		.has_kernels = target_type_of(o->target)->kernel != NULL, .is_unpruned = a->adjust.prune == 0,
		.is_transposed = is_transposed};
}

enum rneagen_code plans_parts(struct plans *p, struct analysis *a)
{
	int may_transpose = target_type_of(a->options.target)->kernel &&
		transposed_may_be(&p->functions[0].dag, &a->request, &a->options);
	const struct rneagen_options o = transposed_options(&a->options, may_transpose);
	const struct parts_of x = divided(p, a, &o, may_transpose);

	if (!relay_or_parts(&p->relay, &p->parts, &p->part_count, &x, a->arena, a->error) && !p->relay && !may_transpose)
		tiles_choose(&p->functions[0], p->parts, p->part_count, &x, a->arena, a->error);
	p->is_transposed = may_transpose && (p->relay || p->part_count);
	analysis_free_raw(a);
	return a->error->code;
}

/* On a GPU the main kernel alone is long enough, and its grid may have parts instead. */
static enum segment_use segment_use(const struct plans *p, const struct analysis *a, int function)
{
	const struct target_type *target = target_type_of(a->options.target);

	if (target->kernel)
		return function == 0 && !p->part_count ? SEGMENT_KERNEL : SEGMENT_NONE;
	return target->has_batches ? SEGMENT_LOOPS : SEGMENT_NONE;
}

enum rneagen_code plans_segments(struct plans *p, struct analysis *a)
{
	const struct target_type *target = target_type_of(a->options.target);

	for (int i = 0; i < p->function_count; i++)
		if (!segments_choose(&p->functions[i], segment_use(p, a, i), &a->request, &a->options, a->arena))
			return error_memory(a->error);
	if (!target->kernel && a->adjust.prune == 0 &&
		!lanes_single(p->functions, &a->request, &a->options, target->is_header, a->arena))
		error_memory(a->error);
	return a->error->code;
}

/* Of what a kernel computes: the main function, or its parts; but where these share nothing, the whole serves small batches. */
static enum rneagen_code choose_for_kernel(struct plans *p, struct analysis *a,
	int (*choose)(struct function *const *functions, int count, const struct rneagen_options *o, struct arena *a))
{
	int in_parts = p->part_count && !parts_are_apart(p->parts, p->part_count), count = in_parts ? p->part_count : 1;
	const struct rneagen_options o = transposed_options(&a->options, p->is_transposed);
	struct function **functions = arena_alloc(a->arena, (size_t)count, sizeof *functions);

	if (!target_type_of(a->options.target)->kernel)
		return RNEAGEN_OK;
	for (int i = 0; i < count && functions; i++)
		functions[i] = in_parts ? &p->parts[i].function : &p->functions[0];
	return functions && choose(functions, count, &o, a->arena) ? RNEAGEN_OK : error_memory(a->error);
}

/* Of the rounds of what found.h divides, where they have some. */
static int found_limbs(struct plans *p, struct analysis *a)
{
	const struct parts_of x = divided(p, a, &a->options, p->is_transposed);

	return parts_division(p->parts, p->part_count) != DIVIDED_IN_ROUNDS ||
		found_limbs_make(&p->rounds, p->parts, p->part_count, &x, a->arena);
}

enum rneagen_code plans_limbs(struct plans *p, struct analysis *a)
{
	const struct rneagen_options o = transposed_options(&a->options, p->is_transposed);
	int are_apart = parts_are_apart(p->parts, p->part_count); /* without windows, and so is the whole, for small batches */

	if (!found_limbs(p, a))
		return error_memory(a->error);
	if (p->rounds)
		return RNEAGEN_OK;
	if ((!are_apart && !p->is_transposed && choose_for_kernel(p, a, windows_choose)) || choose_for_kernel(p, a, limbs_choose))
		return a->error->code;
	limbs_beside(&p->functions[0].limbs, p->parts, p->part_count, &a->options);
	return !p->relay || relay_limbs(p->relay, &o, a->arena) ? RNEAGEN_OK : error_memory(a->error);
}

enum rneagen_code plans_kernels(struct plans *p, struct analysis *a)
{
	const struct rneagen_options o = transposed_options(&a->options, p->is_transposed);
	const struct parts_of x = divided(p, a, &o, p->is_transposed);

	p->kernels = kernels_choose(&x, p->parts, p->part_count, p->relay, a->arena);
	return a->arena->failed ? error_memory(a->error) : RNEAGEN_OK;
}
