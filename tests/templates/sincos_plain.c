#define SINCOS sincos_plain
#define NAME "a*b + c"
#define FMA32(a, b, c) ((a) * (b) + (c))
#define FMA64 FMA32
#include "sincos_text.h"
