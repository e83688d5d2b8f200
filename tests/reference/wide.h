#ifndef TESTS_WIDE_H
#define TESTS_WIDE_H

// The scalar type of the reference, and its functions: long double, or __float128 with -DREFERENCE_QUAD (then link
// quadmath).
#ifdef REFERENCE_QUAD
#include <quadmath.h>

typedef __float128 wide;
#define WIDE_C(x) x##Q
#define wide_sin sinq
#define wide_cos cosq
#define wide_sqrt sqrtq
#define wide_abs fabsq
#define wide_round rintq
#define wide_read strtoflt128
#else
#include <math.h>
#include <stdlib.h>

typedef long double wide;
#define WIDE_C(x) x##L
#define wide_sin sinl
#define wide_cos cosl
#define wide_sqrt sqrtl
#define wide_abs fabsl
#define wide_round rintl
#define wide_read strtold
#endif

#define WIDE_PI WIDE_C(3.14159265358979323846264338327950288)

#endif
