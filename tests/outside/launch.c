/* A kernel that nvcc compiled, called from C: an empty batch needs no device and is no error. */
#include "pendulum_rnea.h"
#include <stdio.h>

int main(void)
{
#if defined POSE
	int error = pendulum_kin_launch(NULL, NULL, 0, NULL);
#elif defined ACCELERATION
	int error = pendulum_fd_launch(NULL, NULL, NULL, NULL, 0, NULL);
#else
	int error = pendulum_rnea_launch(NULL, NULL, NULL, NULL, 0, NULL);
#endif

	printf("launch of nothing: %d\n%s", error, pendulum_info);
	return error || pendulum_nq != 1 || pendulum_nv != 1;
}
