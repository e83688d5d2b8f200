/* Included by f32x2_plain.c, f32x2_fma.c and f32x2_contracted.c, each with its own F32X2 and NAME. */
#include "f32x2.h"
#include <math.h>

#define RNEA_INLINE inline
#if defined __FMA__
#define RNEA_FMA fma
#else
#define RNEA_FMA(a, b, c) ((a)*(b) + (c))
#endif
#include "f32x2.in"
#include "sincos_f64_core.in"
#include "sincos_f64_accurate.in"
#include "sincos_f32x2_core.in"
#include "sincos_f32x2_bounded.in"
#include "sincos_f32x2_accurate.in"

static struct rneagen_f32x2 get(const float *a)
{
	return rneagen_pair(a[0], a[1]);
}

static void put(struct rneagen_f32x2 a, float *out)
{
	out[0] = a.hi;
	out[1] = a.lo;
}

static void add(const float *a, const float *b, float *out)
{
	put(rneagen_add(get(a), get(b)), out);
}

static void mul(const float *a, const float *b, float *out)
{
	put(rneagen_mul(get(a), get(b)), out);
}

static void muladd(const float *a, const float *b, const float *c, float *out)
{
	put(rneagen_fma(get(a), get(b), get(c)), out);
}

static void add_f(const float *a, float b, float *out)
{
	put(rneagen_add_f(get(a), b), out);
}

static void mul_f(const float *a, float b, float *out)
{
	put(rneagen_mul_f(get(a), b), out);
}

static void sine(double x, float *s, float *c)
{
	struct rneagen_f32x2 y, z;

	rneagen_sincos_f32x2_accurate(x, &y, &z);
	put(y, s);
	put(z, c);
}

static void bounded(double x, float *s, float *c)
{
	struct rneagen_f32x2 y, z;

	rneagen_sincos_f32x2_bounded(x, &y, &z);
	put(y, s);
	put(z, c);
}

static void split(double x, float *out)
{
	put(rneagen_split(x), out);
}

static double join(const float *a)
{
	return rneagen_join(get(a));
}

F32X2 = {NAME, RNEAGEN_F32X2_FMA ? 7 : 5, RNEAGEN_F32X2_FMA ? 4 : 3, add, mul, muladd, add_f, mul_f, sine, bounded, split, join};
