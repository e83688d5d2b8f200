/* The generated torque of the pendulum against tau = (J + m l^2) qdd + m g l sin(q), m = 2, l = 0.5, J = 0.04. */
#include "pendulum_rnea.h"
#include <math.h>
#include <stdio.h>

int main(void)
{
	double worst = 0;

	for (int i = 0; i < 1000; i++) {
		double q = -3 + 0.006 * i, qd = cos(i), qdd = 20 * sin(i), tau;

		pendulum_rnea(&q, &qd, &qdd, &tau);
		worst = fmax(worst, fabs(tau - (0.54 * qdd + 9.81 * sin(q))));
	}
	printf("%d rows of q, worst error %.2g N m\n", pendulum_nq, worst);
	return pendulum_nq == 1 && pendulum_nv == 1 && worst < 1e-14 ? 0 : 1;
}
