#include "ik.cu"
