/* The pendulum at rest, its motor's rotor added: tau = (J + m l^2 + 0.06) qdd + m g l sin(q), as in kernel.c. */
#include "pendulum_rnea.h"
#include <math.h>
#include <stdio.h>

int main(void)
{
	double worst = 0;

	for (int i = 0; i < 1000; i++) {
		double q = -3 + 0.006 * i, qdd = 20 * sin(i), tau;

		pendulum_rnea(&q, &qdd, &tau);
		worst = fmax(worst, fabs(tau - (0.6 * qdd + 9.81 * sin(q))));
	}
	printf("worst error %.2g N m\n", worst);
	return worst < 1e-14 ? 0 : 1;
}
