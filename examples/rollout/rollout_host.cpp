#include "rollout.cu"
