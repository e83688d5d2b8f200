/* CUDA kernels: how a slice of the batch reaches the body. What they take of a multiprocessor: plan/kernels.h. */
#include "base/template.h"
#include "emit/emit.h"
#include "emit/kernels/emit_alone.h"
#include "emit/kernels/emit_kernel.h"
#include "emit/kernels/emit_limbs.h"
#include "emit/kernels/emit_parts.h"
#include "emit/kernels/emit_relay.h"
#include "emit/kernels/emit_segments_kernel.h"
#include "emit/kernels/slices/emit_slices.h"
#include "emit/kernels/emit_tiles.h"
#include "emit/kernels/emit_transpose.h"
#include "plan/stage.h"

/* What is written where an input stood. */
static const char *in_place_text(const struct emission *e, const struct part *part)
{
	const struct dag *d = emit_arguments(e);
	int tau = dag_find_role(d, ROLE_JOINT_TORQUE, 1);

	if (part && part->function.stretches->period)
		return "\t/* outputs take the places of inputs: a row is read before it is written, the vjp's for q, qd and qdd where "
			"these were */\n";
	return stage_place(d, tau) == tau ? "" :
		"\t/* tau takes the place of qdd: a joint's qdd is read before its torque is written */\n";
}

/* Derivatives may take more values than there are registers. ptxas refuses this where the launch gives shared memory. */
static const char *spill_text(const struct emission *e, const char *unless_given)
{
	const struct slot slots[] = {{"UNLESS_GIVEN", unless_given}};

	return template_text(e->arena, e->target->kernel->spill, slots, sizeof slots / sizeof *slots);
}

const char *emit_spill(const struct emission *e)
{
	if (!e->kernels.is_full || emit_main(e)->segments.count)
		return "";
	return spill_text(e, e->kernels.is_staged ? " && !RNEA_GIVEN_BYTES" : "");
}

/* What a kernel's block does to its slice: all of it, or a part that shares nothing with others. */
struct work {
	const struct function *function;
	const struct part *part; /* NULL: all of it */
	int is_staged;
	const char *alone; /* the name of a kernel of large batches, which has nothing else to do; NULL: it is none */
};

/* Where kernels before have left what they hand on: in the last array. */
static const char *handed_text(const struct emission *e, const struct function *p)
{
	const struct dag *d = emit_arguments(e);
	struct text t;

	text_init(&t, e->arena);
	emit_put_at_sample(e, &d->arguments[parts_handed(d)], &t);
	return emit_handed(e, p, text_string(&t), emit_stride(e));
}

/* On the arrays themselves. */
static const char *direct_call(const struct emission *e, const struct work *w)
{
	const struct call there = {.indent = "\t", .arguments = emit_params(e, w->function, PARAMS_AT_SAMPLE), .q = emit_q_at_sample(e),
		.stride = emit_stride(e), .q_stride = emit_q_stride(e),
		.is_optimistic = emit_is_of_main(e, w->function) && e->kernels.is_optimistic, .part = w->part,
		.handed = handed_text(e, w->function)};

	return emit_call(e, w->function, &there);
}

static const char *kernel_call(const struct emission *e, const struct work *w, const struct slices *s)
{
	int is_soa = e->options->layout == RNEAGEN_SOA;
	const struct call here = {.indent = is_soa ? "\t" : "\t\t", .arguments = s->here, .q = "q_here",
		.stride = is_soa ? "stride" : "1", .part = w->part, .is_staged = 1,
		.has_threads = emit_each_block(e) > 0,
		.handed = emit_takes_found(w->function) ? "found_here, mu_here, 1" : handed_text(e, w->function)};

	return w->is_staged ? emit_call(e, w->function, &here) : direct_call(e, w);
}

/* One call for each array that has rows of each sample. */
static const char *prefetch_text(const struct emission *e, const struct function *p)
{
	struct text t;

	text_init(&t, e->arena);
	if (p != emit_main(e) || !e->kernels.is_prefetched)
		return text_string(&t);
	for (int i = 0; i < p->dag.argument_count; i++) {
		const struct argument *a = &p->dag.arguments[i];

		if (!a->is_output && !a->per_batch)
			text_printf(&t, "\trneagen_prefetch<%d>(%s + k, count);\n", a->rows, a->name);
	}
	return text_string(&t);
}

