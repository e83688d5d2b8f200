/* Sine and cosine: functions that the text carries, so that their domain and error are known and the same everywhere. */
#include "emit/emit.h"
#include "emit/template.h"
#include <string.h>

/* A robot of sliding joints alone calls none, and a function that nobody calls is a warning. */
static void put_sincos(const struct emission *e, struct text *out)
{
	const struct sincos_frames *f = e->numbers->frames;
	enum rneagen_trig trig = emit_trig_of(e->options);
	int fast = trig == RNEAGEN_FAST;

	if (!emit_uses(e, OP_SIN) && !emit_uses(e, OP_COS))
		return;
	if (f->large && trig == RNEAGEN_ACCURATE)
		text_printf(out, "%s\n%s\n", f->large->core, f->large->accurate);
	text_put(out, fast ? "#if !defined __CUDA_ARCH__\n" : "");
	text_put(out, f->core);
	text_putc(out, '\n');
	text_put(out, trig == RNEAGEN_ACCURATE ? f->accurate : f->bounded);
	if (emit_has_small(e))
		text_put(out, f->either);
	text_put(out, fast ? "#endif\n" : "");
	text_put(out, fast ? "\n" : "");
	text_put(out, fast ? f->fast : "");
}

/* Names of their own where every rounding is prescribed: a header of the other kind may stand before this one. */
static void put_renamed(const char *s, struct text *out)
{
	static const char *const prefixes[][2] = {{"rneagen_", "rneagen_strict_"}, {"RNEAGEN_", "RNEAGEN_STRICT_"}};

	while (*s) {
		int found = -1;

		for (int i = 0; i < 2; i++)
			if (!strncmp(s, prefixes[i][0], strlen(prefixes[i][0])))
				found = i;
		if (found >= 0)
			text_put(out, prefixes[found][1]);
		else
			text_putc(out, *s);
		s += found >= 0 ? strlen(prefixes[found][0]) : 1;
	}
}

/* As the options have it. */
static const char *renamed(const struct emission *e, const struct text *t)
{
	struct text other;

	text_init(&other, e->arena);
	other.failed = t->failed;
	if (e->options->strict)
		put_renamed(text_string(t), &other);
	return e->options->strict ? text_string(&other) : text_string(t);
}

const char *emit_sincos(const struct emission *e)
{
	struct text t;

	text_init(&t, e->arena);
	put_sincos(e, &t);
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

const char *emit_sincos_declaration(const struct emission *e)
{
	const struct number_type *n = e->numbers;
	int either = emit_has_small(e);
	struct text function, t;

	text_init(&function, e->arena);
	text_init(&t, e->arena);
	text_printf(&function, "%s%s", n->sincos, either ? "either" : emit_trig_name(emit_trig_of(e->options)));
	const struct slot slots[] = {{"GUARD", guard_of(e, text_string(&function))}, {"FUNCTION", text_string(&function)},
		{"RESULT", either ? "int" : "void"}, {"SMALL", either ? ", const int small" : ""}, {"VALUE", n->value},
		{"ANGLE", n->angle_is_memory ? e->memory->type : n->value}};
	if (emit_uses(e, OP_SIN) || emit_uses(e, OP_COS))
		template_expand(&t, template_sincos_declaration_in, slots, sizeof slots / sizeof *slots);
	return renamed(e, &t);
}
