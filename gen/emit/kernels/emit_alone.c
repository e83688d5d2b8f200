/* A kernel of its own for each part of matrices, beside the one whose grid has all of them along y. */
#include "base/template.h"
#include "emit/emit.h"

/* From one warp for each scheduler of an H100 on; of texts longer than so many operations. */
enum { LEAST_SAMPLES = 132 * 128, LEAST_OPERATIONS = 11000 };

/* Smaller batches leave multiprocessors idle that the one kernel gives other parts. Beyond, the blocks of one part do not share a
   multiprocessor with those of another, and each takes the registers that it needs. In f64 all parts take all registers there are, and a
   million samples lose. Measurements: gen/plan/README.md, Parts of matrices. */
int emit_alone_least(const struct emission *e)
{
	if (!e->target->kernel || !emit_has_columns(e) || e->part_count < 2 || e->arithmetic->bytes != 4 || e->wide)
		return 0;
	return plan_flops(parts_operations(e->parts, e->part_count, &emit_main(e)->plan)) > LEAST_OPERATIONS ? LEAST_SAMPLES : 0;
}

void emit_alone(const struct emission *e, struct text *out)
{
	struct text kernels;

	if (!emit_alone_least(e))
		return;
	text_init(&kernels, e->arena);
	for (int i = 0; i < e->part_count; i++)
		emit_kernel(e, &e->parts[i].pass, &kernels);
	const struct slot slots[] = {{"LEAST", emit_int(e, emit_alone_least(e))}, {"KERNELS", text_string(&kernels)},
		{"UNLESS_ALONE", EMIT_UNLESS_ALONE}};

	template_expand(out, template_alone_in, slots, sizeof slots / sizeof *slots);
}

const char *emit_launch_alone(const struct emission *e)
{
	struct text t, kernels;

	text_init(&t, e->arena);
	if (!emit_alone_least(e))
		return text_string(&t);
	text_init(&kernels, e->arena);
	for (int i = 0; i < e->part_count; i++)
		text_printf(&kernels, "%s(const void *)%s_%s_kernel", i ? ", " : "", e->options->name, e->parts[i].pass.algorithm->name);
	const struct slot slots[] = {{"KERNELS", text_string(&kernels)}, {"COUNT", emit_int(e, e->part_count)}};

	template_expand(&t, template_launch_alone_in, slots, sizeof slots / sizeof *slots);
	return text_string(&t);
}
