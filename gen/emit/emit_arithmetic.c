/* What RNEA_FMA and, where the same bits are wanted everywhere, every other operation of the statements means. */
#include "emit/emit.h"
#include "emit/template.h"

static const char *expanded(const struct emission *e, const char *tmpl, const char *strict_cuda, const char *strict_c)
{
	const struct scalar *s = e->arithmetic;
	const struct slot slots[] = {{"F", s->suffix}, {"D", s->letter}, {"FMA_SUFFIX_UPPER", s->upper},
		{"FLUSH", s->flushes ? template_arithmetic_strict_flush_in : ""}, {"STRICT_CUDA", strict_cuda}, {"STRICT_C", strict_c}};
	struct text t;

	text_init(&t, e->arena);
	template_expand(&t, tmpl, slots, sizeof slots / sizeof *slots);
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
	if (!e->options->strict)
		return with_anew(e, expanded(e, target->arithmetic, "", ""));
	return with_anew(e, expanded(e, target->strict_arithmetic, expanded(e, template_arithmetic_strict_cuda_in, "", ""),
		expanded(e, template_arithmetic_strict_c_in, "", "")));
}