/* How the function begins: a kernel, or what it calls for a part. */
static const char *head_text(const struct emission *e, const struct work *w)
{
	const char *name = w->function->algorithm->name, *params = emit_params(e, w->function, PARAMS_CUDA_RESTRICT);
	struct text t;

	text_init(&t, e->arena);
	if (w->alone)
		text_printf(&t, "extern \"C\" __global__ void __launch_bounds__(RNEA_PART_BLOCK)\n%s_%s_kernel(%s, size_t count)",
			e->options->name, w->alone, params);
	else if (!w->part)
		text_printf(&t, "extern \"C\" __global__ void __launch_bounds__(RNEA_BLOCK%s)\n%s_%s_kernel(%s, size_t count)",
			w->function == emit_main(e) ? ", RNEA_MIN_BLOCKS" : "", e->options->name, name, params);
	else
		text_printf(&t, "static __device__ __forceinline__ void\n%s_%s_block(%s, size_t count%s%s%s)", e->options->name, name, params,
			w->is_staged ? ", " : "", w->is_staged ? e->memory->type : "", w->is_staged ? " *slices, const bool staged" : "");
	return text_string(&t);
}

/* Each part's share. */
static const char *zeros_text(const struct emission *e, const struct function *p)
{
	int part = emit_column_part(e, p);

	if (part >= 0)
		return emit_zero_loops(e, emit_int(e, part), emit_int(e, e->part_count));
	return p == emit_main(e) ? emit_zero_loops(e, "blockIdx.y", "gridDim.y") : "";
}

static void put_work(const struct emission *e, const struct work *w, struct text *out)
{
	const struct slices s = emit_slices(e, w->part ? w->part->function.stretches : NULL, "RNEA_BLOCK");
	int has_threads = emit_each_block(e) > 0;
	const struct slot slots[] = {
		{"HEAD", head_text(e, w)}, {"NAME", e->options->name}, {"FUNCTION", w->function->algorithm->name}, {"T", e->memory->type},
		{"SPILL", emit_spill(e)}, {"ZEROS", zeros_text(e, w->function)},
		{"CALL", kernel_call(e, w, &s)}, {"TRANSPOSE", emit_transpose_begin(e)}, {"PREFETCH", prefetch_text(e, w->function)},
		{"DECLARATION", w->part ? "" : emit_slices_declaration(e, e->kernels.slice_words)},
		{"SLICES", s.slices}, {"POINTERS", s.pointers}, {"MOVE_IN", s.move_in}, {"MOVE_OUT", s.move_out}, {"JOIN", s.join},
		{"IN_PLACE", in_place_text(e, w->part)}, {"BLOCK", has_threads ? "RNEA_BLOCK" : "blockDim.x"},
		{"SAMPLE", has_threads ? ", sample = threadIdx.x%RNEA_BLOCK" : ""},
		/* threads that wait for each other run without a sample too */
		{"RUNS", has_threads ? "RNEA_SAMPLE_THREADS > 1 ? samples > 0 : sample < samples" : "threadIdx.x < samples"},
		{"OWN", has_threads ? "sample" : "threadIdx.x"},
	};
	const struct kernel_frames *f = e->target->kernel;

	template_expand(out, !w->is_staged ? f->direct : e->options->layout == RNEAGEN_AOS ? f->staged_aos : f->staged_soa, slots,
		sizeof slots / sizeof *slots);
}

static void put_kernel(const struct emission *e, const struct function *p, struct text *out)
{
	const struct work w = {p, NULL, e->kernels.is_staged && p == emit_main(e), NULL};

	put_work(e, &w, out);
}

static void put_tiled(const struct emission *e, const struct work *w, struct text *out)
{
	const struct tiled_kernel k = {.function = w->function,
		.part = w->part,
		.name = w->alone,
		.handed = handed_text(e, w->function),
		.spill = spill_text(e, ""),
		.zeros = zeros_text(e, w->function),
		.direct = direct_call(e, w)};

	emit_tiled_kernel(e, &k, out);
}

void emit_alone_kernel(const struct emission *e, int part, struct text *out)
{
	const struct work w = {emit_part(e, part), emit_is_apart(e) ? &e->parts[part] : NULL, 0, emit_alone_name(e, part)};

	(w.function->tiles ? put_tiled : put_work)(e, &w, out);
}

/* A kernel of parts that share nothing, named after a function. */
struct apart {
	const struct part *parts;
	int count, words, is_alone; /* words: which it stages of a sample; is_alone: the parts have kernels of their own too, with what
				       asks for angles */
	const char *function, *kernel, *what, *bounds;
};

