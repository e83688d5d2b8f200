/* Angles and their sines in accurate mode: the arguments and tables by which a body is told the sines of large angles, the
   functions that make them, and the calls. */
#include "base/template.h"
#include "emit/emit.h"
#include "emit/kernels/emit_parts.h"
#include "emit/unparse.h"
#include "plan/tiles/tiles.h"

int emit_has_known(const struct emission *e)
{
	const struct request *k = e->request;

	if (e->options->trig != RNEAGEN_ACCURATE || emit_main(e)->dag.arguments[0].role != ROLE_JOINT_POSITION)
		return 0;
	for (int i = 0; i < k->freed_count; i++)
		if (k->freed[i].kind == FREED_OFFSET)
			return 0;
	return 1;
}

/* Parts, kernels of a relay, and what batches or a call of one sample run, have the table of the whole. */
static const struct function *table_of(const struct emission *e, const struct function *p)
{
	if (p == emit_main(e)->many || p == emit_main(e)->single || p == emit_main(e)->beside || emit_is_relays(e, p))
		return emit_main(e);
	for (int i = 0; i < e->part_count; i++)
		if (p == &e->parts[i].function || p == e->parts[i].function.each)
			return emit_main(e);
	return p;
}

struct angles emit_angles(const struct emission *e, const struct function *p, int is_wide)
{
	return angles_of(&table_of(e, p)->plan, is_wide, e->arena);
}

/* ---- arguments ---- */

static const char *joined(const struct emission *e, const char *first, const char *format, const char *wide)
{
	struct text t;

	text_init(&t, e->arena);
	text_put(&t, first);
	if (e->wide)
		text_printf(&t, format, wide);
	return text_string(&t);
}

const char *emit_known_params(const struct emission *e)
{
	if (!emit_has_known(e))
		return "";
	return joined(e, text_format(e->arena, ", const int known, const %s *sines", e->numbers->value), ", const %s *sines_wide",
		e->wide ? e->wide->value : "");
}

const char *emit_known_names(const struct emission *e)
{
	return joined(e, "known, sines", ", sines%s", "_wide");
}

const char *emit_unknown_names(const struct emission *e)
{
	return joined(e, "0, 0", ", %s", "0");
}

const char *emit_handed_on(const struct emission *e, const char *names)
{
	struct text t;

	text_init(&t, e->arena);
	if (emit_has_known(e))
		text_printf(&t, ", %s", names);
	return text_string(&t);
}

/* A function may have angles of one type of numbers alone. */
static const char *tables_text(const struct emission *e, const struct function *p, const char *known, const char *name)
{
	struct text t;

	text_init(&t, e->arena);
	text_printf(&t, "%s%s", known, emit_angles(e, p, 0).count ? name : "0");
	if (e->wide && emit_angles(e, p, 1).count)
		text_printf(&t, ", %s_wide", name);
	else if (e->wide)
		text_put(&t, ", 0");
	return text_string(&t);
}

static void put_table(const struct number_type *n, const char *name, int angles, const char *indent, struct text *out)
{
	if (angles)
		text_printf(out, "%s%s%s %s[%d];", out->length ? "\n" : "", out->length ? indent : "", n->value,
			name, 2 * angles);
}

/* ---- tables that nobody reads: an offset of NULL would be undefined ---- */

static int most_angles(const struct emission *e, int is_wide)
{
	int most = 0;

	for (int i = 0; i < e->function_count; i++) {
		int count = emit_angles(e, &e->functions[i], is_wide).count;

		most = count > most ? count : most;
	}
	return most;
}

const char *emit_unread_names(const struct emission *e, const struct function *p)
{
	return tables_text(e, p, "0, ", text_format(e->arena, "%s_unread", e->options->name));
}

static void put_unread(const struct emission *e, const struct number_type *n, const char *wide, struct text *out)
{
	int angles = most_angles(e, *wide != 0);

	if (angles)
		text_printf(out, "%sstatic const %s %s_unread%s[%d] = {0};\n",
			out->length ? "" : "/* in the place of sines where all angles are small: nobody reads it */\n",
			n->value, e->options->name, wide, 2 * angles);
}

const char *emit_unread_tables(const struct emission *e)
{
	struct text t;

	text_init(&t, e->arena);
	put_unread(e, e->numbers, "", &t);
	if (e->wide)
		put_unread(e, e->wide, "_wide", &t);
	return text_string(&t);
}

/* ---- calls ---- */

/* Their declarations: two numbers for each angle. */
static const char *declarations_text(const struct emission *e, const struct function *p, const char *indent)
{
	struct text t;

	text_init(&t, e->arena);
	put_table(e->numbers, "sines", emit_angles(e, p, 0).count, indent, &t);
	if (e->wide)
		put_table(e->wide, "sines_wide", emit_angles(e, p, 1).count, indent, &t);
	return text_string(&t);
}

