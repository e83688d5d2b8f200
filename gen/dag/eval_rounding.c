/* A number x that is rounded to nearest is off by half a unit in the last place: by u ufp(x), where ufp(x) is the power of two at
   or below |x| (Rump, Ogita, Oishi, Accurate floating-point summation, part I, SIAM J. Sci. Comput. 31, 2008). That is between
   half of u |x| and all of it, 0.72 of it on average. */
#include "dag/eval_rounding.h"
#include "dag/eval_pairs.h"
#include <float.h>
#include <math.h>
#include <stdint.h>
#include <string.h>

double rounding_place(double x)
{
	uint64_t bits;

	memcpy(&bits, &x, sizeof bits);
	bits &= 0x7ff0000000000000u;
	memcpy(&x, &bits, sizeof x);
	return x;
}

/* No value of the text is larger; what a double leaves of x counts too. */
static double most_of(struct known x)
{
	return fabs(x.x) * (1 + DBL_EPSILON) + x.e;
}

static int is_of_pairs(const struct eval_model *m)
{
	return m->terms > 0;
}

double rounding_of_result(const struct eval_model *m, double unit, struct known x)
{
	double most = most_of(x);

	return unit * (is_of_pairs(m) ? most : rounding_place(most)) + m->own * most + m->tiny;
}

double rounding_of_sum(const struct eval_model *m, struct known a, struct known b, struct known x)
{
	if (!is_of_pairs(m))
		return rounding_of_result(m, m->add, x);
	return fmin(m->terms * (most_of(a) + most_of(b)), pairs_sum(a, b)) + m->own * most_of(x) + m->tiny;
}

/* A factor that is a power of two leaves all bits. */
static int is_scale(struct known a)
{
	return a.e == 0 && fabs(a.x) == rounding_place(a.x);
}

double rounding_of_product(const struct eval_model *m, struct known a, struct known b, struct known x, double *left_out)
{
	double close;

	*left_out = 0;
	if (is_scale(a) || is_scale(b))
		return m->own * most_of(x) + m->tiny;
	if (!is_of_pairs(m))
		return rounding_of_result(m, m->mul, x);
	close = pairs_product(m->products, a, b, x, left_out);
	if (!(close + fabs(*left_out) < m->mul * most_of(x))) {
		*left_out = 0;
		close = m->mul * most_of(x);
	}
	return close + m->own * most_of(x) + m->tiny;
}

double rounding_of_input(const struct eval_model *m, double x, double *left_out)
{
	*left_out = m->input > 0 ? x - pairs_head(x) - (double)(float)(x - pairs_head(x)) : 0;
	return m->input > 0 ? m->tiny : 0;
}

double rounding_of_turn(const struct eval_model *m, int is_sine, struct known angle, double value, double *left_out)
{
	double error, close;

	*left_out = 0;

	if (!(fabs(angle.x) + angle.e <= m->angle))
		return (double)INFINITY;
	error = rounding_of_result(m, m->sincos, (struct known){value, angle.e}) + (is_sine ? m->sine : m->cosine);
	if (!is_of_pairs(m) || angle.e > 0)
		return error;
	close = pairs_turn(m, is_sine, angle.x, value, left_out);
	if (close + fabs(*left_out) < error)
		return close;
	*left_out = 0;
	return error;
}

double size_of_product(const struct eval_model *m, struct known a, struct known b)
{
	return m->fused ? 0 : (fabs(a.x) + a.e) * (fabs(b.x) + b.e) * (1 + m->mul) * (1 + 0x1p-40);
}

/* |a/b - a'/b'| <= (e_a + |a/b| e_b) / (|b| - e_b) */
static double error_of_quotient(double value, double b, double of_a, double of_b)
{
	return fabs(b) > of_b ? (of_a + fabs(value) * of_b) / (fabs(b) - of_b) : (double)INFINITY;
}

/* What that leaves of (e_a + |a/b| e_b) / |b|, which is linear in the errors. */
double rest_of_quotient(double value, double b, double of_a, double of_b)
{
	return of_b > 0 ? error_of_quotient(value, b, of_a, of_b) * of_b / fabs(b) : 0;
}

/* The same of |sqrt(a) - sqrt(a')| beside e_a / (2 sqrt(a)): e_a^2 / (2 sqrt(a) (sqrt(a) + sqrt(a - e_a))^2). The text's a' may
   have no root. */
double rest_of_root(double value, double a, double of_a)
{
	double both = of_a <= a ? value + sqrt(a - of_a) : 0;

	return of_a > 0 ? of_a * of_a / (2 * value * both * both) : 0;
}
