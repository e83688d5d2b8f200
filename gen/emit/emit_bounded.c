/* NAME_rnea_bounded, NAME_fd_bounded: torques, or what else is wanted, and, by a running error analysis beside them, how far each may be from
   what the URDF's decimals give. */
#include "emit/unparse.h"
#include "base/fold.h"
#include "base/template.h"

/* Roundings of a bound from an operation's operands to its result, three times u for the factor 1 + 3u included. */
static const int roundings[OP_COUNT] = {
	[OP_ADD] = 7, [OP_SUB] = 7, [OP_MUL] = 10, [OP_FMA] = 14, [OP_DIV] = 18, [OP_SQRT] = 12,
	[OP_SIN] = 12, [OP_COS] = 12};

/* The most roundings of a bound on any way from an input to an output; -1 when memory runs out. */
static int longest_way(const struct emission *e, const struct dag *d)
{
	int *way = arena_alloc(e->arena, d->count, sizeof *way), longest = 0;

	for (size_t i = 0; way && i < d->count; i++) {
		const struct node *n = &d->nodes[i];
		int most = 0;

		for (int k = 0; k < op_arity[n->op]; k++)
			most = way[n->arg[k].i] > most ? way[n->arg[k].i] : most;
		way[i] = most + roundings[n->op];
		longest = way[i] > longest ? way[i] : longest;
	}
	arena_release(e->arena, way);
	return way ? longest + 8 : -1; /* and those of the end */
}

/* bounded_quotient.in counts on at most 1.25. */
static const char *factor_text(const struct emission *e, int way)
{
	struct text t;

	text_init(&t, e->arena);
	if (8 * way * e->arithmetic->unit > 1)
		error_set(e->error, RNEAGEN_LIMIT, "%s: more operations one after the other than --bounded can add up in %s%s",
			e->options->file, e->arithmetic->name, e->arithmetic->more);
	emit_number(e, e->arithmetic, 1 + 2 * way * (real)e->arithmetic->unit, &t);
	return text_string(&t);
}

/* Nothing is known of an output that overflowed. */
static const char *ends_text(const struct emission *e, const struct dag *d)
{
	const struct scalar *m = e->memory;
	struct text t, i;

	text_init(&t, e->arena);
	for (int a = 0; a < d->argument_count; a++) {
		if (!d->arguments[a].is_output)
			continue;
		text_init(&i, e->arena);
		if (unparse_first_bound(d, a))
			text_printf(&i, "%d + ", unparse_first_bound(d, a));
		text_put(&i, "i");
		text_printf(&t, "\tfor (int i = 0; i < %d; i++)\n\t\tbound[%s] = ", d->arguments[a].rows, text_string(&i));
		text_printf(&t, "fabs%s(%s[i]) <= %s ? ", m->suffix, d->arguments[a].name, m->largest);
		text_printf(&t, "bound[%s] : bound[%s] + HUGE_VAL%s;\n", text_string(&i), text_string(&i), m->upper);
	}
	return text_string(&t);
}

void emit_bounded(const struct emission *e, struct text *out)
{
	const struct pass *p = emit_main(e);
	const struct scalar *s = e->arithmetic;
	int way = longest_way(e, &p->dag);
	const char *rest;
	const struct slot slots[] = {
		{"F", s->suffix}, {"F_UPPER", s->upper}, {"T", s->type}, {"U", s->unit_text}, {"TINY", s->tiny_text},
		{"MAX", s->largest}, {"MODE", emit_trig_name(emit_trig_of(e->options))},
		{"FUSED", e->options->strict ? "1" : *s->upper ? "defined FP_FAST_FMAF" : "defined FP_FAST_FMA"},
		{"NAME", e->options->name}, {"PASS", p->algorithm->name}, {"STRICT", e->options->strict ? "strict_" : ""}, {"APART", e->options->strict ? "RNEA_APART " : ""},
		{"PARAMS", emit_params(e, p, PARAMS_PLAIN)}, {"NAMES", emit_params(e, p, PARAMS_NAMES)}, {"M", e->memory->type},
		{"FACTOR", factor_text(e, way)}, {"ENDS", ends_text(e, &p->dag)},
	};
	size_t count = sizeof slots / sizeof *slots, from = out->length;

	template_expand(out, template_bounded_in, slots, count);
	if (emit_pass_uses(p, OP_SIN) || emit_pass_uses(p, OP_COS))
		template_expand(out, template_bounded_sincos_in, slots, count);
	if (emit_pass_uses(p, OP_DIV) || emit_pass_uses(p, OP_SQRT))
		template_expand(out, template_bounded_quotient_in, slots, count);
	if (e->memory != s)
		template_expand(out, template_bounded_store_in, slots, count);
	rest = template_expand_to(out, template_bounded_function_in, "BODY", slots, count);
	fold(out, from);
	unparse(e, p, e->numbers->bounded, out);
	from = out->length;
	template_expand(out, rest, slots, count);
	fold(out, from);
	out->failed |= way < 0;
}
