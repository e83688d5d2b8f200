#include "dag/eval_model.h"
#include "emit/emit.h"
#include <float.h>
#include <math.h>

static real constant_f32(real value)
{
	return (real)(float)value;
}

static real constant_f64(real value)
{
	return (real)(double)value;
}

/* 0.85 units in the last place are 1.7 of rounding. No result of sine and cosine underflows but for tiny angles. */
static const struct eval_model F32 = {.add = 0x1p-24, .mul = 0x1p-24, .tiny = 0x1p-150, .largest = (double)FLT_MAX,
	.sincos = 1.7 * 0x1p-24, .sine = 0x1p-149, .store_largest = DBL_MAX, .constant = constant_f32};
static const struct eval_model F64 = {.add = 0x1p-53, .mul = 0x1p-53, .tiny = 0x1p-1072, .largest = DBL_MAX,
	.sincos = 1.7 * 0x1p-53, .sine = 0x1p-1072, .store_largest = DBL_MAX, .constant = constant_f64};

static real constant_f32x2(real value)
{
	float hi = (float)value;

	return (real)hi + (real)(float)(value - (real)hi);
}

/* The bounds that templates/f32x2.in and sincos_f32x2_core.in state; tests/templates/test_f32x2 holds them against MPFR. Factors
   are split into halves by 4097, which must not overflow. */
static const struct eval_model F32X2 = {.terms = 3.001 * 0x1p-48, .mul = 7 * 0x1p-48, .tiny = 0x1p-146, .input = 0x1p-48,
	.largest = 0x1p114, .sincos = 0x1p-46, .sine = 0x1p-58, .cosine = 0x1p-58, .store = 0x1p-53, .store_largest = DBL_MAX,
	.constant = constant_f32x2};

/* Results are rounded to float when they are stored. */
static void set_store_f32(struct eval_model *m)
{
	m->store = F32.add;
	m->store_tiny = F32.tiny;
	m->store_largest = F32.largest;
}

/* The GPU's own unit. */
static void set_fast(struct eval_model *m)
{
	m->sincos = 0;
	m->sine = exp2(-21.41);
	m->cosine = exp2(-21.19);
	m->angle = (double)3.14159265f;
}

struct eval_model eval_model_of(const struct rneagen_options *o, int on_gpu)
{
	enum rneagen_precision precision = emit_precision_of(o);
	int f32 = precision == RNEAGEN_F32, f32x2 = precision == RNEAGEN_F32X2;
	struct eval_model m = f32x2 ? F32X2 : f32 ? F32 : F64;

	m.fused = !f32x2 && (on_gpu || o->strict);
	m.angle = o->trig == RNEAGEN_ACCURATE ? (double)INFINITY : f32 || f32x2 ? 1e4 : 1e7;
	if (precision == RNEAGEN_MIXED)
		set_store_f32(&m);
	if (f32 && on_gpu && o->trig == RNEAGEN_FAST)
		set_fast(&m);
	return m;
}
