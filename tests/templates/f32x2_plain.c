#define F32X2 const struct f32x2 f32x2_plain
#define NAME "without fma"
#undef __FMA__
#undef __FP_FAST_FMAF
#include "f32x2_text.h"
#if RNEAGEN_F32X2_FMA
#error "this file is for the other branch"
#endif