/* When a launch would leave rows as they were. */
static const char *wrong_text(const struct emission *e, int parts)
{
	return text_format(e->arena,
		emit_each_block(e) ? "(gridDim.y != %d || blockDim.x != RNEA_BLOCK*RNEA_SAMPLE_THREADS)" : "gridDim.y != %d",
		parts);
}

/* A function for each of the parts, and the kernel that calls them. */
static void put_apart(const struct emission *e, const struct apart *x, struct text *out)
{
	const char *name = e->options->name;
	struct text cases;

	text_init(&cases, e->arena);
	for (int i = 0; i < x->count; i++) {
		const struct work w = {&x->parts[i].function, &x->parts[i], x->words > 0, NULL};

		if (!x->is_alone)
			emit_part_small(e, &x->parts[i], out);
		put_work(e, &w, out);
		text_printf(&cases, "\tcase %d:\n\t\t%s_%s_block(%s, count%s);\n\t\tbreak;\n", i, name, w.function->algorithm->name,
			emit_params(e, w.function, PARAMS_NAMES), x->words ? ", slices, staged" : "");
	}
	const struct slot slots[] = {{"NAME", name}, {"FUNCTION", x->function}, {"KERNEL", x->kernel}, {"WHAT", x->what},
		{"RESTRICT_PARAMS", emit_params(e, emit_main(e), PARAMS_CUDA_RESTRICT)}, {"BOUNDS", x->bounds},
		{"DECLARATION", x->words ? emit_slices_declaration(e, x->words) : ""}, {"COUNT", emit_int(e, x->count)},
		{"CASES", text_string(&cases)}, {"THREADS", emit_each_threads(e)},
		{"WRONG", wrong_text(e, x->count)},
		{"TRAP", emit_each_block(e) ? "blocks have RNEA_BLOCK*RNEA_SAMPLE_THREADS threads, and a grid one row" :
			"a launch of some parts would leave rows as they were"}};

	template_expand(out, e->target->kernel->apart, slots, sizeof slots / sizeof *slots);
}

static const char SHARE_NOTHING[] = "Parts that share nothing";

/* What a kernel before the main one has. */
static const char *before_text(const struct emission *e)
{
	enum division division = emit_division(e);

	if (division == DIVIDED_BY_SIDES)
		return "The limbs of one side; a launch runs this kernel before the one that reads what the base takes of them";
	if (division == DIVIDED_BY_HANDS)
		return "Hands, each a part; a launch runs this kernel before the one that reads what they hand on";
	if (division == DIVIDED_BASE_FIRST && emit_hand_levels(e) == 1)
		return "What is found first; a launch runs this kernel before the one that reads it";
	return "One of the kernels before; a launch runs it before those that read what it leaves";
}

static void put_both(const struct emission *e, struct text *out)
{
	const struct kernels *k = &e->kernels;
	struct apart x = {.parts = e->parts, .words = k->is_staged ? k->slice_words : 0, .is_alone = k->alone_least > 0,
		.function = emit_main(e)->algorithm->name, .bounds = ", RNEA_MIN_BLOCKS", .what = before_text(e)};

	for (int level = 0; level < emit_hand_levels(e); level++) {
		x.count = emit_hands_of(e, level);
		x.kernel = emit_hands_kernel(e, level);
		put_apart(e, &x, out);
		x.parts += x.count;
	}
	x.count = e->part_count - emit_hands(e);
	x.kernel = "kernel";
	x.what = x.count > 1 ? SHARE_NOTHING : "One part";
	put_apart(e, &x, out);
}

/* A relay's first kernel in parts. */
static void put_starts(const struct emission *e, struct text *out)
{
	const struct apart starts = {.parts = e->relay->starts, .count = e->relay->start_count,
		.function = e->relay->start.function.algorithm->name, .kernel = "kernel", .bounds = "", .what = SHARE_NOTHING,
		.words = e->kernels.start_words};

	put_apart(e, &starts, out);
}

static void put_function_of(const struct emission *e, const struct function *p, struct text *out)
{
	if (p->segments.count)
		emit_segments_kernel(e, p, out);
	else
		put_kernel(e, p, out);
}

