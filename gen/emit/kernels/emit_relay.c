/* A relay's first and third kernel, what launches all, and the same calls one after the other, where the text is compiled
   as C. */
#include "base/template.h"
#include "emit/emit.h"
#include "emit/kernels/emit_limbs.h"
#include "emit/kernels/emit_parts.h"
#include "emit/kernels/emit_relay.h"
#include "emit/kernels/emit_transpose.h"
#include "plan/stage.h"
#include <stdlib.h>

static const struct function *start_of(const struct emission *e)
{
	return &e->relay->start.function;
}

static const struct function *solve_of(const struct emission *e)
{
	return &e->relay->solve.function;
}

/* Of what a column's limb leaves for the loop of all columns; 0: there is none. */
static int reduced_rows(const struct emission *e)
{
	return dag_reduced_rows(&solve_of(e)->dag);
}

static int slots_of(const struct function *p)
{
	return p->segments.slots[0] ? p->segments.slots[0] : 1;
}

int emit_is_start(const struct emission *e, const struct function *p)
{
	if (e->rounds && p == &e->rounds[FOUND_START].function)
		return 1;
	if (!e->relay)
		return 0;
	for (int i = 0; i < e->relay->start_count; i++)
		if (p == &e->relay->starts[i].function)
			return 1;
	return p == start_of(e);
}

int emit_relay_bytes(const struct emission *e)
{
	return relay_bytes(e->relay, e->options);
}

/* ---- compiled as C ---- */

/* Those that are no loops. */
static void put_segment_calls(const struct emission *e, const struct function *p, struct text *out)
{
	text_printf(out, "\t\t%s across[%d];\n\n", e->numbers->value, slots_of(p));
	for (int k = 0; k < p->segments.count - p->dag.loop_count; k++) {
		text_put(out, "\t\t");
		emit_put_sample_call(e, p, text_format(e->arena, "segment%d", k), ", across, 1, 1", out);
		text_putc(out, '\n');
	}
}

void emit_relay_before(const struct emission *e, struct text *out)
{
	if (!e->relay)
		return;
	for (int i = 0; i < e->relay->start_count; i++) {
		const struct function *p = &e->relay->starts[i].function;

		text_put(out, "\t");
		emit_put_sample_call(e, p, "body", emit_more(e, p, 0, "stride", ""), out);
		text_putc(out, '\n');
	}
	if (e->relay->start_count)
		return;
	text_put(out, "\t");
	if (!start_of(e)->segments.count) {
		emit_put_sample_call(e, start_of(e), "body", "", out);
		text_putc(out, '\n');
		return;
	}
	text_put(out, "{\n");
	put_segment_calls(e, start_of(e), out);
	text_put(out, "\t}\n");
}

/* `NAME_FUNCTION_loop2(column, stride, across, 1, 1, reduced);` */
static void put_loop_call(const struct emission *e, int loop, const char *arguments, struct text *out)
{
	text_printf(out, "%s_%s_loop%d(%s%s);\n", e->options->name, solve_of(e)->algorithm->name, loop, arguments,
		reduced_rows(e) ? ", reduced" : "");
}

/* Around the call of a limb's loop: what it leaves, and the loop that takes it. */
static void put_reduced(const struct emission *e, struct text *out)
{
	text_printf(out, "\t\t\t%s reduced[%d] = {0};\n\n", e->memory->type, reduced_rows(e));
}

static void put_expanding_call(const struct emission *e, const char *arguments, struct text *out)
{
	text_put(out, "\t\t\t");
	put_loop_call(e, solve_of(e)->dag.loop_count - 1, arguments, out);
}

/* The body of a loop over these columns, with its braces where it has some. */
static void put_column(const struct emission *e, const struct column_run *r, struct text *out)
{
	int is_halved = reduced_rows(e) > 0;
	const char *arguments = text_format(e->arena, "%s + j*stride, stride, across, 1, 1",
		solve_of(e)->dag.arguments[r->argument].name);

	text_put(out, is_halved ? " {\n" : "\n");
	if (is_halved)
		put_reduced(e, out);
	text_put(out, "\t\t\t");
	put_loop_call(e, r->loop, arguments, out);
	if (is_halved) {
		put_expanding_call(e, arguments, out);
		text_put(out, "\t\t}\n");
	}
}

