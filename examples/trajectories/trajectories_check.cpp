/* What trajectories.cpp works on, and what its results are held against. */
#include "trajectories.h"
#include "iiwa14_exact_rnea.h"
#include <algorithm>
#include <cmath>
#include <random>

/* A function of s with its first and second derivative. */
struct jet {
	double value[3];
};

static jet operator*(const jet &a, const jet &b)
{
	const double *x = a.value, *y = b.value;

	return {{x[0] * y[0], x[1] * y[0] + x[0] * y[1], x[2] * y[0] + 2 * x[1] * y[1] + x[0] * y[2]}};
}

/* x a + y b */
static jet sum(double x, const jet &a, double y, const jet &b)
{
	jet c;

	for (int order = 0; order < 3; order++)
		c.value[order] = x * a.value[order] + y * b.value[order];
	return c;
}

static double node_at(int node)
{
	return (node + 0.5) / NODES;
}

/* T_0 = 1, T_1 = x, T_k+1 = 2 x T_k - T_k-1 */
tables<double> make_tables()
{
	tables<double> t = {{}, {{ANGLES}, {SPEEDS}}, {}};
	const double efforts[] = {EFFORTS};
	const jet one = {{1, 0, 0}};

	for (int i = 0; i < N; i++)
		t.per_effort[i] = 1 / efforts[i];
	for (int node = 0; node < NODES; node++) {
		const jet s = {{node_at(node), 1, 0}}, x = sum(2, s, -1, one), bump = sum(4, s, -4, s * s);
		jet now = one, before = x;

		for (int k = 0; k <= K; k++) {
			const jet f =
				k < K ? bump * bump * bump * now : s * s * s * sum(10, one, 1, sum(-15, s, 6, s * s));
			const jet next = sum(2, x * now, -1, before);

			for (int order = 0; order < 3; order++)
				t.shape[order][node][k] = f.value[order];
			before = now;
			now = next;
		}
	}
	return t;
}

/* sin^6(angle) cos(k angle), cos(angle) = 2 s - 1; the line as the integral of 30 s^2 (1 - s)^2 */
static double plain_shape(double s, int k)
{
	const double angle = std::acos(2 * s - 1);

	return k < K ? std::pow(std::sin(angle), 6) * std::cos(k * angle)
		     : 30 * (std::pow(s, 3) / 3 - std::pow(s, 4) / 2 + std::pow(s, 5) / 5);
}

double tables_error(const tables<double> &t)
{
	const double h = 1e-4;
	double worst = 0;

	for (int node = 0; node < NODES; node++)
		for (int k = 0; k <= K; k++) {
			const double s = node_at(node), at = plain_shape(s, k), after = plain_shape(s + h, k),
				     before = plain_shape(s - h, k);
			const double exact[] = {at, (after - before) / (2 * h), (after - 2 * at + before) / (h * h)};

			for (int order = 0; order < 3; order++)
				worst = std::fmax(worst, std::fabs(exact[order] - t.shape[order][node][k]));
		}
	return worst;
}

/* The line's largest speed is 15/8 of its mean. */
std::vector<trajectory<double>> random_trajectories(size_t count)
{
	const double angles[] = {ANGLES}, speeds[] = {SPEEDS};
	std::mt19937 random(1);
	std::uniform_real_distribution<double> unit(-0.9, 0.9);
	std::vector<trajectory<double>> all(count);

	for (trajectory<double> &x : all) {
		x.seconds = 1;
		x.cost = (double)INFINITY;
		x.damping = 1e-2;
		for (int i = 0; i < N; i++) {
			x.from[i] = angles[i] * unit(random);
			x.to[i] = angles[i] * unit(random);
			x.seconds = std::fmax(x.seconds, 15. / 8 / 0.8 * std::fabs(x.to[i] - x.from[i]) / speeds[i]);
		}
	}
	return all;
}

void bend(std::vector<trajectory<double>> &all)
{
	std::mt19937 random(2);
	std::uniform_real_distribution<double> unit(-0.5, 0.5);

	for (trajectory<double> &x : all)
		for (double &c : x.trial)
			c = (double)(float)unit(random);
}

