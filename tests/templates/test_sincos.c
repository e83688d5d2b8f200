// templates/sincos/sincos_f32_*.in against double precision, with both forms of RNEA_FMA. Every positive float of the bounded
// domain is tried, except that a stride is taken below 2^-13, where sin x = x and cos x = 1; negative ones by symmetry.
#include "sincos_check.h"
#include "support/exhaustive.h"

enum { BLOCK = 1024 };
#define STRIDE (exhaustive() ? SINCOS_STRIDE : 13 * SINCOS_STRIDE) /* the short form takes every 13th float of the long */
#define TINY_STRIDE (61 * STRIDE)
#define LARGE_STRIDE (31 * STRIDE)

typedef void array32(const float *x, float *s, float *c, size_t n);

static void compare32(array32 *f, const float *x, const double *sines, const double *cosines, size_t n, struct worst *w)
{
	static float s[BLOCK], c[BLOCK];

	f(x, s, c, n);
	for (size_t i = 0; i < n; i++) {
		worst_take(w, units32(s[i], sines[i]), (double)x[i]);
		worst_take(w, units32(c[i], cosines[i]), (double)x[i]);
	}
}

// The floats first, first + stride ... up to last (as bits), through f[v] of each variant v.
static void sweep32(struct worst w[2], array32 *const f[2], uint32_t first, uint32_t last, uint32_t stride)
{
	static float x[BLOCK];
	static double s[BLOCK], c[BLOCK];
	size_t n = 0;

	for (uint64_t bits = first; bits <= last; bits += stride) {
		x[n] = float_of((uint32_t)bits);
		s[n] = sin((double)x[n]);
		c[n] = cos((double)x[n]);
		if (++n < BLOCK && bits + stride <= last)
			continue;
		for (int v = 0; v < 2; v++)
			compare32(f[v], x, s, c, n, &w[v]);
		n = 0;
	}
	for (int v = 0; v < 2; v++)
		worst_check(&w[v], variants[v]->name);
}

START_TEST(bounded_domain)
{
	struct worst w[2] = {{"f32 bounded", 0, 0}, {"f32 bounded", 0, 0}};
	array32 *const f[2] = {variants[0]->bounded32, variants[1]->bounded32};

	sweep32(w, f, bits_of(0x1p-13f), bits_of(1e4f), (uint32_t)STRIDE);
}
END_TEST

START_TEST(bounded_tiny)
{
	struct rng r = rng_seed(SEED);
	uint32_t bits = (uint32_t)rng_below(&r, TINY_STRIDE);
	long mistakes = 0;

	for (; bits < bits_of(0x1p-13f); bits += (uint32_t)TINY_STRIDE) {
		float x = float_of(bits), s, c;

		for (int v = 0; v < 2; v++) {
			variants[v]->bounded32(&x, &s, &c, 1);
			mistakes += !(s == x && c == 1);
		}
	}
	ck_assert_int_eq(mistakes, 0);
}
END_TEST

START_TEST(accurate_large)
{
	struct rng r = rng_seed(SEED);
	struct worst w[2] = {{"f32 accurate above 1e4", 0, 0}, {"f32 accurate above 1e4", 0, 0}};
	array32 *const f[2] = {variants[0]->accurate32, variants[1]->accurate32};
	uint32_t first = bits_of(1e4f) + 1 + (uint32_t)rng_below(&r, LARGE_STRIDE);

	sweep32(w, f, first, bits_of(FLT_MAX), (uint32_t)LARGE_STRIDE);
}
END_TEST

// Inside the domain the two modes give the same bits, and -x changes the sign of the sine alone, also that of zero.
static int is_symmetric(const struct sincos *v, float x)
{
	float minus = -x, s[4], c[4];

	v->accurate32(&x, &s[0], &c[0], 1);
	v->accurate32(&minus, &s[1], &c[1], 1);
	if (bits_of(s[1]) != (bits_of(s[0]) ^ 0x80000000u) || bits_of(c[1]) != bits_of(c[0]))
		return 0;
	if (fabsf(x) > 1e4f)
		return 1;
	v->bounded32(&x, &s[2], &c[2], 1);
	v->bounded32(&minus, &s[3], &c[3], 1);
	return memcmp(s, s + 2, 2 * sizeof *s) == 0 && memcmp(c, c + 2, 2 * sizeof *c) == 0;
}

START_TEST(symmetry)
{
	const float special[] = {0.0f, 1e4f, 0x1p-149f, FLT_MIN, FLT_MAX};
	const size_t specials = sizeof special / sizeof *special;
	struct rng r = rng_seed(SEED);
	long mistakes = 0;

	for (size_t i = 0; i < 30 * SAMPLES; i++) {
		float x = i < specials ? special[i] : float_of((uint32_t)rng_next(&r));

		for (int v = 0; v < 2 && isfinite(x); v++)
			mistakes += !is_symmetric(variants[v], x);
	}
	ck_assert_int_eq(mistakes, 0);
}
END_TEST

START_TEST(outside_is_nan)
{
	const float outside[] = {nextafterf(1e4f, INFINITY), 1e5f, FLT_MAX, INFINITY, NAN, float_of(0x7f800001u)};

	for (size_t i = 0; i < 2 * sizeof outside / sizeof *outside; i++) {
		float x = i & 1 ? -outside[i / 2] : outside[i / 2], s, c;

		for (int v = 0; v < 2; v++) {
			variants[v]->bounded32(&x, &s, &c, 1);
			ck_assert(isnan(s) && isnan(c));
			variants[v]->accurate32(&x, &s, &c, 1);
			ck_assert(isfinite(x) ? isfinite(s) && isfinite(c) : isnan(s) && isnan(c));
		}
	}
}
END_TEST

// With a true fma every machine gives these bits (hashed on a little-endian one).
START_TEST(same_bits)
{
	struct rng r = rng_seed(SEED);
	uint64_t h = hash_start;

	for (int i = 0; i < SAMPLES; i++) {
		float x = float_of((uint32_t)rng_next(&r)), y[2];

		sincos_fma.accurate32(&x, &y[0], &y[1], 1);
		h = isfinite(x) ? hash(h, y, sizeof y) : h;
	}
	ck_assert_uint_eq(h, 0x4aa72758323c65bau);
}
END_TEST

int main(void)
{
	Suite *s = suite_create("sincos");
	TCase *t = tcase_create("f32");

	printf("seed %d, strides %d in the domain, %d below 2^-13, %d above 1e4\n", SEED, STRIDE, TINY_STRIDE,
		LARGE_STRIDE);
	suite_add_tcase(s, t);
	tcase_set_timeout(t, 900);
	tcase_add_test(t, bounded_domain);
	tcase_add_test(t, bounded_tiny);
	tcase_add_test(t, accurate_large);
	tcase_add_test(t, symmetry);
	tcase_add_test(t, outside_is_nan);
	tcase_add_test(t, same_bits);
	return sincos_run(s);
}
