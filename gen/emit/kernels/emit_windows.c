/* Kernels in layout aos whose outputs leave through windows (plan/stage.h): the kernel, its windows, and what leaves when. */
#include "base/template.h"
#include "emit/emit.h"
#include "emit/kernels/emit_kernel.h"
#include "plan/stage.h"

/* A warp's outputs begin at its first sample, inputs at this thread's. */
static const char *windowed_arguments(const struct emission *e)
{
	const struct dag *d = &emit_main(e)->dag;
	struct text t;

	text_init(&t, e->arena);
	for (int i = 0; i < d->argument_count; i++) {
		const struct argument *a = &d->arguments[i];

		text_printf(&t, "%s%s", i ? ", " : "", a->name);
		if (!a->per_batch)
			text_printf(&t, " + %s*%d", a->is_output ? "first" : "k", a->rows);
	}
	return text_string(&t);
}

void emit_windowed(const struct emission *e, const struct function *p, struct text *out)
{
	const struct call call = {.indent = "\t", .arguments = windowed_arguments(e), .q = emit_q_at_sample(e), .stride = "1"};
	const struct slot slots[] = {
		{"NAME", e->options->name}, {"FUNCTION", p->algorithm->name}, {"SPILL", emit_spill(e)},
		{"RESTRICT_PARAMS", emit_params(e, p, PARAMS_CUDA_RESTRICT)}, {"CALL", emit_call(e, p, &call)},
	};

	template_expand(out, e->target->kernel->windowed, slots, sizeof slots / sizeof *slots);
}

/* The number of a function's first run among all. */
static int first_run(const struct emission *e, const struct function *p)
{
	int runs = 0;

	for (int k = 0; k < emit_part_places(e) && emit_part(e, k) != p; k++)
		for (int i = 0; i < emit_part(e, k)->windows.flush_count; i++)
			runs += emit_part(e, k)->windows.flushes[i].count;
	return runs;
}

void emit_put_flush(const struct emission *e, const struct function *p, int flush, struct text *out)
{
	const struct windows *w = &p->windows;
	const struct window_flush *f = &w->flushes[flush];
	int first = first_run(e, p);

	for (int i = 0; i < flush; i++)
		first += w->flushes[i].count;
	for (int i = 0, end; i < f->count; i = end) {
		const struct argument *a = &p->dag.arguments[f->runs[i].argument];

		for (end = i + 1; end < f->count && f->runs[end].argument == f->runs[i].argument; end++)
			;
		text_printf(out, "\tRNEA_FLUSH(%d, %s, %d, %d);\n", a->rows, a->name, first + i, end - i);
	}
}

/* `{30, 7, 210}, ...`: a run's first row, its rows, and where its slots begin among all; or the slots. */
static const char *runs_text(const struct emission *e, int slots)
{
	struct text t;
	unsigned begin = 0;

	text_init(&t, e->arena);
	for (int k = 0; k < emit_part_places(e); k++)
		for (int i = 0; i < emit_part(e, k)->windows.flush_count; i++) {
			const struct window_flush *f = &emit_part(e, k)->windows.flushes[i];

			for (const struct window_run *r = f->runs; r < f->runs + f->count; begin += r++->count)
				if (!slots)
					text_printf(&t, "%s{%u, %u, %u}", begin ? ", " : "", r->row, r->count, begin);
				else
					for (unsigned n = 0; n < r->count; n++)
						text_printf(&t, "%s%d", begin + n ? ", " : "", r->slots[n]);
		}
	return text_string(&t);
}

void emit_put_windows(const struct emission *e, struct text *out)
{
	const struct slot slots[] = {{"NAME", e->options->name}, {"T", e->memory->type}, {"BLOCK", emit_int(e, e->kernels.block)},
		{"SLOTS", emit_int(e, emit_windows(e)->slots)}, {"BYTES", emit_int(e, e->kernels.window_bytes)},
		{"SECTOR", emit_int(e, SECTOR_BYTES / e->memory->bytes)}, {"RUNS", runs_text(e, 0)}, {"RUN_SLOTS", runs_text(e, 1)}};

	template_expand(out, e->target->kernel->windows, slots, sizeof slots / sizeof *slots);
}