void emit_relay_after(const struct emission *e, struct text *out)
{
	const struct dag *d = e->relay ? &solve_of(e)->dag : NULL;

	if (!d)
		return;
	text_put(out, "\n\t{\n");
	put_segment_calls(e, solve_of(e), out);
	for (const struct column_run *r = d->runs; r < d->runs + d->run_count; r++) {
		text_printf(out, "\t\tfor (size_t j = %d; j < %d; j++)", r->first, r->first + r->count);
		put_column(e, r, out);
	}
	text_put(out, "\t}");
}

/* ---- kernels ---- */

/* `j < 3 ? dqdd_dq + (size_t)(j + 2)*count : dqdd_dqd + ...`: of these runs, whose columns are numbered from `first` on. */
static const char *column_text(const struct emission *e, const struct column_run *r, const struct column_run *end, int first)
{
	struct text t;

	text_init(&t, e->arena);
	for (; r < end; first += r++->count) {
		if (r + 1 < end)
			text_printf(&t, "j < %d ? ", first + r->count);
		text_printf(&t, "%s + (size_t)", solve_of(e)->dag.arguments[r->argument].name);
		if (r->first == first)
			text_put(&t, "j*count");
		else
			text_printf(&t, "(j %c %d)*count", r->first < first ? '-' : '+', abs(r->first - first));
		text_put(&t, r + 1 < end ? " : " : "");
	}
	return text_string(&t);
}

/* The run behind a loop's last one; and *next, from the number of the loop's first column, that of the first one behind it. */
static const struct column_run *end_of(const struct dag *d, const struct column_run *r, int *next)
{
	const struct column_run *end = r;

	while (end < d->runs + d->run_count && end->loop == r->loop)
		*next += end++->count;
	return end;
}

static const char KERNEL_ARGUMENTS[] = "column + k, count, across, RNEA_SOLVE_SAMPLES, 1";

/* `if (j < 3) ... else if (j < 15) ... else ...`, and the loop of all. */
static const char *halves_text(const struct emission *e)
{
	const struct dag *d = &solve_of(e)->dag;
	const struct column_run *end;
	struct text t;
	int next = 0;

	text_init(&t, e->arena);
	put_reduced(e, &t);
	for (const struct column_run *r = d->runs; r < d->runs + d->run_count; r = end) {
		text_put(&t, next ? "\t\t\telse" : "\t\t\t");
		end = end_of(d, r, &next);
		if (end < d->runs + d->run_count)
			text_printf(&t, "%sif (j < %d)", r == d->runs ? "" : " ", next);
		text_put(&t, "\n\t\t\t\t");
		put_loop_call(e, r->loop, KERNEL_ARGUMENTS, &t);
	}
	put_expanding_call(e, KERNEL_ARGUMENTS, &t);
	return text_string(&t);
}

static const char *loop_text(const struct emission *e, int loop)
{
	struct text t;

	text_init(&t, e->arena);
	text_put(&t, "\n\t\t\t");
	put_loop_call(e, loop, KERNEL_ARGUMENTS, &t);
	return text_string(&t);
}

/* Of these runs, whose columns are numbered from `first` on, to the one before `next`. */
static void put_loop(const struct emission *e, const struct column_run *r, const struct column_run *end, int first, int next,
	const char *body, struct text *out)
{
	const struct slot slots[] = {{"T", e->memory->type}, {"FIRST", emit_int(e, first)}, {"END", emit_int(e, next)},
		{"COLUMN", column_text(e, r, end, first)}, {"BODY", body}};

	template_expand(out, template_kernel_columns_in, slots, sizeof slots / sizeof *slots);
}

/* Columns are numbered in the order of the runs, and a loop's runs stand together. Each loop is written once: its text is
   long. */