int emit_has_angles(const struct emission *e, const struct function *p)
{
	return plan_sincos(&table_of(e, p)->plan) > 0;
}

/* Of a type: the angle, its sine and cosine. */
static int bytes_of(const struct emission *e, const struct number_type *n)
{
	return n ? 3 * n->arithmetic->bytes * emit_angles(e, emit_main(e), n == e->wide).count : 0;
}

const char *emit_sines_bytes(const struct emission *e)
{
	const struct slot slots[] = {{"BYTES", emit_int(e, (bytes_of(e, e->numbers) + bytes_of(e, e->wide) + 15) / 16 * 16)}};

	return emit_has_known(e) && emit_has_angles(e, emit_main(e))
		? template_text(e->arena, template_sines_bytes_in, slots, sizeof slots / sizeof *slots) : "";
}

/* ---- expressions ---- */

/* Each input by a name, NULL: by its load; nothing else has one. */
static const char **names_of_inputs(const struct unparser *u, const char *name)
{
	const struct dag *d = u->plan->dag;
	const char **names = arena_alloc(u->emission->arena, d->count, sizeof *names);

	for (size_t i = 0; names && i < d->count; i++) {
		struct text t;

		if (d->nodes[i].op != OP_INPUT)
			continue;
		text_init(&t, u->emission->arena);
		unparse_load(u, &d->nodes[i], &t);
		names[i] = name ? name : text_string(&t);
	}
	return names;
}

void unparse_angles(const struct emission *e, const struct function *function, const struct number_type *numbers,
	const struct angles *list, const char *suffix, struct text *out)
{
	struct unparser u = unparse_new(e, function, e->numbers), wide = unparse_new(e, function, e->wide ? e->wide : e->numbers);
	struct plan plan = function->plan;

	plan.names = names_of_inputs(&u, NULL);
	if (!plan.names)
		return;
	u.plan = wide.plan = &plan;
	u.narrow = wide.narrow = &u;
	u.wide = wide.wide = e->wide ? &wide : NULL;
	for (int i = 0; i < list->count; i++) {
		text_printf(out, "\tx%s[%d] = ", suffix, i);
		unparse_angle(numbers == e->wide ? &wide : &u, list->angle[i], out);
		text_put(out, ";\n");
	}
}

void unparse_angle_of(const struct emission *e, const struct function *p, struct ref angle, const char *input, struct text *out)
{
	struct unparser u = unparse_new(e, p, e->numbers);
	struct plan plan = p->plan;

	plan.names = names_of_inputs(&u, input);
	u.plan = &plan;
	u.narrow = &u;
	if (plan.names)
		unparse_angle(&u, angle, out);
}

/* ---- functions ---- */

static void put_each(const struct emission *e, const struct function *p, const struct number_type *n, const char *suffix,
	struct text *out)
{
	const struct angles list = emit_angles(e, p, n == e->wide);

	if (!list.count)
		return;
	text_printf(out, "\t%s x%s[%d];\n", n->angle_is_memory ? n->memory->type : n->value, suffix, list.count);
	unparse_angles(e, p, n, &list, suffix, out);
	text_printf(out, "\t%seach(x%s, %d, sines%s);\n", e->options->strict ? n->strict_sincos : n->sincos, suffix,
		list.count, suffix);
}

/* Is a row read with the stride: one that is not the first? */
static int has_stride(const struct dag *d, struct ref a)
{
	const struct node *n = &d->nodes[a.i];
	int found = n->op == OP_INPUT && n->arg[1].i > 0;

	for (int k = 0; !found && k < op_arity[n->op]; k++)
		found = has_stride(d, n->arg[k]);
	return found;
}

static int any_has_stride(const struct angles list)
{
	for (int i = 0; i < list.count; i++)
		if (has_stride(list.dag, list.angle[i]))
			return 1;
	return 0;
}

static const char *each_text(const struct emission *e, const struct function *p)
{
	struct text t;

	text_init(&t, e->arena);
	put_each(e, p, e->numbers, "", &t);
	if (e->wide)
		put_each(e, p, e->wide, "_wide", &t);
	if (e->is_transposed || (!any_has_stride(emit_angles(e, p, 0)) && !(e->wide && any_has_stride(emit_angles(e, p, 1)))))
		text_put(&t, "\t(void)stride;\n");
	if (!emit_angles(e, p, 0).count)
		text_put(&t, "\t(void)sines;\n");
	if (e->wide && !emit_angles(e, p, 1).count)
		text_put(&t, "\t(void)sines_wide;\n");
	return text_string(&t);
}

const char *emit_sines(const struct emission *e)
{
	const char *params = text_format(e->arena, "%s *sines", e->numbers->value);
	struct text t;

	text_init(&t, e->arena);
	if (!emit_has_known(e))
		return "";
	const char *outputs = joined(e, params, ", %s *sines_wide", e->wide ? e->wide->value : "");
	for (const struct function *p = e->functions; p < e->functions + e->function_count; p++) {
		const struct slot slots[] = {{"NAME", e->options->name}, {"FUNCTION", p->algorithm->name}, {"T", e->memory->type},
			{"PARAMS", outputs}, {"EACH", each_text(e, p)}};

		if (emit_has_angles(e, p))
			template_expand(&t, template_sines_in, slots, sizeof slots / sizeof *slots);
	}
	return text_string(&t);
}

