// Included by sincos_plain.c and sincos_fma.c, each with its own SINCOS, NAME, FMA32 and FMA64.
#include "sincos.h"
#include <math.h>

#define RNEA_INLINE inline
#define RNEA_FMA FMA32
#include "sincos_f32_core.in"
#include "sincos_f32_bounded.in"
#include "sincos_f32_accurate.in"
#undef RNEA_FMA
#define RNEA_FMA FMA64
#include "sincos_f64_core.in"
#include "sincos_f64_bounded.in"
#include "sincos_f64_accurate.in"

#define OVER_ARRAY(name, type, function)                                                                               \
	static void name(const type *restrict x, type *restrict s, type *restrict c, size_t n)                         \
	{                                                                                                              \
		for (size_t i = 0; i < n; i++)                                                                         \
			function(x[i], s + i, c + i);                                                                  \
	}

OVER_ARRAY(bounded32, float, rneagen_sincosf_bounded)
OVER_ARRAY(accurate32, float, rneagen_sincosf_accurate)
OVER_ARRAY(bounded64, double, rneagen_sincos_bounded)
OVER_ARRAY(accurate64, double, rneagen_sincos_accurate)

const struct sincos SINCOS = {NAME, bounded32, accurate32, bounded64, accurate64};
