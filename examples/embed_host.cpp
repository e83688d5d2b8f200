#include "embed.cu"
