#include "base/within.h"
#include <float.h>
#include <math.h>
#include <stdint.h>
#include <string.h>

/* Half a unit in the last place of 1. Where numbers have more than 64 digits of two, 64 are kept: texts go by what is found to be
   equal, and other processors write what x86 writes. */
#if LDBL_MANT_DIG > 64
static const real UNIT = 0x1p-64L;

static real kept(real x)
{
	const real scaled = x * ((real)(1ull << (LDBL_MANT_DIG - 64)) + 1);

	return isfinite(scaled) ? scaled - (scaled - x) : x;
}
#else
static const real UNIT = LDBL_EPSILON / 2;
#define kept(x) (x)
#endif

static const real RIGHT_ANGLE = 1.57079632679489661923132169163975144L;

/* What makes up for the rounding of e itself: no operation has more than eight. */
static struct within closed(real x, real near, real e)
{
	const real k = kept(near);

	e = isnan(e) ? (real)INFINITY : isfinite(near) ? e + fabsl(near - k) : e;
	return (struct within){kept(x), k, e > 0 ? e * (1 + 16 * UNIT) + LDBL_TRUE_MIN : 0, 0, 0};
}

static int is_nothing(const struct within *a)
{
	return a->near == 0 && a->e == 0 && a->x == 0 && !a->limb;
}

static unsigned kind_of(const struct within *a)
{
	double x = (double)a->x;
	uint64_t bits;

	memcpy(&bits, &x, sizeof bits);
	return a->limb ? a->kind : (unsigned)(bits * 0x9e3779b97f4a7c15u >> 33);
}

static unsigned mixed(unsigned kind, char sign)
{
	uint64_t h = ((uint64_t)kind + 1) * 0x9e3779b97f4a7c15u ^ (uint64_t)sign;

	return (unsigned)((h ^ h >> 29) * 0x9e3779b97f4a7c15u >> 34);
}

/* Of an operation, by its sign; its neutral element leaves the kind. */
static void set_limbs(struct within *result, char sign, real neutral, const struct within *a, const struct within *b)
{
	if ((!a->limb && !b->limb) || (sign == '*' && !b->limb && b->x == 0) || (sign != '+' && !a->limb && a->x == 0))
		return;
	result->limb = a->limb == b->limb || !b->limb ? a->limb : a->limb ? -1 : b->limb;
	if (!a->limb && a->x == neutral && sign != '/')
		result->kind = b->kind;
	else if (!b->limb && b->x == neutral)
		result->kind = a->kind;
	else if (result->limb)
		result->kind = mixed(kind_of(a), sign) + (sign == '/' ? 2 : 1) * mixed(kind_of(b), sign);
}

struct within within_exact(real x)
{
	return (struct within){x, x, 0, 0, 0};
}

struct within within_decimal(real x, real near)
{
	return closed(x, kept(near), UNIT * fabsl(near));
}

struct within within_double(double x)
{
	double unit = nextafter(fabs(x), (double)INFINITY) - fabs(x);

	return (struct within){(real)x, (real)x, x == floor(x) ? 0 : (real)unit / 2, 0, 0};
}

struct within within_neg(struct within a)
{
	return (struct within){-a.x, -a.near, a.e, a.limb, a.kind ^ (a.limb ? WITHIN_NEGATED : 0)};
}

/* The rounding of a sum is a number of the type (Knuth, The Art of Computer Programming, volume 2, theorem 4.2.2B). */
struct within within_add(struct within a, struct within b)
{
	real sum = a.near + b.near, of_b = sum - a.near, of_a = sum - of_b;
	struct within c = closed(a.x + b.x, sum, a.e + b.e + fabsl((a.near - of_a) + (b.near - of_b)));

	set_limbs(&c, '+', 0, &a, &b);
	return c;
}

struct within within_sub(struct within a, struct within b)
{
	return within_add(a, within_neg(b));
}

/* The upper half of a number's digits. */
static real upper(real a)
{
	const real scaled = a * ((real)(1ull << (LDBL_MANT_DIG + 1) / 2) + 1);

	return scaled - (scaled - a);
}

/* So is that of a product, unless it underflows (Dekker, Numerische Mathematik 18, 1971). fmal gives the same, but is a long
   program where a processor has no such instruction: a search for base parameters took 1.5 times as long. */
static real rounding(real a, real b, real product)
{
	const real a1 = upper(a), b1 = upper(b), a2 = a - a1, b2 = b - b1;

	if (a == 0 || b == 0)
		return 0;
	if (fabsl(product) < LDBL_MIN / UNIT)
		return LDBL_MIN;
	return fabsl(((a1 * b1 - product) + a1 * b2 + a2 * b1) + a2 * b2);
}

struct within within_mul(struct within a, struct within b)
{
	real product = a.near * b.near, inherited = fabsl(a.near) * b.e + fabsl(b.near) * a.e + a.e * b.e;
	struct within c = {kept(a.x * b.x), product, 0, 0, 0};

	if (is_nothing(&a) || is_nothing(&b))
		return c;
	c = closed(c.x, product, inherited + rounding(a.near, b.near, product));
	set_limbs(&c, '*', 1, &a, &b);
	return c;
}

/* |a/b - a'/b'| <= (e_a + |a/b| e_b) / (|b| - e_b), and a - fl(a/b) b tells how far the quotient is rounded. */
struct within within_div(struct within a, struct within b)
{
	real quotient = a.near / b.near, rest = rounding(quotient, b.near, a.near), least = fabsl(b.near) - b.e;
	struct within c = closed(a.x / b.x, quotient, least > 0 ? (a.e + fabsl(quotient) * b.e + rest) / least : (real)INFINITY);

	set_limbs(&c, '/', 1, &a, &b);
	return c;
}

/* |r - sqrt(a')| <= |r^2 - a'| / r */
struct within within_sqrt(struct within a)
{
	real root = sqrtl(a.near), e = a.e + rounding(root, root, a.near);
	struct within c = closed(sqrtl(a.x), root, root > 0 ? e / root : sqrtl(e));

	set_limbs(&c, 'r', -1, &a, &a);
	return c;
}

/* The C library's sine and cosine are good to a unit in the last place. */
struct within within_sin(struct within a)
{
	real sine = sinl(a.near);

	return closed(sinl(a.x), sine, a.e + 2 * UNIT * fabsl(sine));
}

struct within within_cos(struct within a)
{
	real cosine = cosl(a.near);

	return a.near == 0 && a.e == 0 ? within_exact(1) : closed(cosl(a.x), cosine, a.e + 2 * UNIT * fabsl(cosine));
}

void angle_sincos(struct within angle, struct within *s, struct within *c)
{
	static const real quarter_sin[4] = {0, 1, 0, -1};
	real turns = roundl(angle.x / RIGHT_ANGLE);

	if (fabsl(angle.x - turns * RIGHT_ANGLE) <= 5e-15L) {
		int quarter = (int)(fmodl(turns, 4) + 4) % 4;
		*s = within_exact(quarter_sin[quarter]);
		*c = within_exact(quarter_sin[(quarter + 1) % 4]);
	} else {
		*s = within_sin(angle);
		*c = within_cos(angle);
	}
}

int within_meets(struct within a, struct within b)
{
	return a.limb == b.limb && a.kind == b.kind && fabsl(a.near - b.near) <= a.e + b.e;
}

double within_error(struct within a)
{
	real e = fabsl(a.x - a.near) + a.e;

	if (isnan(e))
		return (double)INFINITY;
	return e > 0 ? (double)e * (1 + 2 * DBL_EPSILON) + DBL_TRUE_MIN : 0;
}
