#include "choices.h"
#include "base/identifier.h"
#include "emit/emit.h"
#include <string.h>

static enum rneagen_code check_bits(const struct rneagen_options *o, struct rneagen_error *e)
{
	if (o->strict && o->trig == RNEAGEN_FAST)
		return error_set(e, RNEAGEN_USAGE,
			"--strict and --trig fast exclude each other: the sine of a GPU's own unit has other bits; take bounded");
	if (o->strict && o->precision == RNEAGEN_F32X2)
		return error_set(e, RNEAGEN_USAGE,
			"--strict and --precision f32x2 exclude each other: its products have other bits where no fused multiply-add is; take f64");
	if (o->bounded && o->target != RNEAGEN_TARGET_C)
		return error_set(e, RNEAGEN_USAGE, "--bounded is for target c: take --target c, or an output whose name ends in .c");
	if (o->bounded && o->precision == RNEAGEN_F32X2)
		return error_set(e, RNEAGEN_USAGE,
			"--bounded and --precision f32x2 exclude each other: pairs of floats have no bounded function; take f64");
	return RNEAGEN_OK;
}

/* Numbers that would change nothing. That parts are for kernels is told where they are made. */
static enum rneagen_code check_counts(const struct rneagen_options *o, struct rneagen_error *e)
{
	const struct target_type *target = target_type_of(o->target);

	if (o->limbs > RNEAGEN_LIMBS_NONE && (o->target != RNEAGEN_TARGET_CUDA || o->precision == RNEAGEN_F32X2))
		return error_set(e, RNEAGEN_USAGE, "--limbs %d is for kernels%s", o->limbs,
			o->target != RNEAGEN_TARGET_CUDA ? ": take --target cuda"
				: ", but of no pairs of floats: take another --precision");
	if (o->segments > RNEAGEN_SEGMENTS_WHOLE && target->is_header)
		return error_set(e, RNEAGEN_USAGE,
			"--segments %d is for functions of batches and for kernels, and a header has neither: leave it out, or take "
			"--target c or cuda", o->segments);
	if (o->segments > RNEAGEN_SEGMENTS_WHOLE && o->parts > 1 && target->kernel)
		return error_set(e, RNEAGEN_USAGE,
			"--segments %d and --parts %d exclude each other: a kernel in parts has no segments; leave one out", o->segments, o->parts);
	return RNEAGEN_OK;
}

enum rneagen_code choices_resolve(struct analysis *a)
{
	struct rneagen_options *o = &a->options;
	struct rneagen_error *e = a->error;

	o->precision = emit_precision_of(o);
	if (check_bits(o, e) || check_counts(o, e))
		return e->code;
	if (!o->name)
		o->name = identifier_from(a->robot.name, a->arena);
	else if (!identifier_is(o->name))
		return error_set(e, RNEAGEN_NAME,
			"--name '%.255s' is no C identifier: letters, digits and underscores, no digit first, no keyword, no underscore before "
			"another or a capital first",
			o->name);
	return o->name ? RNEAGEN_OK : error_memory(e);
}

/* The main function is the one that a text's head names. */
static enum rneagen_code check_only(struct analysis *a)
{
	const struct algorithm *made[ALGORITHM_COUNT];
	int *only = &a->options.only, asked = *only;

	if (!asked || !algorithms_for(&a->request, made))
		return RNEAGEN_OK;
	*only = RNEAGEN_ONLY_RNEA;
	while (*only < RNEAGEN_ONLY_KIN && strcmp(emit_only_name(*only), made[0]->name) != 0)
		++*only;
	if (asked == RNEAGEN_ONLY_MAIN || asked == *only)
		return RNEAGEN_OK;
	return error_set(a->error, RNEAGEN_USAGE, "--only %s: with these outputs the function is %s: take --only %s",
		emit_only_name(asked), made[0]->name, made[0]->name);
}

enum rneagen_code choices_check(struct analysis *a)
{
	const struct request *k = &a->request;

	if (a->options.strict && k->refine_steps && k->refine == REFINE_F32X2)
		return error_set(a->error, RNEAGEN_USAGE,
			"--strict and --refine %d:f32x2 exclude each other: products of pairs of floats have other bits where no fused multiply-add "
			"is; take %d:f64", k->refine_steps, k->refine_steps);
	if (a->options.bounded && k->refine_steps)
		return error_set(a->error, RNEAGEN_USAGE,
			"--bounded and --refine exclude each other: a bound beside the statements does not see what refinement takes off");
	return check_only(a);
}
