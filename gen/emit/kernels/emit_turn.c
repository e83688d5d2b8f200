/* Kernels that write outputs as in soa, some samples at a time, and the kernel that turns these to [sample][row]. */
#include "emit/kernels/emit_turn.h"
#include "base/template.h"
#include "plan/stage.h"
#include "plan/turned.h"

static int bytes_of(const struct emission *e)
{
	return turned_bytes(emit_arguments(e), e->options);
}

int emit_turned_samples(const struct emission *e)
{
	return turned_samples(emit_arguments(e), e->options);
}

void emit_turn_samples(const struct emission *e, struct text *out)
{
	if (e->is_turned)
		text_printf(out, "#define RNEA_TURN %d /* samples whose outputs are turned at a time */\n\n", emit_turned_samples(e));
}

/* `array + k` is then the sample's first row, and `count` the way to the next one. */
const char *emit_turn_begin(const struct emission *e)
{
	const struct dag *d = emit_arguments(e);
	struct text t;

	text_init(&t, e->arena);
	if (!e->is_turned)
		return text_string(&t);
	text_put(&t, "\tconst size_t group = k - k%RNEA_TURN;\n\n"
		"\t/* outputs stand as [row][sample], RNEA_TURN samples at a time, until they are turned */\n"
		"\tcount = count - group < RNEA_TURN ? count - group : RNEA_TURN;\n");
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

/* One for each output. */
static const char *cases_text(const struct emission *e)
{
	const struct dag *d = emit_arguments(e);
	struct text t;
	int number = 0;

	text_init(&t, e->arena);
	for (int i = 0; i < d->argument_count; i++) {
		const struct argument *a = &d->arguments[i];
		int zeros = a->is_output ? emit_late_zeros(e, i) : 0;

		if (a->is_output)
			text_printf(&t, "\tcase %d:\n\t\trneagen_turn<%d, %d>(%s + first*%d, samples, slices, %s);\n\t\tbreak;\n", number++,
				a->rows, zeros, a->name, a->rows, zeros ? text_format(e->arena, "%s_%s_zeros", e->options->name, a->name) : "0");
	}
	return text_string(&t);
}

void emit_turn(const struct emission *e, struct text *out)
{
	if (!e->is_turned)
		return;
	const struct slot slots[] = {{"NAME", e->options->name}, {"FUNCTION", emit_main(e)->algorithm->name}, {"T", e->memory->type},
		{"THREADS", emit_int(e, TURNED_THREADS)}, {"BYTES", emit_int(e, bytes_of(e))},
		{"RESTRICT_PARAMS", emit_params(e, emit_main(e), PARAMS_CUDA_RESTRICT)}, {"CASES", cases_text(e)}};

	template_expand(out, template_turn_in, slots, sizeof slots / sizeof *slots);
}

const char *emit_launch_turn(const struct emission *e)
{
	const struct function *p = emit_main(e);

	if (!e->is_turned)
		return "";
	const struct slot slots[] = {{"NAME", e->options->name}, {"FUNCTION", p->algorithm->name},
		{"PARAMS", emit_params(e, p, PARAMS_PLAIN)}, {"NAMES", emit_params(e, p, PARAMS_NAMES)},
		{"ADDRESSES", emit_params(e, p, PARAMS_ADDRESSES)}, {"SHARED_BYTES", emit_int(e, SHARED_BYTES)},
		{"OUTPUTS", emit_int(e, outputs_of(e))}};

	return template_text(e->arena, template_turn_launch_in, slots, sizeof slots / sizeof *slots);
}

const char *emit_launch_unturned(const struct emission *e)
{
	if (!e->is_turned)
		return NULL;
	return text_format(e->arena, "/* All kernels but the last. */\nstatic int %s_%s_launch_unturned", e->options->name,
		emit_main(e)->algorithm->name);
}

void emit_info_turn(const struct emission *e, struct text *out)
{
	if (e->is_turned)
		text_printf(out, "turn %d %d %d\n", emit_turned_samples(e), TURNED_THREADS, bytes_of(e));
}
