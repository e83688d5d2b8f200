/* Sine and cosine: functions that the text carries, so that their domain and error are known and the same everywhere. */
#include "emit/emit.h"
#include "emit/template.h"
#include <string.h>

/* A robot of sliding joints alone calls none, and a function that nobody calls is a warning. */
static int has_angles(const struct emission *e)
{
	for (int i = 0; i < e->pass_count; i++)
		if (plan_operations(&e->passes[i].plan).sincos)
			return 1;
	return 0;
}

/* The fragments of a type. */
struct fragments {
	const char *core, *bounded, *accurate, *either;
};

static const struct fragments F32 = {template_sincos_f32_core_in, template_sincos_f32_bounded_in,
	template_sincos_f32_accurate_in, template_sincos_f32_either_in};
static const struct fragments F64 = {template_sincos_f64_core_in, template_sincos_f64_bounded_in,
	template_sincos_f64_accurate_in, template_sincos_f64_either_in};
static const struct fragments F32X2 = {template_sincos_f32x2_core_in, template_sincos_f32x2_bounded_in,
	template_sincos_f32x2_accurate_in, template_sincos_f32x2_either_in};

/* Pairs of floats leave large angles to doubles. */
static void put_large(struct text *out)
{
	text_put(out, F64.core);
	text_putc(out, '\n');
	text_put(out, F64.accurate);
	text_putc(out, '\n');
}

static void put_sincos(const struct emission *e, struct text *out)
{
	const struct fragments *f = e->arithmetic->part ? &F32X2 : e->arithmetic->bytes == 4 ? &F32 : &F64;
	enum rneagen_trig trig = emit_trig_of(e->options);
	int fast = trig == RNEAGEN_FAST;

	if (!has_angles(e))
		return;
	if (f == &F32X2 && trig == RNEAGEN_ACCURATE)
		put_large(out);
	text_put(out, fast ? "#if !defined __CUDA_ARCH__\n" : "");
	text_put(out, f->core);
	text_putc(out, '\n');
	text_put(out, trig == RNEAGEN_ACCURATE ? f->accurate : f->bounded);
	if (emit_has_small(e))
		text_put(out, f->either);
	text_put(out, fast ? "#endif\n" : "");
	text_put(out, fast ? "\n" : "");
	text_put(out, fast ? template_sincos_f32_fast_in : "");
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

void emit_sincos(const struct emission *e, struct text *out)
{
	struct text t;

	text_init(&t, e->arena);
	put_sincos(e, &t);
	out->failed |= t.failed;
	if (e->options->strict)
		put_renamed(text_string(&t), out);
	else
		text_put(out, text_string(&t));
}
