/* The table of the number types, numbers as they are written, and the arithmetic as the analysis of errors sees it. */
#include "emit/emit.h"
#include <math.h>
#include <stdint.h>
#include <string.h>

const struct number_type *number_type_of(enum rneagen_precision precision)
{
	static const struct number_type *const types[] = {NULL,
#define NUMBER_TYPE_ENTRY(upper, word) [RNEAGEN_##upper] = &NUMBER_##upper,
		RNEAGEN_PRECISIONS(NUMBER_TYPE_ENTRY)
#undef NUMBER_TYPE_ENTRY
	};

	return types[precision];
}

void emit_set_precision(struct emission *e)
{
	static const struct number_type *const wide[] = {[REFINE_SAME] = NULL, [REFINE_F64] = &WIDE_F64,
		[REFINE_F32X2] = &WIDE_F32X2};

	e->target = target_type_of(e->options->target);
	e->numbers = number_type_of(e->options->precision);
	if (e->request && e->request->refine_steps)
		e->wide = wide[e->request->refine];
	if (e->functions && emit_main(e)->beside)
		e->lanes = e->numbers->lanes;
	e->memory = e->numbers->memory;
	e->arithmetic = e->numbers->arithmetic;
}

enum rneagen_precision emit_precision_of(const struct rneagen_options *o)
{
	return o->precision != RNEAGEN_PRECISION_DEFAULT ? o->precision : target_type_of(o->target)->precision;
}

const char *emit_precision_name(enum rneagen_precision precision)
{
	static const char *const names[] = {"default",
#define PRECISION_NAME(upper, word) word,
		RNEAGEN_PRECISIONS(PRECISION_NAME)
#undef PRECISION_NAME
	};

	return names[precision];
}

/* Where such a number is written, if it is. */
static struct written_number *place_of(const struct emission *e, double value)
{
	uint64_t bits;

	memcpy(&bits, &value, sizeof bits);
	return &e->written[bits * 0x9e3779b97f4a7c15u >> 32 & (EMIT_WRITTEN - 1)];
}

void emit_number(const struct emission *e, const struct scalar *type, real value, struct text *out)
{
	double rounded = (double)type->round(value);
	struct written_number here, *w;

	if (!isfinite(rounded)) {
		error_set(e->error, RNEAGEN_NUMBER, "%s: a constant of the model, %.6Lg, is no finite number in %s%s",
			e->options->file, value, type->name, type->more);
		rounded = 0;
	}
	w = e->written ? place_of(e, rounded) : &here;
	if (!e->written || w->type != type || w->value != rounded || signbit(w->value) != signbit(rounded)) {
		w->type = type;
		w->value = rounded;
		type->write(rounded, w->s, sizeof w->s);
	}
	text_put(out, w->s);
}

/* The GPU's own unit. */
static void set_fast(struct eval_model *m, const struct number_type *n)
{
	m->sincos = 0;
	m->sine = exp2(n->fast_sine);
	m->cosine = exp2(n->fast_cosine);
	m->angle = n->fast_angle;
}

struct eval_model eval_model_of(const struct rneagen_options *o, int on_gpu)
{
	const struct number_type *n = number_type_of(emit_precision_of(o));
	struct eval_model m = n->model;

	m.fused = n->fuses && (on_gpu || o->strict);
	m.products = on_gpu ? PAIRS_FUSED : PAIRS_EITHER;
	m.angle = emit_trig_of(o) == RNEAGEN_ACCURATE ? (double)INFINITY : n->arithmetic->domain;
	if (n->frames->fast && on_gpu && o->trig == RNEAGEN_FAST)
		set_fast(&m, n);
	return m;
}
