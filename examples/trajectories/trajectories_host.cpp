#include "trajectories_solve.cu"
