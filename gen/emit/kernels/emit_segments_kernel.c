/* Kernels in segments: each thread runs a segment for its samples before the next one. */
#include "base/template.h"
#include "emit/emit.h"
#include "emit/kernels/emit_segments_kernel.h"
#include "plan/segments.h"
#include "plan/stage.h"

static const char *loops_in_kernel(const struct emission *e, const struct function *p)
{
	int has_angles = emit_has_known(e) && emit_has_angles(e, p);
	const char *at_sample = emit_at_sample(e, p, e->options->layout);
	struct text t;

	text_init(&t, e->arena);
	for (int k = 0; k < p->segments.count; k++) {
		const struct slot slots[] = {{"NAME", e->options->name}, {"FUNCTION", p->algorithm->name}, {"NUMBER", emit_int(e, k)},
			{"FROM", has_angles ? "from" : "0"}, {"TO", has_angles ? "to" : "each"},
			{"LARGE", has_angles ? "large |= (unsigned)!" : ""}, {"SHIFT", has_angles ? " << j" : ""},
			{"AT_SAMPLE", at_sample}, {"ACROSS", emit_across(e, &p->segments, ACROSS_AT_THREAD)},
			{"KNOWN", emit_handed_on(e, has_angles ? emit_known_tables(e, p) : emit_unknown_names(e))}};

		template_expand(&t, template_kernel_segment_in, slots, sizeof slots / sizeof *slots);
	}
	return text_string(&t);
}

static const char *rounds_in_kernel(const struct emission *e, const struct function *p)
{
	const char *loops = loops_in_kernel(e, p);
	struct text t;

	if (!emit_has_known(e) || !emit_has_angles(e, p))
		return loops;
	text_init(&t, e->arena);
	emit_rounds(e, p, loops, &t);
	return text_string(&t);
}

void emit_segments_kernel(const struct emission *e, const struct function *p, struct text *out)
{
	const struct slot slots[] = {{"NAME", e->options->name}, {"FUNCTION", p->algorithm->name},
		{"BOUNDS", p == emit_main(e) ? "RNEA_BLOCK, RNEA_MIN_BLOCKS" : "RNEA_BLOCK"},
		{"MOST", emit_int(e, kernels_segment_samples(e->options))},
		{"BYTES", emit_int(e, segments_bytes(&p->segments, e->options, e->wide != NULL))},
		{"SHARED_BYTES", emit_int(e, SHARED_BYTES)}, {"RESTRICT_PARAMS", emit_params(e, p, PARAMS_CUDA_RESTRICT)},
		{"SHARED", emit_across(e, &p->segments, ACROSS_SHARED)}, {"LOCAL", emit_across(e, &p->segments, ACROSS_LOCAL)},
		{"ROUNDS", rounds_in_kernel(e, p)}};

	template_expand(out, template_kernel_segments_in, slots, sizeof slots / sizeof *slots);
}
