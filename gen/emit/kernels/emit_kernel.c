/* CUDA kernels: how a slice of the batch reaches the body. What they take of a multiprocessor: emit_blocks.c. */
#include "emit/emit.h"
#include "base/template.h"
#include "plan/stage.h"

static const struct dag *arguments_of(const struct emission *e)
{
	return &emit_main(e)->dag;
}

static int is_in_place(const struct dag *d)
{
	int tau = dag_find_role(d, ROLE_JOINT_TORQUE, 1);

	return stage_place(d, tau) != tau;
}

/* ---- slices in shared memory ---- */

/* `*const q_slice = slices, *const qd_slice = q_slice + RNEA_BLOCK*7, ...`: where the slices of the arrays begin; in soa
   where this thread's rows do. */
static const char *slices_text(const struct emission *e)
{
	const struct dag *d = arguments_of(e);
	const struct argument *last = NULL;
	struct text t;

	text_init(&t, e->arena);
	for (int i = 0; i < d->argument_count; i++) {
		if (!stage_has_place(d, i))
			continue;
		text_printf(&t, "%s*const %s_slice = ", last ? ", " : "", d->arguments[i].name);
		if (last)
			text_printf(&t, "%s_slice + RNEA_BLOCK*%d", last->name, emit_pitch(e, last->rows));
		else
			text_put(&t, e->options->layout == RNEAGEN_AOS ? "slices" : "slices + threadIdx.x");
		last = &d->arguments[i];
	}
	return text_string(&t);
}

/* What the body is called with: q_here, qd_here, ..., and as it is what all samples share. */
static const char *here_text(const struct emission *e)
{
	const struct dag *d = arguments_of(e);
	struct text t;

	text_init(&t, e->arena);
	for (int i = 0; i < d->argument_count; i++)
		text_printf(&t, "%s%s%s", i ? ", " : "", d->arguments[i].name, d->arguments[i].per_batch ? "" : "_here");
	return text_string(&t);
}

/* Those pointers: to this thread's rows in the slices or, where nothing is staged, in the arrays. */
static const char *pointers_text(const struct emission *e)
{
	const struct dag *d = arguments_of(e);
	struct text t;

	text_init(&t, e->arena);
	for (int i = 0; i < d->argument_count; i++) {
		const struct argument *a = &d->arguments[i], *place = &d->arguments[stage_place(d, i)];

		if (a->per_batch)
			continue;
		text_printf(&t, "%s%s%s *const %s_here = staged ? %s_slice", e->options->layout == RNEAGEN_AOS ? "\t\t" : "\t",
			a->is_output ? "" : "const ", e->memory->type, a->name, place->name);
		if (e->options->layout == RNEAGEN_AOS)
			text_printf(&t, " + threadIdx.x*%d : %s + k*%d;\n", emit_pitch(e, place->rows), a->name, a->rows);
		else
			text_printf(&t, " : %s + k;\n", a->name);
	}
	return text_string(&t);
}

typedef void put_move(const struct emission *e, int argument, struct text *out);

/* aos: a line for each array that comes, or goes. */
static const char *moves_text(const struct emission *e, int is_output, put_move *put)
{
	const struct dag *d = arguments_of(e);
	struct text t;

	text_init(&t, e->arena);
	for (int i = 0; i < d->argument_count; i++)
		if (!d->arguments[i].per_batch && d->arguments[i].is_output == is_output)
			put(e, i, &t);
	return text_string(&t);
}

static void put_slice_in(const struct emission *e, int argument, struct text *out)
{
	const struct argument *a = &arguments_of(e)->arguments[argument];

	text_printf(out, "\t\trneagen_stage_in<%d, %d>(%s_slice, %s + first*%d, samples);\n", a->rows, emit_pitch(e, a->rows),
		a->name, a->name, a->rows);
}

static void put_slice_out(const struct emission *e, int argument, struct text *out)
{
	const struct dag *d = arguments_of(e);
	const struct argument *a = &d->arguments[argument];

	text_printf(out, "\t\trneagen_stage_out<%d, %d>(%s + first*%d, %s_slice, samples);\n", a->rows, emit_pitch(e, a->rows),
		a->name, a->rows, d->arguments[stage_place(d, argument)].name);
}

/* soa: a thread fetches or writes its own sample; one loop for arrays of one length that follow each other. */
static const char *move_samples(const struct emission *e, int out)
{
	const struct dag *d = arguments_of(e);
	struct text t;
	int rows = 0;

	text_init(&t, e->arena);
	for (int i = 0; i < d->argument_count; i++) {
		const struct argument *a = &d->arguments[i];
		const char *place = d->arguments[stage_place(d, i)].name;

		if (a->per_batch || a->is_output != out)
			continue;
		if (a->rows != rows)
			text_printf(&t, "%s#pragma unroll\n\t\tfor (unsigned r = 0; r < %d; r++) {\n", rows ? "\t\t}\n" : "", a->rows);
		rows = a->rows;
		if (out)
			text_printf(&t, "\t\t\t%s[r*count + k] = %s_slice[r*RNEA_BLOCK];\n", a->name, place);
		else
			text_printf(&t, "\t\t\trneagen_stage_copy<sizeof *%s>(%s_slice + r*RNEA_BLOCK, %s + r*count + k);\n", a->name, a->name, a->name);
	}
	text_put(&t, rows ? "\t\t}\n" : "");
	return text_string(&t);
}

