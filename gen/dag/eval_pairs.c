/* A pair is its value rounded to a float, hi, and a rest lo. What sums and products of pairs take is of the size of the rests,
   which are anything up to u |x|, u = 2^-24. Unless a value is so close to the middle between two floats that its error decides,
   hi is known, and lo but for that error; then so is all that is rounded, step by step, as f32x2.in computes it. */
#include "dag/eval_pairs.h"
#include <float.h>
#include <math.h>
#include <stdint.h>
#include <string.h>

#define U 0x1p-24
#define OWN 0x1.1p-53 /* of this file's doubles */

/* lo is at most `off` away. */
struct pair {
	double hi, lo, off;
};

/* Returns whether hi is certain: the last rounding of a product's rest, by up to 3.01 u^2, and of lo, by up to 1.01 u^2, comes
   after hi; and hi is rounded without what the product leaves out, and after its cross terms are. */
static int pair_of(struct known a, struct pair *p)
{
	double size = fabs(a.x), half;

	p->hi = (double)(float)a.x;
	p->lo = a.x - p->hi;
	p->off = a.e > 0 ? a.e + 2 * DBL_EPSILON * size : 0;
	half = U * rounding_place(p->hi);
	if (rounding_place(p->hi) == fabs(p->hi))
		half /= 2; /* floats below a power of two are closer */
	if (a.e == 0 && (size == 0 || p->lo == 0))
		return 1;
	return size > 1e-25 && size < 1e30 && fabs(p->lo) + p->off + 5 * U * U * size < half;
}

static int has_rest(const struct pair *p)
{
	return p->lo != 0 || p->off > 0;
}

/* Of a float no larger than this. */
static double float_rounding(double most)
{
	return U * rounding_place(most * (1 + DBL_EPSILON));
}

/* t = fl(a.lo + b.lo), lo = fl(s_low + t). The last step is exact, also where s is less than lo: s is then one unit in the last
   place of a.hi or b.hi, and of the same power of two as lo. */
double pairs_sum(struct known a, struct known b)
{
	struct pair p, q;
	double s, low, off, t;

	if (!pair_of(a, &p) || !pair_of(b, &q))
		return (double)INFINITY;
	s = (double)(float)(p.hi + q.hi);
	low = fabs(p.hi) < fabs(q.hi) ? (q.hi - s) + p.hi : (p.hi - s) + q.hi;
	off = p.off + q.off;
	if (!has_rest(&p) && !has_rest(&q))
		return 0; /* lo is s_low */
	t = has_rest(&p) && has_rest(&q) ? float_rounding(fabs(p.lo + q.lo) + off) : 0;
	return low == 0 ? t : t + float_rounding(fabs(low + p.lo + q.lo) + off + t);
}

/* ---- products ---- */

/* Cross terms a.hi b.lo and a.lo b.hi, `off` together; `are_two`: neither is exactly 0. */
struct crossed {
	double one, other, off;
	int are_two;
};

static double rounding_of_crossed(const struct crossed *c, double before)
{
	return before + (c->are_two ? float_rounding(fabs(c->one + c->other) + c->off + before) : 0);
}

/* With a fused multiply-add: t = fl(a.hi b.lo + fl(a.lo b.hi)), hi = fl(a.hi b.hi + t), rest = fl(a.hi b.hi - hi), lo = fl(rest +
   t). hi is the product rounded to a float; what is left out of rest is known, with its sign. */
static double product_by_fma(double product, const struct crossed *c, double hi, double *left_out)
{
	double rest = (double)(float)(product - hi);
	double t = rounding_of_crossed(c, float_rounding(fmax(fabs(c->one), fabs(c->other)) + c->off));

	*left_out = product - hi - rest;
	return t + float_rounding(fabs(rest + c->one + c->other) + c->off + t);
}

/* Without: p + p_low = a.hi b.hi, lo = fl(p_low + fl(fl(a.hi b.lo) + fl(a.lo b.hi))); the last step is exact. */
static double product_by_halves(double product, const struct crossed *c)
{
	double low = product - (double)(float)product;
	double t = rounding_of_crossed(c, float_rounding(fabs(c->one) + c->off) + float_rounding(fabs(c->other) + c->off));

	return t + float_rounding(fabs(low + c->one + c->other) + c->off + t);
}

