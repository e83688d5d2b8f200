#include "base/within.h"
#include <float.h>
#include <math.h>

/* Half a unit in the last place of 1. */
static const real UNIT = LDBL_EPSILON / 2;

static const real RIGHT_ANGLE = 1.57079632679489661923132169163975144L;

/* What makes up for the rounding of e itself: no operation has more than eight. */
static struct within closed(real x, real near, real e)
{
	if (isnan(e))
		e = (real)INFINITY;
	return (struct within){x, near, e > 0 ? e * (1 + 16 * UNIT) + LDBL_TRUE_MIN : 0};
}

struct within within_exact(real x)
{
	return (struct within){x, x, 0};
}

struct within within_decimal(real x, real near)
{
	return closed(x, near, UNIT * fabsl(near));
}

struct within within_double(double x)
{
	double unit = nextafter(fabs(x), (double)INFINITY) - fabs(x);

	return (struct within){(real)x, (real)x, x == floor(x) ? 0 : (real)unit / 2};
}

struct within within_neg(struct within a)
{
	return (struct within){-a.x, -a.near, a.e};
}

/* The rounding of a sum is a number of the type (Knuth, The Art of Computer Programming, volume 2, theorem 4.2.2B). */
struct within within_add(struct within a, struct within b)
{
	real sum = a.near + b.near, of_b = sum - a.near, of_a = sum - of_b;

	return closed(a.x + b.x, sum, a.e + b.e + fabsl((a.near - of_a) + (b.near - of_b)));
}

struct within within_sub(struct within a, struct within b)
{
	return within_add(a, within_neg(b));
}

/* So is that of a product, unless it underflows. */
static real rounding(real a, real b, real product)
{
	if (a == 0 || b == 0)
		return 0;
	return fabsl(product) < LDBL_MIN / UNIT ? LDBL_MIN : fabsl(fmal(a, b, -product));
}

struct within within_mul(struct within a, struct within b)
{
	real product = a.near * b.near, inherited = fabsl(a.near) * b.e + fabsl(b.near) * a.e + a.e * b.e;

	return closed(a.x * b.x, product, inherited + rounding(a.near, b.near, product));
}

/* |a/b - a'/b'| <= (e_a + |a/b| e_b) / (|b| - e_b), and a - fl(a/b) b tells how far the quotient is rounded. */
struct within within_div(struct within a, struct within b)
{
	real quotient = a.near / b.near, rest = rounding(quotient, b.near, a.near), least = fabsl(b.near) - b.e;

	return closed(a.x / b.x, quotient, least > 0 ? (a.e + fabsl(quotient) * b.e + rest) / least : (real)INFINITY);
}

/* |r - sqrt(a')| <= |r^2 - a'| / r */
struct within within_sqrt(struct within a)
{
	real root = sqrtl(a.near), e = a.e + rounding(root, root, a.near);

	return closed(sqrtl(a.x), root, root > 0 ? e / root : sqrtl(e));
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
	return fabsl(a.near - b.near) <= a.e + b.e;
}

double within_error(struct within a)
{
	real e = fabsl(a.x - a.near) + a.e;

	if (isnan(e))
		return (double)INFINITY;
	return e > 0 ? (double)e * (1 + 2 * DBL_EPSILON) + DBL_TRUE_MIN : 0;
}