/* ---- calls ---- */

static const char *body_call(const struct emission *e, const struct function *p, const char *indent, const char *arguments,
	const char *stride, const char *more)
{
	return text_format(e->arena, "%s%s_%s_body(%s, %s%s);\n", indent, e->options->name, p->algorithm->name, arguments, stride,
		more);
}

/* And what a part is given beside it. */
static const char *stride_text(const struct emission *e, const struct function *p, const struct call *c)
{
	return text_format(e->arena, "%s%s", c->stride,
		emit_more(e, p, c->is_staged, c->is_tiled ? c->q_stride : c->stride, c->handed));
}

/* Where outputs take the places of angles that the other threads of a sample ask for. */
static const char *meet_text(const struct emission *e, const struct call *c)
{
	struct text t;

	text_init(&t, e->arena);
	if (c->has_threads && c->part->function.stretches->period)
		text_printf(&t, "\n%sif (RNEA_SAMPLE_THREADS > 1)\n%s\t__syncthreads(); /* outputs take the places of angles */", c->indent,
			c->indent);
	return text_string(&t);
}

static const char *call_expanded(const struct emission *e, const struct function *p, const char *frame, const char *asked,
	const struct call *c)
{
	int is_in_array = c->part || c->is_tiled;
	const char *stride = e->is_transposed && c->q_stride ? c->q_stride : c->stride;
	const struct slot slots[] = {{"NAME", e->options->name}, {"FUNCTION", p->algorithm->name}, {"INDENT", c->indent},
		{"Q", is_in_array ? emit_q_at_sample(e) : c->q}, {"Q_STRIDE", is_in_array ? emit_q_stride(e) : stride},
		{"TABLE", table_of(e, p)->algorithm->name},
		{"STRIDE", stride_text(e, p, c)}, {"ARGUMENTS", c->arguments}, {"SINES", declarations_text(e, p, c->indent)},
		{"ASKED", asked}, {"MEET", meet_text(e, c)}, {"UNKNOWN", emit_unknown_names(e)}, {"TABLES", tables_text(e, p, "", "sines")},
		{"KNOWN", tables_text(e, p, "known, ", "sines")}};

	return template_text(e->arena, frame, slots, sizeof slots / sizeof *slots);
}

const char *emit_call(const struct emission *e, const struct function *p, const struct call *c)
{
	struct text asked;
	int is_own = c->part || (emit_asks_by_parts(e) && emit_is_of_main(e, p));
	int has_gap = is_own && tiles_divide_q(p);

	if (!emit_has_known(e) || !emit_has_angles(e, p))
		return body_call(e, p, c->indent, c->arguments, stride_text(e, p, c), emit_handed_on(e, emit_unknown_names(e)));
	if (c->is_any)
		return call_expanded(e, p, template_call_any_in, "", c);
	if (c->is_optimistic)
		return call_expanded(e, p, e->target->kernel->again, "", c);
	text_init(&asked, e->arena);
	text_put(&asked, c->has_threads ? "sample < samples && " : "");
	text_printf(&asked, e->target->kernel ? "!%s%s%s_is_small(%s, %s%s%s)" : "RNEA_KNOWN(%s%s%s_is_small(%s, %s%s%s))",
		e->options->name, is_own ? "_" : "", is_own ? p->algorithm->name : "", c->q,
		c->q_stride ? c->q_stride : c->stride, has_gap ? ", " : "", has_gap ? emit_gap(e, p, c->is_staged) : "");
	return call_expanded(e, p, template_call_known_in, text_string(&asked), c);
}

const char *emit_call_any(const struct emission *e, const struct function *p)
{
	const struct call any = {.indent = "\t", .arguments = emit_params(e, p, PARAMS_NAMES), .q = "q",
		.stride = "stride", .is_any = 1};

	return emit_call(e, p, &any);
}

const char *emit_known_tables(const struct emission *e, const struct function *p)
{
	return tables_text(e, p, "known, ", "sines");
}

void emit_rounds(const struct emission *e, const struct function *p, const char *loops, struct text *out)
{
	const struct slot slots[] = {{"NAME", e->options->name}, {"TABLE", table_of(e, p)->algorithm->name},
		{"SINES", declarations_text(e, p, "\t\t")}, {"SEGMENTS", loops}, {"Q", emit_q_at_sample(e)},
		{"STRIDE", emit_stride(e)}, {"TABLES", tables_text(e, p, "", "sines")}};

	template_expand(out, template_kernel_segments_rounds_in, slots, sizeof slots / sizeof *slots);
}
