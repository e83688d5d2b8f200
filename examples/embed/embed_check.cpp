/* What embed.cu works on, and what its results are held against. */
#include "embed.h"
#include "iiwa14_exact_rnea.h"
#include <cmath>
#include <random>

/* q = a + (b - a) (3 x^2 - 2 x^3), x = t / SECONDS */
std::vector<float> random_splines(size_t count)
{
	std::mt19937 random(1);
	std::uniform_real_distribution<float> unit(-1, 1);
	std::vector<float> coefficients(ROWS * count);

	for (size_t k = 0; k < count; k++) {
		const float wild = 1 + unit(random);

		for (size_t j = 0; j < N; j++) {
			float from = 0;

			for (size_t s = 0; s < SEGMENTS; s++) {
				const float to = wild * unit(random), way = to - from;
				const float c[] = {from, 0, 3 * way / (SECONDS * SECONDS),
					-2 * way / (SECONDS * SECONDS * SECONDS)};

				for (size_t i = 0; i < 4; i++)
					coefficients[((s * N + j) * 4 + i) * count + k] = c[i];
				from = to;
			}
		}
	}
	return coefficients;
}

/* The cost of trajectory k; *nearest is how near a torque came to its limit, as a part of it. */
static double exact_cost(const std::vector<float> &coefficients, size_t k, size_t count, double *nearest)
{
	const double effort[N] = {EFFORTS}, dt = (double)DT;
	double cost = 0, q[N], qd[N], qdd[N], tau[N];

	*nearest = 1;
	for (size_t row = 0; row < SEGMENTS * STEPS; row++) {
		const double t = ((double)(row % STEPS) + 0.5) * dt;

		for (size_t j = 0; j < N; j++) {
			const float *c = &coefficients[(row / STEPS * N + j) * 4 * count + k];
			const double c1 = (double)c[count], c2 = (double)c[2 * count], c3 = (double)c[3 * count];

			q[j] = ((c3 * t + c2) * t + c1) * t + (double)c[0];
			qd[j] = (3 * c3 * t + 2 * c2) * t + c1;
			qdd[j] = 6 * c3 * t + 2 * c2;
		}
		iiwa14_exact_rnea(q, qd, qdd, tau);
		for (size_t j = 0; j < N; j++) {
			*nearest = std::fmin(*nearest, std::fabs(1 - std::fabs(tau[j]) / effort[j]));
			cost += std::fabs(tau[j]) <= effort[j] ? tau[j] * tau[j] * dt : (double)INFINITY;
		}
	}
	return cost;
}

/* A torque within 1e-4 of its limit may fall on either side of it in single precision. */
double worst_error(const std::vector<float> &coefficients, const std::vector<float> &costs)
{
	double worst = 0, nearest;

	for (size_t k = 0; k < costs.size(); k++) {
		const double cost = (double)costs[k], exact = exact_cost(coefficients, k, costs.size(), &nearest);

		if (nearest > 1e-4 && std::isfinite(cost) != std::isfinite(exact))
			return (double)INFINITY;
		if (std::isfinite(cost) && std::isfinite(exact))
			worst = std::fmax(worst, std::fabs(cost - exact) / exact);
	}
	return worst;
}
