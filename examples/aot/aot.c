/* What it takes to hold the arm still, lifted by 0 to 90 degrees: shoulder 2 g cos(q), elbow g/2 cos(q). */
#include "arm_rnea.h"
#include <stdio.h>

int main(void)
{
	const double still[arm_nv] = {0};

	puts("degrees  shoulder     elbow");
	for (int i = 0; i <= 90; i += 15) {
		double q[arm_nq] = {i * 3.14159265358979323846 / 180}, tau[arm_nv];

		arm_rnea(q, still, still, tau);
		printf("%7d %9.4f %9.4f  N m\n", i, tau[0], tau[1]);
	}
	return 0;
}