static const char *loops_text(const struct emission *e)
{
	const struct dag *d = &solve_of(e)->dag;
	const struct column_run *end = d->runs + d->run_count;
	struct text t;
	int first = 0, next = 0;

	text_init(&t, e->arena);
	if (reduced_rows(e)) {
		put_loop(e, d->runs, end, 0, relay_columns(e->relay), halves_text(e), &t);
		return text_string(&t);
	}
	for (const struct column_run *r = d->runs; r < d->runs + d->run_count; r = end, first = next) {
		end = end_of(d, r, &next);
		put_loop(e, r, end, first, next, loop_text(e, r->loop), &t);
	}
	return text_string(&t);
}

static const char *solve_call(const struct emission *e)
{
	const char *arguments = text_format(e->arena, "%s, across, RNEA_SOLVE_SAMPLES",
		emit_params(e, solve_of(e), PARAMS_AT_SAMPLE));
	const struct call c = {.indent = "\t\t", .arguments = arguments, .q = emit_q_at_sample(e),
		.stride = emit_stride(e), .q_stride = emit_q_stride(e)};

	return emit_call(e, solve_of(e), &c);
}

void emit_relay_solve(const struct emission *e, struct text *out)
{
	const struct function *p = solve_of(e);
	const struct slot slots[] = {{"NAME", e->options->name}, {"FUNCTION", p->algorithm->name}, {"T", e->numbers->value},
		{"RESULT", emit_has_known(e) ? "int" : "void"}, {"RETURN", emit_has_known(e) ? "return " : ""},
		{"PARAMS", emit_params(e, p, PARAMS_PLAIN)}, {"NAMES", emit_params(e, p, PARAMS_NAMES)},
		{"KNOWN_PARAM", emit_known_params(e)}, {"KNOWN", emit_handed_on(e, emit_known_names(e))},
		{"THREADS", emit_int(e, e->relay->threads)}, {"SAMPLES", emit_int(e, e->relay->samples)},
		{"BYTES", emit_int(e, emit_relay_bytes(e))}, {"BLOCKS", emit_int(e, e->relay->blocks)},
		{"RESTRICT_PARAMS", emit_params(e, p, PARAMS_CUDA_RESTRICT)}, {"TRANSPOSE", emit_transpose_begin(e)}, {"CALL", solve_call(e)},
		{"LOOPS", loops_text(e)}};

	template_expand(out, template_kernel_solve_in, slots, sizeof slots / sizeof *slots);
}

/* How the function begins that launches all three. */
static const char *last_head(const struct emission *e)
{
	const char *others = emit_launch_others(e);

	return others ? others : text_format(e->arena,
		"/* Run the kernels on device pointers in the caller's stream (a cudaStream_t), each when the one before it is done:\n"
		"   accelerations, what their gradients are solved from, and these. Returns the cudaError_t. */\n"
		"extern \"C\" int %s_%s_launch", e->options->name, emit_main(e)->algorithm->name);
}

const char *emit_launch_relay(const struct emission *e)
{
	const struct function *p = emit_main(e);

	if (!e->relay)
		return "";
	const struct slot slots[] = {{"NAME", e->options->name}, {"FUNCTION", p->algorithm->name},
		{"PARAMS", emit_params(e, p, PARAMS_PLAIN)}, {"NAMES", emit_params(e, p, PARAMS_NAMES)},
		{"ADDRESSES", emit_params(e, p, PARAMS_ADDRESSES)},
		{"SHARED_BYTES", emit_int(e, SHARED_BYTES)}, {"ROOM", emit_int(e, e->relay->room)},
		{"HEAD", last_head(e)}, {"LAUNCH_LIMBS", emit_launch_start_limbs(e)}, {"START_PARTS", emit_along(e, e->relay->start_count)}};

	return template_text(e->arena, template_launch_relay_in, slots, sizeof slots / sizeof *slots);
}

const char *emit_launch_head(const struct emission *e)
{
	const char *function = emit_main(e)->algorithm->name;
	struct text t;

	text_init(&t, e->arena);
	if (e->relay)
		text_printf(&t, "/* The second kernel. */\nstatic int %s_%s_launch_columns", e->options->name, function);
	else if (e->is_transposed)
		text_put(&t, emit_launch_others(e));
	else
		text_printf(&t, "/* Run the kernel on device pointers in the caller's stream (a cudaStream_t); returns the cudaError_t. */\n"
			"extern \"C\" int %s_%s_launch", e->options->name, function);
	return text_string(&t);
}