void emit_kernels(const struct emission *e, struct text *out)
{
	emit_transpose_samples(e, out);
	emit_zeros(e, out);
	text_put(out, emit_has_limbs(e) ? EMIT_UNLESS_LIMBS : "");
	emit_parts_small(e, 0, out);
	emit_alone(e, out);
	emit_part_asks(e, out);
	if (e->relay && e->relay->start_count)
		put_starts(e, out);
	else if (e->relay)
		put_function_of(e, &e->relay->start.function, out);
	if (e->relay)
		emit_relay_solve(e, out);
	for (int i = 0; i < e->function_count && e->target->kernel; i++)
		if (i == 0 && emit_is_apart(e))
			put_both(e, out);
		else if (i == 0 && !e->functions[i].segments.count && emit_windows(e)->slots)
			emit_windowed(e, &e->functions[i], out);
		else
			put_function_of(e, &e->functions[i], out);
	emit_transpose(e, out);
	text_put(out, e->kernels.alone_least ? "#endif\n" : "");
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

	return e->target->kernel && has_matrix && (e->options->layout == RNEAGEN_SOA || e->is_transposed) && !e->kernels.is_staged;
}

int emit_stores_to_tiles(const struct emission *e)
{
	return e->kernels.has_tiles && !e->kernels.has_columns;
}

const char *emit_store(const struct emission *e)
{
	const struct scalar *s = e->memory;
	const struct slot slots[] = {{"T", s->type}, {"SUFFIX", s->name}, {"CONSTRAINT", s->letter}};
	struct text t;

	text_init(&t, e->arena);
	if (emit_is_streamed(e))
		template_expand(&t, emit_stores_to_tiles(e) ? e->target->kernel->store_tiles : e->target->kernel->store, slots,
			sizeof slots / sizeof *slots);
	if (e->target->kernel && emit_windows(e)->slots)
		emit_put_windows(e, &t);
	return text_string(&t);
}

/* Whole samples, and some rows of each: of one of several parts, and of what is divided. */
static void put_stage_aos(const struct emission *e, const struct slot *slots, size_t count, struct text *out)
{
	const struct kernel_frames *f = e->target->kernel;
	int has_whole = emit_moves_whole(e);

	if (has_whole)
		template_expand(out, f->stage_bulk, slots, count);
	template_expand(out, f->stage_come, slots, count);
	if (has_whole)
		template_expand(out, f->stage_aos, slots, count);
	if (emit_moves_some(e))
		template_expand(out, f->stage_rows_aos, slots, count);
	if (emit_is_joined(e))
		template_expand(out, emit_each_block(e) ? f->stage_join_threads : f->stage_join, slots, count);
}

static void put_stage_start(const struct emission *e, struct text *out)
{
	const struct slot slots[] = {{"BYTES", emit_int(e, e->kernels.start_words * e->memory->bytes)},
		{"COPY", e->target->kernel->stage_copy}};

	template_expand(out, e->target->kernel->stage_start, slots, sizeof slots / sizeof *slots);
}

const char *emit_stage(const struct emission *e)
{
	const struct kernel_frames *f = e->target->kernel;
	const struct slot slots[] = {{"NAME", e->options->name}, {"FUNCTION", emit_main(e)->algorithm->name}, {"T", e->memory->type},
		{"BYTES", emit_int(e, e->kernels.slice_bytes)}, {"COPY", f ? f->stage_copy : ""}};
	struct text t;

	text_init(&t, e->arena);
	if (f && e->kernels.is_prefetched)
		template_expand(&t, f->prefetch, slots, sizeof slots / sizeof *slots);
	if (f && e->kernels.is_staged)
		template_expand(&t, f->stage, slots, sizeof slots / sizeof *slots);
	if (f && e->kernels.start_words)
		put_stage_start(e, &t);
	if (f && e->kernels.is_staged && e->options->layout == RNEAGEN_AOS)
		put_stage_aos(e, slots, sizeof slots / sizeof *slots, &t);
	return text_string(&t);
}

/* As many threads in blocks of any size; in blocks of a warp there may be no room for so many, and registers for all. */
const char *emit_min_blocks(const struct emission *e)
{
	return e->kernels.blocks
		? text_format(e->arena, "(RNEA_BLOCK < 64 ? 0 : %d/RNEA_BLOCK)", e->kernels.blocks * e->kernels.block) : "0";
}

const char *emit_stage_launch(const struct emission *e)
{
	return e->target->kernel && e->kernels.is_staged ? e->target->kernel->stage_launch : "";
}

const char *emit_given(const struct emission *e, const char *kernel)
{
	if (!e->kernels.is_staged)
		return "0";
	return text_format(e->arena, "rneagen_given_bytes((const void *)%s_%s_%s)", e->options->name, emit_main(e)->algorithm->name,
		kernel);
}

int emit_stage_bytes(const struct emission *e)
{
	return e->target->kernel && e->kernels.is_staged ? e->kernels.slice_bytes : 0;
}
