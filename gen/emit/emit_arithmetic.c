/* What RNEA_FMA and, where the same bits are wanted everywhere, every other operation of the statements means. Those of wide
   numbers stand beside them, as RNEA_WIDE_FMA. */
#include "emit/emit.h"
#include "base/template.h"

/* What a frame is filled with: the operations of both kinds of numbers, and frames filled before. */
struct inner {
	const char *operations_cuda, *operations_c, *cuda, *c;
};

static const char *expanded(const struct emission *e, const struct scalar *s, const char *tmpl, struct inner x)
{
	const struct slot slots[] = {{"F", s->suffix}, {"D", s->letter}, {"FMA_SUFFIX_UPPER", s->upper},
		{"WIDE", s == e->arithmetic ? "" : "WIDE_"}, {"FLUSH", s->flushes ? template_arithmetic_strict_flush_in : ""},
		{"OPERATIONS_CUDA", x.operations_cuda}, {"OPERATIONS_C", x.operations_c}, {"STRICT_CUDA", x.cuda},
		{"STRICT_C", x.c}};
	struct text t;

	text_init(&t, e->arena);
	template_expand(&t, tmpl, slots, sizeof slots / sizeof *slots);
	return text_string(&t);
}

/* Of the text's numbers, then of the wide ones. */
static const char *both(const struct emission *e, const char *tmpl)
{
	const struct inner nothing = {"", "", "", ""};
	struct text t;

	text_init(&t, e->arena);
	text_put(&t, expanded(e, e->arithmetic, tmpl, nothing));
	if (e->wide)
		text_put(&t, expanded(e, e->wide->arithmetic, tmpl, nothing));
	return text_string(&t);
}

static const char *with_anew(const struct emission *e, const char *arithmetic)
{
	const struct scalar *s = e->arithmetic;
	const struct slot slots[] = {{"T", s->type}, {"F", s->suffix}, {"UPPER", s->upper}, {"CONSTRAINT", s->letter}};
	struct text t;

	if (!emit_uses(e, OP_ANEW) || e->numbers->calls[OP_MUL])
		return arithmetic;
	text_init(&t, e->arena);
	text_put(&t, arithmetic);
	template_expand(&t, template_anew_in, slots, sizeof slots / sizeof *slots);
	return text_string(&t);
}

const char *emit_arithmetic(const struct emission *e, const struct target_type *target)
{
	struct inner x = {"", "", "", ""};

	if (!e->options->strict)
		return with_anew(e, both(e, target->arithmetic));
	x.operations_cuda = both(e, template_arithmetic_strict_cuda_operations_in);
	x.operations_c = both(e, template_arithmetic_strict_c_operations_in);
	x.cuda = expanded(e, e->arithmetic, template_arithmetic_strict_cuda_in, x);
	x.c = expanded(e, e->arithmetic, template_arithmetic_strict_c_in, x);
	return with_anew(e, expanded(e, e->arithmetic, target->strict_arithmetic, x));
}

const char *emit_undef_strict(const struct emission *e)
{
	return e->options->strict ? "#undef RNEA_ADD\n#undef RNEA_SUB\n#undef RNEA_MUL\n#undef RNEA_DIV\n#undef RNEA_SQRT\n"
				    "#undef RNEA_APART\n" : "";
}

const char *emit_undef_wide(const struct emission *e)
{
	if (!e->wide)
		return "";
	return e->options->strict ? "#undef RNEA_WIDE_FMA\n#undef RNEA_WIDE_ADD\n#undef RNEA_WIDE_SUB\n#undef RNEA_WIDE_MUL\n"
				    "#undef RNEA_WIDE_DIV\n#undef RNEA_WIDE_SQRT\n" : "#undef RNEA_WIDE_FMA\n";
}
