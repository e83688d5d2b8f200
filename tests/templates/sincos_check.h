#ifndef TESTS_SINCOS_CHECK_H
#define TESTS_SINCOS_CHECK_H

#include "support/rng.h"
#include "sincos.h"
#include <check.h>
#include <float.h>
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { SEED = 20251, SAMPLES = 100000 };

// The bound that the fragments state, in units in the last place of the exact result. Seen at most: 0.792 over all
// floats up to 1e4, 0.813 over all above (with fma 0.782 and 0.787), 0.791 over 8e8 doubles.
static const double bound = 0.85;

static const struct sincos *const variants[2] = {&sincos_plain, &sincos_fma};

struct worst {
	const char *what;
	double units, x;
};

static inline void worst_take(struct worst *w, double units, double x)
{
	if (!(units <= w->units)) {
		w->units = units;
		w->x = x;
	}
}

static inline void worst_check(const struct worst *w, const char *variant)
{
	printf("%s, %s: %.4f units in the last place, at %a\n", w->what, variant, w->units, w->x);
	ck_assert_msg(w->units < bound, "%s, %s: %g units at %a", w->what, variant, w->units, w->x);
}

static inline float float_of(uint32_t bits)
{
	float x;

	memcpy(&x, &bits, sizeof x);
	return x;
}

static inline uint32_t bits_of(float x)
{
	uint32_t bits;

	memcpy(&bits, &x, sizeof bits);
	return bits;
}

static inline double double_of(uint64_t bits)
{
	double x;

	memcpy(&x, &bits, sizeof x);
	return x;
}

// |got - exact| in units in the last place of a float near `exact`, which is normal.
static inline double units32(float got, double exact)
{
	uint64_t bits;

	memcpy(&bits, &exact, sizeof bits);
	return fabs((double)got - exact) / (double_of(bits & 0x7ff0000000000000u) * 0x1p-23);
}

// FNV-1a
static const uint64_t hash_start = 0xcbf29ce484222325u;

static inline uint64_t hash(uint64_t h, const void *data, size_t size)
{
	const unsigned char *p = data;

	for (size_t i = 0; i < size; i++)
		h = (h ^ p[i]) * 0x100000001b3u;
	return h;
}

static inline int sincos_run(Suite *s)
{
	SRunner *r = srunner_create(s);
	int failed;

	srunner_run_all(r, CK_NORMAL);
	failed = srunner_ntests_failed(r);
	srunner_free(r);
	return failed ? EXIT_FAILURE : EXIT_SUCCESS;
}

#endif
