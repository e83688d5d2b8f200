#define F32X2 static const struct f32x2 contracted
#define NAME "with fma, contracted"
#include <stddef.h>
#if defined __FMA__
#include "f32x2_text.h"

const struct f32x2 *f32x2_contracted(void)
{
	return __builtin_cpu_supports("fma") && __builtin_cpu_supports("avx2") ? &contracted : NULL;
}
#else
#include "f32x2.h"

const struct f32x2 *f32x2_contracted(void)
{
	return NULL;
}
#endif
