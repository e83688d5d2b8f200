/* A kernel that nvcc compiled, called from C: an empty batch needs no device and is no error. */
#include "pendulum_rnea.h"
#include <stdio.h>

int main(void)
{
	int error = pendulum_rnea_launch(NULL, NULL, NULL, NULL, 0, NULL);

	printf("launch of nothing: %d\n%s", error, pendulum_info);
	return error || pendulum_nq != 1 || pendulum_nv != 1;
}