/* Either way leaves a.lo b.lo out: but for the rests' own errors that is known. */
double pairs_product(enum pair_products by, struct known a, struct known b, struct known x, double *left_out)
{
	struct pair p, q, of;
	struct crossed c;
	double of_rest = 0, off;

	if (!pair_of(a, &p) || !pair_of(b, &q) || !pair_of(x, &of))
		return (double)INFINITY;
	c = (struct crossed){p.hi * q.lo, p.lo * q.hi, fabs(p.hi) * q.off + fabs(q.hi) * p.off, has_rest(&p) && has_rest(&q)};
	off = by == PAIRS_BY_HALVES ? product_by_halves(p.hi * q.hi, &c) : product_by_fma(p.hi * q.hi, &c, of.hi, &of_rest);
	*left_out = p.lo * q.lo + of_rest;
	return off + fabs(p.lo) * q.off + fabs(q.lo) * p.off + p.off * q.off + DBL_EPSILON * (fabs(p.lo * q.lo) + fabs(of_rest));
}

/* ---- sine and cosine, step by step ---- */

double pairs_head(double x)
{
	uint64_t bits;

	memcpy(&bits, &x, sizeof bits);
	bits &= 0xffffffffe0000000u;
	memcpy(&x, &bits, sizeof x);
	return x;
}

/* What a text has for x, which it knows but for `off`, rounded to a float; mostly that is certain, and then the error is
   forgotten. OWN twice: x and the two ends are rounded. */
static struct known rounded(double x, double off)
{
	double most = off + 2 * OWN * fabs(x), low = (double)(float)(x - most), high = (double)(float)(x + most);

	return low == high ? (struct known){low, 0} : (struct known){x, most + float_rounding(fabs(x) + most)};
}

/* Nothing is known where that is open. */
static struct pair with_first(double x, double off, struct pair y)
{
	struct known first = rounded(x, off);

	y.hi = first.x;
	y.off += first.e > 0 ? (double)INFINITY : 0;
	return y;
}

/* s + w, where s is no less. */
static struct pair renormalised(double s, struct known w)
{
	struct pair y = with_first(s + w.x, w.e, (struct pair){0, 0, w.e});

	y.lo = w.x - (y.hi - s);
	return y;
}

static struct known rests(double one, double off_one, double other, double off_other, int are_two)
{
	return are_two ? rounded(one + other, off_one + off_other) : (struct known){one + other, off_one + off_other};
}

static struct pair add(struct pair a, struct pair b)
{
	float x = (float)a.hi, y = (float)b.hi, s = x + y, of_y = s - x, low = (x - (s - of_y)) + (y - of_y);
	struct known t = rests(a.lo, a.off, b.lo, b.off, has_rest(&a) && has_rest(&b));

	return renormalised((double)s, low != 0 ? rounded((double)low + t.x, t.e) : t);
}

static struct pair multiply_fused(struct pair a, struct pair b)
{
	struct known one = rounded(a.lo * b.hi, a.off * fabs(b.hi)), t = rounded(a.hi * b.lo + one.x, fabs(a.hi) * b.off + one.e), w;
	struct pair y = with_first(a.hi * b.hi + t.x, t.e, (struct pair){0, 0, 0});

	w = rounded((double)(float)(a.hi * b.hi - y.hi) + t.x, t.e);
	return (struct pair){y.hi, w.x, y.off + w.e};
}

static struct pair multiply_by_halves(struct pair a, struct pair b)
{
	struct known one = rounded(a.hi * b.lo, fabs(a.hi) * b.off), other = rounded(a.lo * b.hi, a.off * fabs(b.hi)), t;
	double product = a.hi * b.hi, first = (double)(float)product;

	t = rounded(one.x + other.x, one.e + other.e);
	return renormalised(first, rounded(product - first + t.x, t.e));
}

static struct pair multiply(const struct eval_model *m, struct pair a, struct pair b)
{
	return m->products == PAIRS_BY_HALVES ? multiply_by_halves(a, b) : multiply_fused(a, b);
}

static struct pair exactly(double x)
{
	return (struct pair){(double)(float)x, x - (double)(float)x, 0};
}

