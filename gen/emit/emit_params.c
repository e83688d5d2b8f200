/* The arguments of the generated functions, in every form in which a text lists them; the names of choices. */
#include "base/number.h"
#include "emit/emit.h"
#include <string.h>

const char *emit_trig_name(enum rneagen_trig trig)
{
	static const char *const names[] = {"accurate", "bounded", "fast"};

	return names[trig];
}

const char *emit_only_name(int only)
{
#define ONLY_NAME(upper, word) [RNEAGEN_ONLY_##upper] = word,
	static const char *const names[] = {RNEAGEN_ONLY_WORDS(ONLY_NAME)};
#undef ONLY_NAME

	return names[only];
}

enum rneagen_trig emit_trig_of(const struct rneagen_options *o)
{
	int has_unit = number_type_of(emit_precision_of(o))->frames->fast && target_type_of(o->target)->has_unit;

	if (o->trig == RNEAGEN_TRIG_AUTO)
		return RNEAGEN_ACCURATE;
	return o->trig == RNEAGEN_FAST && !has_unit ? RNEAGEN_BOUNDED : o->trig;
}

const char *emit_layout_name(enum rneagen_layout layout)
{
	return layout == RNEAGEN_SOA ? "soa" : "aos";
}

void emit_options(const struct rneagen_options *o, struct text *out)
{
	text_printf(out, " --target %s --precision %s --layout %s --trig %s", emit_target_name(o->target),
		emit_precision_name(o->precision), emit_layout_name(o->layout), emit_trig_name(o->trig));
	if (o->base == RNEAGEN_FLOATING)
		text_put(out, " --base floating");
	if (o->strict)
		text_put(out, " --strict");
	if (o->bounded)
		text_put(out, o->bounded == RNEAGEN_BOUNDS_RUNNING ? " --bounded=running" : " --bounded");
	if (o->only)
		text_printf(out, " --only %s", emit_only_name(o->only));
	if (o->parts != RNEAGEN_PARTS_AUTO)
		text_printf(out, " --parts %d", o->parts);
	if (o->segments == RNEAGEN_SEGMENTS_WHOLE)
		text_put(out, " --segments whole");
	else if (o->segments != RNEAGEN_SEGMENTS_AUTO)
		text_printf(out, " --segments %d", o->segments);
	if (o->limbs == RNEAGEN_LIMBS_NONE)
		text_put(out, " --limbs none");
	else if (o->limbs != RNEAGEN_LIMBS_AUTO)
		text_printf(out, " --limbs %d", o->limbs);
	if (o->mimic == RNEAGEN_MIMIC_INDEPENDENT)
		text_put(out, " --mimic independent");
	if (o->gravity[0] != 0 || o->gravity[1] != 0 || o->gravity[2] != -9.81)
		for (int i = 0; i < 3; i++)
			text_printf(out, "%s%s", i ? "," : " --gravity ", number_plain(o->gravity[i]).s);
}

const char *emit_count_param(enum rneagen_layout layout)
{
	return layout == RNEAGEN_SOA ? "size_t count, " : "";
}

const char *emit_stride(const struct emission *e)
{
	return e->options->layout == RNEAGEN_SOA ? "count" : "1";
}

const char *emit_q_stride(const struct emission *e)
{
	return e->is_transposed ? "1" : emit_stride(e);
}

static void put_at_sample(const struct emission *e, const struct argument *a, enum rneagen_layout layout, struct text *out)
{
	if (a->per_batch)
		text_put(out, a->name);
	else if (layout == RNEAGEN_SOA && !(e->is_transposed && !a->is_output))
		text_printf(out, "%s + k", a->name);
	else
		text_printf(out, "%s + k*%d", a->name, a->rows);
}

void emit_put_at_sample(const struct emission *e, const struct argument *a, struct text *out)
{
	put_at_sample(e, a, e->options->layout, out);
}

static void put_declaration(const struct emission *e, const struct argument *a, enum params kind, struct text *out)
{
	const char *qualifier = kind == PARAMS_FIRST && !a->per_batch ? "first_" : kind == PARAMS_RESTRICT ? "restrict "
		: kind == PARAMS_CUDA_RESTRICT ? "__restrict__ " : "";

	if (kind == PARAMS_SIZED)
		text_printf(out, "%s%s %s[%d]", a->is_output ? "" : "const ", e->memory->type, a->name, a->rows);
	else
		text_printf(out, "%s%s *%s%s", a->is_output ? "" : "const ", e->memory->type, qualifier, a->name);
}

