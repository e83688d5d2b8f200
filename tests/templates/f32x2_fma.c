#include <math.h>
#ifndef FP_FAST_FMAF
#define FP_FAST_FMAF
#endif
#define F32X2 const struct f32x2 f32x2_fma
#define NAME "with fmaf"
#include "f32x2_text.h"
