/* Kernels that write outputs as in soa, some samples at a time, and the kernel that transposes these to [sample][row]. */
#include "emit/kernels/emit_transpose.h"
#include "base/template.h"
#include "plan/stage.h"

struct transposed emit_transposed(const struct emission *e)
{
	return transposed_of(emit_arguments(e), emit_kept_rows(e), e->options);
}

void emit_transpose_samples(const struct emission *e, struct text *out)
{
	if (e->is_transposed)
		text_printf(out, "#define RNEA_TRANSPOSED %d /* samples whose outputs are transposed at a time */\n\n",
			emit_transposed(e).samples);
}

/* `array + k` is then the sample's first row, and `count` the way to the next one. */
const char *emit_transpose_begin(const struct emission *e)
{
	const struct dag *d = emit_arguments(e);
	struct text t;

	text_init(&t, e->arena);
	if (!e->is_transposed)
		return text_string(&t);
	text_put(&t, "\tconst size_t group = k - k%RNEA_TRANSPOSED;\n\n"
		"\t/* outputs stand as [row][sample], RNEA_TRANSPOSED samples at a time, until they are transposed */\n"
		"\tcount = count - group < RNEA_TRANSPOSED ? count - group : RNEA_TRANSPOSED;\n");
	for (int i = 0; i < d->argument_count; i++)
		if (d->arguments[i].is_output && d->arguments[i].rows > 1)
			text_printf(&t, "\t%s += group*%d;\n", d->arguments[i].name, d->arguments[i].rows - 1);
	return text_string(&t);
}

static int outputs_of(const struct emission *e)
{
	const struct dag *d = emit_arguments(e);
	int count = 0;

	for (int i = 0; i < d->argument_count; i++)
		count += d->arguments[i].is_output;
	return count;
}

/* Of an array with zeros, the runs of rows that are none. Returns how many. */
static int put_kept_runs(const struct emission *e, int argument, struct text *out)
{
	const unsigned char *zero = emit_zero_rows(e, argument);
	int rows = emit_arguments(e)->arguments[argument].rows, runs = 0, before = 0;

	for (int i = 0, end; i < rows && zero; i = end) {
		end = emit_run_end(zero, rows, i);
		if (zero[i])
			continue;
		text_printf(out, "%s{%d, %d, %d}", runs++ ? ", " : "", i, end - i, before);
		before += end - i;
	}
	return runs;
}

/* The table of these, and the case of the kernel that transposes the array. */
static void put_output(const struct emission *e, int argument, int kept, int number, struct text *tables, struct text *cases)
{
	const struct argument *a = &emit_arguments(e)->arguments[argument];
	int runs;
	const char *name = "0";
	struct text list;

	text_init(&list, e->arena);
	runs = kept < a->rows ? put_kept_runs(e, argument, &list) : 0;
	if (runs) {
		name = text_format(e->arena, "%s_%s_kept", e->options->name, a->name);
		text_printf(tables, "static __constant__ const unsigned %s[%d][3] = {%s};\n", name, runs, text_string(&list));
	}
	text_printf(cases, "\tcase %d:\n\t\trneagen_transpose<%d>(%s + first*%d, samples, slices, %d, %s, %d);\n\t\tbreak;\n", number,
		a->rows, a->name, a->rows, kept, name, runs);
}

void emit_transpose(const struct emission *e, struct text *out)
{
	if (!e->is_transposed)
		return;
	const struct dag *d = emit_arguments(e);
	const int *kept = emit_kept_rows(e);
	struct transposed t = transposed_of(d, kept, e->options);
	struct text tables, cases;
	int number = 0;

	text_init(&tables, e->arena);
	text_init(&cases, e->arena);
	for (int i = 0; i < d->argument_count; i++)
		if (d->arguments[i].is_output)
			put_output(e, i, kept ? kept[i] : d->arguments[i].rows, number++, &tables, &cases);
	const struct slot slots[] = {{"NAME", e->options->name}, {"FUNCTION", emit_main(e)->algorithm->name}, {"T", e->memory->type},
		{"THREADS", emit_int(e, t.threads)}, {"BYTES", emit_int(e, t.bytes)}, {"TABLES", text_string(&tables)},
		{"RESTRICT_PARAMS", emit_params(e, emit_main(e), PARAMS_CUDA_RESTRICT)}, {"CASES", text_string(&cases)}};

	template_expand(out, template_transpose_in, slots, sizeof slots / sizeof *slots);
}

const char *emit_launch_transpose(const struct emission *e)
{
	const struct function *p = emit_main(e);

	if (!e->is_transposed)
		return "";
	const struct slot slots[] = {{"NAME", e->options->name}, {"FUNCTION", p->algorithm->name},
		{"PARAMS", emit_params(e, p, PARAMS_PLAIN)}, {"NAMES", emit_params(e, p, PARAMS_NAMES)},
		{"ADDRESSES", emit_params(e, p, PARAMS_ADDRESSES)}, {"SHARED_BYTES", emit_int(e, SHARED_BYTES)},
		{"OUTPUTS", emit_int(e, outputs_of(e))}};

	return template_text(e->arena, template_transpose_launch_in, slots, sizeof slots / sizeof *slots);
}

const char *emit_launch_others(const struct emission *e)
{
	if (!e->is_transposed)
		return NULL;
	return text_format(e->arena, "/* All kernels but the last. */\nstatic int %s_%s_launch_others", e->options->name,
		emit_main(e)->algorithm->name);
}

void emit_info_transpose(const struct emission *e, struct text *out)
{
	struct transposed t;

	if (!e->is_transposed)
		return;
	t = emit_transposed(e);
	text_printf(out, "transpose %d %d %d\n", t.samples, t.threads, t.bytes);
}
