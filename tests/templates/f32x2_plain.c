#include <math.h>
#define F32X2 const struct f32x2 f32x2_plain
#define NAME "without fma"
#undef FP_FAST_FMAF
#undef __FMA__
#undef __FP_FAST_FMAF
#undef __ARM_FEATURE_FMA
#undef __aarch64__
#include "f32x2_text.h"
#if RNEAGEN_F32X2_FMA
#error "this file is for the other branch"
#endif
