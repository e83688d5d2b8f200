#ifndef TESTS_SINCOS_H
#define TESTS_SINCOS_H

#include <stddef.h>

// The functions of templates/sincos/sincos_*.in over arrays: s[i], c[i] = sine and cosine of x[i].
struct sincos {
	const char *name;
	void (*bounded32)(const float *x, float *s, float *c, size_t n);
	void (*accurate32)(const float *x, float *s, float *c, size_t n);
	void (*bounded64)(const double *x, double *s, double *c, size_t n);
	void (*accurate64)(const double *x, double *s, double *c, size_t n);
};

// RNEA_FMA(a, b, c) is a*b + c, rounded twice.
extern const struct sincos sincos_plain;

// RNEA_FMA is fmaf, fma.
extern const struct sincos sincos_fma;

#endif
