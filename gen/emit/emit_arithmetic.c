/* What RNEA_FMA and, where the same bits are wanted everywhere, every other operation of the statements means. Those of wide
   numbers stand beside them, as RNEA_WIDE_FMA. */
#include "base/template.h"
#include "emit/emit.h"
#include "emit/kernels/emit_limbs.h"
#include <string.h>

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

	return template_text(e->arena, tmpl, slots, sizeof slots / sizeof *slots);
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
	const struct slot slots[] = {{"T", s->type}, {"MEMORY", e->memory->type}, {"F", s->suffix}, {"UPPER", s->upper},
		{"CONSTRAINT", s->letter}};
	struct text t;

	if ((!emit_uses(e, OP_ANEW) && !emit_joints_again(e)) || e->numbers->calls[OP_MUL])
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

/* Numbers of f32 have a suffix, and are floats whatever the flags. */
static int has_doubles(const struct emission *e)
{
	return e->memory->bytes == 8 || e->arithmetic->bytes == 8 || e->options->bounded || e->wide;
}

const char *emit_ieee(const struct emission *e)
{
	struct text t;

	text_init(&t, e->arena);
	text_put(&t, template_ieee_in);
	text_put(&t, has_doubles(e) ? template_ieee_double_in : "");
	return text_string(&t);
}

/* ---- sine and cosine ---- */

/* Functions that the text carries, so that their domain and error are known and the same everywhere. */

/* What the options name, and the type of numbers has. */
static enum rneagen_trig trig_of(const struct emission *e, const struct number_type *n)
{
	enum rneagen_trig trig = emit_trig_of(e->options);

	return trig == RNEAGEN_FAST && !n->frames->fast ? RNEAGEN_BOUNDED : trig;
}

/* A robot of sliding joints alone calls none, and a function that nobody calls is a warning. */
static int has_sincos(const struct emission *e, const struct number_type *n)
{
	return n && (emit_uses_in(e, OP_SIN, n == e->wide) || emit_uses_in(e, OP_COS, n == e->wide));
}

const char *emit_sincos_name(const struct emission *e, const struct number_type *n)
{
	return text_format(e->arena, "%s%s", e->options->strict ? n->strict_sincos : n->sincos,
		emit_has_known(e) && !n->is_beside ? "known"
			: emit_trig_name(n->is_beside ? emit_trig_of(e->options) : trig_of(e, n)));
}

static void put_sincos(const struct emission *e, const struct number_type *n, struct text *out)
{
	const struct sincos_frames *f = n->frames;
	enum rneagen_trig trig = trig_of(e, n);
	int fast = trig == RNEAGEN_FAST;

	if (f->large && trig == RNEAGEN_ACCURATE)
		text_printf(out, "%s\n%s\n", f->large->core, f->large->accurate);
	text_put(out, fast ? "#if !defined __CUDA_ARCH__\n" : "");
	text_put(out, f->core);
	text_putc(out, '\n');
	text_put(out, trig == RNEAGEN_ACCURATE ? f->accurate : f->bounded);
	if (emit_has_known(e))
		text_put(out, emit_limbs_know(e) ? f->known : emit_unless_limbs(e, f->known));
	text_put(out, fast ? "#endif\n" : "");
	text_put(out, fast ? "\n" : "");
	text_put(out, fast ? f->fast : "");
}

struct renaming {
	const char *from, *to;
};

/* Up to a renaming without `from`. */
static void put_renamed(const char *s, const struct renaming *prefixes, struct text *out)
{
	while (*s) {
		int found = -1;

		for (int i = 0; prefixes[i].from; i++)
			if (!strncmp(s, prefixes[i].from, strlen(prefixes[i].from)))
				found = i;
		if (found >= 0)
			text_put(out, prefixes[found].to);
		else
			text_putc(out, *s);
		s += found >= 0 ? strlen(prefixes[found].from) : 1;
	}
}

/* Names of their own where every rounding is prescribed: a header of the other kind may stand before this one. */
static const char *renamed(const struct emission *e, const struct text *t)
{
	static const struct renaming strict[] = {{"rneagen_", "rneagen_strict_"}, {"RNEAGEN_", "RNEAGEN_STRICT_"}, {NULL, NULL}};
	struct text other;

	text_init(&other, e->arena);
	other.failed = t->failed;
	if (e->options->strict)
		put_renamed(text_string(t), strict, &other);
	return e->options->strict ? text_string(&other) : text_string(t);
}

const char *emit_sincos(const struct emission *e)
{
	static const struct renaming beside[] = {{"RNEA_FMA", "RNEA_WIDE_FMA"}, {NULL, NULL}};
	struct text t, wide;

	text_init(&t, e->arena);
	text_init(&wide, e->arena);
	if (has_sincos(e, e->numbers))
		put_sincos(e, e->numbers, &t);
	if (has_sincos(e, e->wide))
		put_sincos(e, e->wide, &wide);
	if (wide.length)
		put_renamed(text_string(&wide), beside, &t);
	t.failed |= wide.failed;
	return renamed(e, &t);
}

/* The macro that guards a function's definition: its name in capitals. */
static const char *guard_of(const struct emission *e, const char *function)
{
	struct text t;

	text_init(&t, e->arena);
	for (; *function; function++)
		text_putc(&t, *function >= 'a' && *function <= 'z' ? (char)(*function - 'a' + 'A') : *function);
	return text_string(&t);
}

static void put_declaration(const struct emission *e, const struct number_type *n, struct text *out)
{
	int known = emit_has_known(e);
	const char *function = text_format(e->arena, "%s%s", n->sincos, known ? "known" : emit_trig_name(trig_of(e, n)));
	const char *more = known ? text_format(e->arena, ", const int known, const %s *sines", n->value) : "";
	const struct slot slots[] = {{"GUARD", guard_of(e, function)}, {"FUNCTION", function},
		{"RESULT", known ? "int" : "void"}, {"KNOWN", more}, {"VALUE", n->value},
		{"ANGLE", n->angle_is_memory ? n->memory->type : n->value}};
	struct text whole;

	text_init(&whole, e->arena);
	template_expand(&whole, template_sincos_declaration_in, slots, sizeof slots / sizeof *slots);
	text_put(out, known && !emit_limbs_know(e) ? emit_unless_limbs(e, text_string(&whole)) : text_string(&whole));
}

const char *emit_sincos_declaration(const struct emission *e)
{
	struct text t;

	text_init(&t, e->arena);
	if (has_sincos(e, e->numbers))
		put_declaration(e, e->numbers, &t);
	if (has_sincos(e, e->wide))
		put_declaration(e, e->wide, &t);
	return renamed(e, &t);
}