static void put_argument(const struct emission *e, const struct function *p, int i, enum params kind, struct text *out)
{
	const struct argument *a = &p->dag.arguments[i];

	switch (kind) {
	case PARAMS_NAMES:
		text_put(out, a->name);
		break;
	case PARAMS_ADDRESSES:
		text_printf(out, "&%s", a->name);
		break;
	case PARAMS_ARRAYS:
		text_printf(out, "arrays[%d]", i);
		break;
	case PARAMS_AT_SAMPLE:
		emit_put_at_sample(e, a, out);
		break;
	default:
		put_declaration(e, a, kind, out);
	}
}

const char *emit_params(const struct emission *e, const struct function *p, enum params kind)
{
	struct text t;

	text_init(&t, e->arena);
	for (int i = 0; i < p->dag.argument_count; i++) {
		text_put(&t, i ? ", " : "");
		put_argument(e, p, i, kind, &t);
	}
	return text_string(&t);
}

const char *emit_q_at_sample(const struct emission *e)
{
	struct text t;

	text_init(&t, e->arena);
	put_argument(e, emit_main(e), 0, PARAMS_AT_SAMPLE, &t);
	return text_string(&t);
}

const char *emit_at_sample(const struct emission *e, const struct function *p, enum rneagen_layout layout)
{
	struct text t;

	text_init(&t, e->arena);
	for (const struct argument *a = p->dag.arguments; a < p->dag.arguments + p->dag.argument_count; a++) {
		put_at_sample(e, a, layout, &t);
		text_put(&t, ", ");
	}
	text_put(&t, layout == RNEAGEN_SOA ? "count" : "1");
	return text_string(&t);
}

/* ---- parameters that statements do not read ---- */

/* Is a row of a batch read or written with the stride: one that is not the first? Beside outputs that are transposed no input
   is. */
static int has_stride(const struct plan *p, const struct line *l, int is_transposed)
{
	const struct node *n = &p->dag->nodes[l->value.i];

	if (l->kind == LINE_STORE)
		return p->dag->outputs[l->index].row > 0 && !p->dag->arguments[p->dag->outputs[l->index].argument].per_batch;
	if (l->kind != LINE_INPUT || n->arg[1].i == 0 || p->dag->arguments[n->arg[0].i].per_batch)
		return 0;
	return !is_transposed || p->dag->arguments[n->arg[0].i].is_output;
}

int emit_mark_arguments(const struct emission *e, const struct plan *p, unsigned char *used)
{
	const struct dag *d = p->dag;
	int stride = 0;

	for (const struct line *l = p->lines; l < p->lines + p->line_count; l++) {
		if (l->kind == LINE_STORE)
			used[d->outputs[l->index].argument] = 1;
		else if (l->kind == LINE_INPUT)
			used[d->nodes[l->value.i].arg[0].i] = 1;
		stride |= has_stride(p, l, e->is_transposed);
	}
	return stride;
}

/* Of sines and of whether they are known. */
static void put_unused_sines(const struct emission *e, const struct plan *p, struct text *out)
{
	int narrow = 0, wide = 0;

	for (size_t i = 0; i < p->line_count; i++)
		if (p->lines[i].kind == LINE_SINCOS && p->dag->nodes[p->lines[i].value.i].is_wide)
			wide = 1;
		else if (p->lines[i].kind == LINE_SINCOS)
			narrow = 1;
	text_put(out, narrow || wide ? "" : "\t(void)known;\n");
	text_put(out, narrow ? "" : "\t(void)sines;\n");
	text_put(out, wide || !e->wide ? "" : "\t(void)sines_wide;\n");
}

void emit_unused(const struct emission *e, const struct plan *p, const char *prefix, struct text *out)
{
	unsigned char used[DAG_EVERY] = {0};
	int stride = emit_mark_arguments(e, p, used);

	for (int i = 0; i < p->dag->argument_count; i++)
		if (!used[i])
			text_printf(out, "\t(void)%s%s;\n", p->dag->arguments[i].per_batch ? "" : prefix,
				p->dag->arguments[i].name);
	text_put(out, stride ? "" : "\t(void)stride;\n");
	if (emit_has_known(e))
		put_unused_sines(e, p, out);
}
