#define SINCOS sincos_fma
#define NAME "fma"
#define FMA32 fmaf
#define FMA64 fma
#include "sincos_text.h"