/* DWPlusFP, to the bit. */
static struct pair add_float(struct pair y, float b)
{
	float a = (float)y.hi, s = a + b, of_b = s - a, low = (a - (s - of_b)) + (b - of_b), c = (float)y.lo + low, hi = s + c;

	return (struct pair){(double)hi, (double)(c - (hi - s)), 0};
}

/* Of what the last step adds it is open whether its product is rounded; that rarely matters. */
static struct pair add_last(struct pair y, float k, float rest)
{
	struct pair one = add_float(y, fmaf(-k, 0x1.1a6264p-54f, rest)), other;
	volatile float product = -k * 0x1.1a6264p-54f;

	other = add_float(y, product + rest);
	one.off = one.hi == other.hi ? fabs(one.lo - other.lo) : (double)INFINITY;
	return one;
}

/* x - k pi/2 as the text has it. k times each part of pi/2 but the last is a float, and x.hi - k C1 too. */
static struct pair reduce(double x, double k)
{
	double head = pairs_head(x), middle = pairs_head(x - head), hi = (double)(float)(head + middle);
	struct pair y = add_float((struct pair){hi - k * 0x1.92p0, 0, 0}, (float)(-k * 0x1.fb4p-12));

	y = add_float(y, (float)(head + middle - hi));
	y = add_float(y, (float)(-k * 0x1.444p-24));
	y = add_float(y, (float)(-k * 0x1.68cp-39));
	return add_last(y, (float)k, (float)(x - head - middle));
}

/* The end of a polynomial, x, is computed in floats: with at most five roundings, that of a compiler that joins it to the sum
   among them. */
static struct pair begun(double first, double x)
{
	struct known sum = {first + x, 5 * U * fabs(x) + 4 * U * U * (fabs(first) + fabs(x))};
	struct pair p;

	if (!pair_of(sum, &p))
		p.off = (double)INFINITY;
	return p;
}

static struct pair sine_of(const struct eval_model *m, struct pair r)
{
	static const double by[] = {-0x1.71de36p-19 + 0x1.6241a8p-44, 0x1.a01a02p-13 - 0x1.907298p-39, -0x1.111112p-7 + 0x1.dde11ep-32,
		0x1.555556p-3 - 0x1.555558p-28};
	struct pair z = multiply(m, r, r), p = begun(by[0], (-0x1.5d898p-33 * z.hi + 0x1.ae5e46p-26) * z.hi);

	for (int k = 1; k < 4; k++)
		p = add(multiply(m, p, z), exactly(by[k]));
	p = multiply(m, multiply(m, r, z), p);
	return add(r, (struct pair){-p.hi, -p.lo, p.off});
}

static struct pair cosine_of(const struct eval_model *m, struct pair r)
{
	static const double by[] = {
		0x1.a01a02p-16 - 0x1.8dc3bep-42, -0x1.6c16c2p-10 + 0x1.27d5fcp-35, 0x1.555556p-5 - 0x1.555554p-30, -0.5, 1};
	struct pair z = multiply(m, r, r), p = begun(by[0], ((-0x1.8fa59p-37 * z.hi + 0x1.1ee9dap-29) * z.hi - 0x1.27e4f8p-22) * z.hi);

	for (int k = 1; k < 5; k++)
		p = add(multiply(m, p, z), exactly(by[k]));
	return p;
}

/* Nothing is said where it is open which quarter the angle is taken for, nor of angles that take another way. */
double pairs_turn(const struct eval_model *m, int is_sine, double angle, double value, double *left_out)
{
	double turns = angle * 0x1.45f306dc9c883p-1, k = nearbyint(turns), quarter = k - 4 * floor(k / 4), sign;
	struct pair y;

	if (!(fabs(angle) <= 9999) || fabs(turns - k) > 0.499)
		return (double)INFINITY;
	y = reduce(angle, k);
	y = (quarter == 1 || quarter == 3) == is_sine ? cosine_of(m, y) : sine_of(m, y);
	sign = quarter >= 2 - !is_sine && quarter <= 2 + is_sine ? -1 : 1;
	*left_out = value - sign * y.hi - sign * y.lo;
	return y.off + OWN * fabs(value) + DBL_EPSILON * fabs(*left_out) + m->tiny; /* tiny: floats below the normal ones */
}