/* ---- windows ---- */

/* What memory is written in. */
enum { SECTOR_BYTES = 32 };

/* Derivatives may take more values than there are registers. ptxas refuses this where the launch gives shared memory. */
static const char *spill_text(const struct emission *e)
{
	const struct slot slots[] = {{"UNLESS_GIVEN", emit_is_staged(e) ? " && !RNEA_GIVEN_BYTES" : ""}};
	struct text t;

	text_init(&t, e->arena);
	if (emit_is_full(e) && !emit_main(e)->segments.count)
		template_expand(&t, e->target->kernel->spill, slots, sizeof slots / sizeof *slots);
	return text_string(&t);
}

/* A warp's outputs begin at its first sample, inputs at this thread's. */
static const char *windowed_arguments(const struct emission *e)
{
	const struct dag *d = arguments_of(e);
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

static void put_windowed(const struct emission *e, const struct pass *p, struct text *out)
{
	const struct call call = {.indent = "\t", .arguments = windowed_arguments(e), .q = emit_q_at_sample(e), .stride = "1"};
	const struct slot slots[] = {
		{"NAME", e->options->name}, {"PASS", p->algorithm->name}, {"SPILL", spill_text(e)},
		{"RESTRICT_PARAMS", emit_params(e, p, PARAMS_CUDA_RESTRICT)}, {"CALL", emit_call(e, p, &call)},
	};

	template_expand(out, e->target->kernel->windowed, slots, sizeof slots / sizeof *slots);
}

/* The number of a pass's first run among all. */
static int first_run(const struct emission *e, const struct pass *p)
{
	int runs = 0;

	for (int k = 0; k < emit_part_places(e) && emit_part(e, k) != p; k++)
		for (int i = 0; i < emit_part(e, k)->windows.flush_count; i++)
			runs += emit_part(e, k)->windows.flushes[i].count;
	return runs;
}

void emit_put_flush(const struct emission *e, const struct pass *p, int flush, struct text *out)
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

static void put_windows(const struct emission *e, struct text *out)
{
	const struct slot slots[] = {{"NAME", e->options->name}, {"T", e->memory->type}, {"BLOCK", emit_int(e, emit_block_size(e))},
		{"SLOTS", emit_int(e, emit_windows(e)->slots)}, {"BYTES", emit_int(e, emit_window_bytes(e))},
		{"SECTOR", emit_int(e, SECTOR_BYTES / e->memory->bytes)}, {"RUNS", runs_text(e, 0)}, {"RUN_SLOTS", runs_text(e, 1)}};

	template_expand(out, e->target->kernel->windows, slots, sizeof slots / sizeof *slots);
}

static const char *kernel_call(const struct emission *e, const struct pass *p, int staged)
{
	int is_soa = e->options->layout == RNEAGEN_SOA;
	const struct call here = {.indent = is_soa ? "\t" : "\t\t", .arguments = here_text(e), .q = "q_here", .stride = is_soa ? "stride" : "1"};
	const struct call there = {.indent = "\t", .arguments = emit_params(e, p, PARAMS_AT_SAMPLE), .q = emit_q_at_sample(e),
		.stride = emit_stride(e), .is_optimistic = p == emit_main(e) && emit_is_optimistic(e)};

	return emit_call(e, p, staged ? &here : &there);
}

/* One call for each array that has rows of each sample. */
static const char *prefetch_text(const struct emission *e, const struct pass *p)
{
	struct text t;

	text_init(&t, e->arena);
	if (p != emit_main(e) || !emit_is_prefetched(e))
		return text_string(&t);
	for (int i = 0; i < p->dag.argument_count; i++) {
		const struct argument *a = &p->dag.arguments[i];

		if (!a->is_output && !a->per_batch)
			text_printf(&t, "\trneagen_prefetch<%d>(%s + k, count);\n", a->rows, a->name);
	}
	return text_string(&t);
}

/* The slices' shared memory: the kernel's own, the launch's, or none. */
static const char *declaration_text(const struct emission *e)
{
	const struct slot slots[] = {{"T", e->memory->type}, {"WORDS", emit_int(e, emit_stage_words(e))}};
	struct text t;

	text_init(&t, e->arena);
	template_expand(&t, e->target->kernel->slices, slots, sizeof slots / sizeof *slots);
	return text_string(&t);
}

static void put_kernel(const struct emission *e, const struct pass *p, struct text *out)
{
	int staged = emit_is_staged(e) && p == emit_main(e), is_aos = e->options->layout == RNEAGEN_AOS;
	const struct slot slots[] = {
		{"NAME", e->options->name}, {"PASS", p->algorithm->name}, {"T", e->memory->type},
		{"SPILL", spill_text(e)}, {"ZEROS", p == emit_main(e) ? emit_zero_loops(e, "blockIdx.y", "") : ""}, {"BOUNDS", p == emit_main(e) ? "RNEA_BLOCK, RNEA_MIN_BLOCKS" : "RNEA_BLOCK"},
		{"RESTRICT_PARAMS", emit_params(e, p, PARAMS_CUDA_RESTRICT)}, {"CALL", kernel_call(e, p, staged)},
		{"PREFETCH", prefetch_text(e, p)}, {"DECLARATION", declaration_text(e)}, {"SLICES", slices_text(e)}, {"POINTERS", pointers_text(e)},
		{"MOVE_IN", is_aos ? moves_text(e, 0, put_slice_in) : move_samples(e, 0)},
		{"MOVE_OUT", is_aos ? moves_text(e, 1, put_slice_out) : move_samples(e, 1)},
		{"IN_PLACE", !is_in_place(arguments_of(e)) ? "" :
			"\t/* tau takes the place of qdd: a joint's qdd is read before its torque is written */\n"},
	};

	const struct kernel_frames *f = e->target->kernel;
	template_expand(out, !staged ? f->direct : is_aos ? f->staged_aos : f->staged_soa, slots, sizeof slots / sizeof *slots);
}

static void put_pass(const struct emission *e, const struct pass *p, struct text *out)
{
	if (p->segments.count)
		emit_segments_kernel(e, p, out);
	else
		put_kernel(e, p, out);
}

void emit_kernels(const struct emission *e, struct text *out)
{
	emit_zeros(e, out);
	text_put(out, emit_has_limbs(e) ? EMIT_UNLESS_LIMBS : "");
	if (e->relay) {
		put_pass(e, &e->relay->start.pass, out);
		emit_relay_solve(e, out);
	}
	for (int i = 0; i < e->pass_count && e->target->kernel; i++)
		if (i == 0 && !e->passes[i].segments.count && emit_windows(e)->slots)
			put_windowed(e, &e->passes[i], out);
		else
			put_pass(e, &e->passes[i], out);
	if (emit_has_limbs(e))
		emit_limbs(e, out);
}

/* Rows of matrices in soa, in whole lines; not what goes to shared memory. H100, both gradients
   of floating hyq in f64, 2 parts, 16384 samples: 38 us instead of 70, 1 M samples: 1.95 ms instead of 2.34; of iiwa14
   in f32, 131072 samples: 26.5 us instead of 31.5, 1 M the same; of atlas in f64 3 % slower, since the compiler orders
   stores less freely. Of the regressor, an array of many rows, nvcc takes minutes to tell stores apart
   that it sees. */
int emit_is_streamed(const struct emission *e)
{
	int has_matrix = request_wants_derivative(e->request) || request_wants(e->request, WANT_REGRESSOR);

	return e->target->kernel && has_matrix && e->options->layout == RNEAGEN_SOA && !emit_is_staged(e);
}

const char *emit_store(const struct emission *e)
{
	const struct scalar *s = e->memory;
	const struct slot slots[] = {{"T", s->type}, {"SUFFIX", s->name}, {"CONSTRAINT", s->letter}};
	struct text t;

	text_init(&t, e->arena);
	if (emit_is_streamed(e))
		template_expand(&t, e->target->kernel->store, slots, sizeof slots / sizeof *slots);
	if (e->target->kernel && emit_windows(e)->slots)
		put_windows(e, &t);
	return text_string(&t);
}

const char *emit_stage(const struct emission *e)
{
	const struct kernel_frames *f = e->target->kernel;
	const struct slot slots[] = {{"NAME", e->options->name}, {"PASS", emit_main(e)->algorithm->name}, {"T", e->memory->type},
		{"BYTES", emit_int(e, emit_slice_bytes(e))}, {"COPY", f ? f->stage_copy : ""}};
	struct text t;

	text_init(&t, e->arena);
	if (f && emit_is_prefetched(e))
		template_expand(&t, f->prefetch, slots, sizeof slots / sizeof *slots);
	if (f && emit_is_staged(e))
		template_expand(&t, f->stage, slots, sizeof slots / sizeof *slots);
	if (f && emit_is_staged(e) && e->options->layout == RNEAGEN_AOS)
		template_expand(&t, f->stage_aos, slots, sizeof slots / sizeof *slots);
	return text_string(&t);
}

const char *emit_stage_launch(const struct emission *e)
{
	return e->target->kernel && emit_is_staged(e) ? e->target->kernel->stage_launch : "";
}

const char *emit_given(const struct emission *e)
{
	struct text t;

	if (!emit_is_staged(e))
		return "0";
	text_init(&t, e->arena);
	text_printf(&t, "rneagen_given_bytes((const void *)%s_%s_kernel)", e->options->name, emit_main(e)->algorithm->name);
	return text_string(&t);
}

int emit_stage_bytes(const struct emission *e)
{
	return e->target->kernel && emit_is_staged(e) ? emit_slice_bytes(e) : 0;
}