/* The weighted torques and what is beyond limits at one node. */
static void residuals(const tables<double> &t, const trajectory<double> &x, const double c[C], int node, double r[3][N])
{
	const double weight = std::sqrt(x.seconds / NODES);
	double state[3][N], tau[N];

	for (int order = 0; order < 3; order++)
		for (int i = 0; i < N; i++) {
			double at = (x.to[i] - x.from[i]) * t.shape[order][node][K];

			for (int k = 0; k < K; k++)
				at += c[i * K + k] * t.shape[order][node][k];
			state[order][i] = at / std::pow(x.seconds, order) + (order ? 0 : x.from[i]);
		}
	iiwa14_exact_rnea(state[0], state[1], state[2], tau);
	for (int i = 0; i < N; i++) {
		r[2][i] = weight * tau[i] * t.per_effort[i];
		for (int order = 0; order < 2; order++)
			r[order][i] = PUSH * weight *
				      std::copysign(std::fmax(std::fabs(state[order][i]) - t.limit[order][i], 0),
					      state[order][i]);
	}
}

double exact_cost(const tables<double> &t, const trajectory<double> &x, const double c[C], double most[3])
{
	const double weight = std::sqrt(x.seconds / NODES), unit[] = {PUSH * weight, PUSH * weight, weight};
	double cost = 0, r[3][N];

	for (int node = 0; node < NODES; node++) {
		residuals(t, x, c, node, r);
		for (int part = 0; part < 3; part++)
			for (int i = 0; i < N; i++) {
				cost += most && part < 2 ? 0 : r[part][i] * r[part][i];
				if (most)
					most[part] = std::fmax(most[part], std::fabs(r[part][i]) / unit[part]);
			}
	}
	return cost;
}

/* J'J by central differences of r. */
static void plain_matrix(const tables<double> &t, const trajectory<double> &x, double matrix[PAIRS])
{
	const double h = 1e-5;
	double c[C], r[2][3][N], j[C][3 * N];

	std::fill(matrix, matrix + PAIRS, 0.);
	std::copy(x.c, x.c + C, c);
	for (int node = 0; node < NODES; node++) {
		for (int a = 0; a < C; a++) {
			for (int side = 0; side < 2; side++) {
				c[a] = x.c[a] + (side ? h : -h);
				residuals(t, x, c, node, r[side]);
			}
			c[a] = x.c[a];
			for (int e = 0; e < 3 * N; e++)
				j[a][e] = (r[1][e / N][e % N] - r[0][e / N][e % N]) / (2 * h);
		}
		for (int a = 0; a < C; a++)
			for (int b = 0; b <= a; b++)
				for (int e = 0; e < 3 * N; e++)
					matrix[PAIR(a, b)] += j[a][e] * j[b][e];
	}
}

difference pairs_error(const tables<double> &t, const trajectory<double> &x)
{
	const double h = 1e-5, cost = exact_cost(t, x, x.c, NULL);
	difference off = {std::fabs(x.cost / cost - 1), 0, 0};
	double c[C], matrix[PAIRS];

	plain_matrix(t, x, matrix);
	std::copy(x.c, x.c + C, c);
	for (int a = 0; a < C; a++) {
		const double length = std::sqrt(matrix[PAIR(a, a)]);
		double gradient = 0;

		for (int b = 0; b <= a; b++)
			off.matrix = std::fmax(off.matrix, std::fabs(matrix[PAIR(a, b)] - x.pairs[PAIR(a, b)]) /
								   (length * std::sqrt(matrix[PAIR(b, b)])));
		for (int side = 0; side < 2; side++) {
			c[a] = x.c[a] + (side ? h : -h);
			gradient += (side ? 1 : -1) / (2 * h) * exact_cost(t, x, c, NULL);
		}
		c[a] = x.c[a];
		off.gradient = std::fmax(
			off.gradient, std::fabs(gradient - 2 * x.pairs[PAIR(C, a)]) / (2 * length * std::sqrt(cost)));
	}
	return off;
}
