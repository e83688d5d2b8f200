/* bench MODEL STATES REPEATS: speeds and differences of the generated functions that this program is linked with,
   beside Pinocchio's on MODEL, which Pinocchio wrote, and a plain Cholesky factorisation of the generated M. STATES
   holds COUNT times q, qd, tau. */
#include "all.h" /* the text of that name */
#include "peer.h"
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <vector>

extern "C" {
void qdd_fd(const double *q, const double *qd, const double *tau, double *qdd);
void mass_rnea(const double *q, const double *qd, double *tau_bias, double *M);
void gradients_rnea(const double *q, const double *qd, const double *qdd, double *dq, double *dqd);
}

enum { COUNT = 256, NV = BENCH_NV, NQ = BENCH_NQ };
enum { QDD, DERIVATIVES, FUNCTIONS };
enum { OURS, PINOCCHIO, CHOLESKY, WAYS };

struct bench {
	struct peer *peer;
	std::vector<double> states = std::vector<double>(COUNT * (NQ + 2 * NV));
	bool world = false;
	double qdd[NV], dq[NV * NV], dqd[NV * NV];

	const double *q(int s) const
	{
		return states.data() + s * (NQ + 2 * NV);
	}
};

/* ---- what a user writes ---- */

static void factor(double *L)
{
	for (int j = 0; j < NV; j++) {
		for (int k = 0; k < j; k++)
			for (int i = j; i < NV; i++)
				L[i * NV + j] -= L[i * NV + k] * L[j * NV + k];
		double root = std::sqrt(L[j * NV + j]);

		for (int i = j; i < NV; i++)
			L[i * NV + j] /= root;
	}
}

static void solve(const double *L, double *x, int stride)
{
	for (int i = 0; i < NV; i++) {
		for (int k = 0; k < i; k++)
			x[i * stride] -= L[i * NV + k] * x[k * stride];
		x[i * stride] /= L[i * NV + i];
	}
	for (int i = NV - 1; i >= 0; i--) {
		for (int k = i + 1; k < NV; k++)
			x[i * stride] -= L[k * NV + i] * x[k * stride];
		x[i * stride] /= L[i * NV + i];
	}
}

static void by_cholesky(bench &b, int f, const double *q)
{
	static double M[NV * NV], bias[NV];

	mass_rnea(q, q + NQ, bias, M);
	factor(M);
	for (int i = 0; i < NV; i++)
		b.qdd[i] = q[NQ + NV + i] - bias[i];
	solve(M, b.qdd, 1);
	if (f == QDD)
		return;
	gradients_rnea(q, q + NQ, b.qdd, b.dq, b.dqd);
	for (int j = 0; j < NV; j++) {
		for (int i = 0; i < NV; i++) {
			b.dq[i * NV + j] = -b.dq[i * NV + j];
			b.dqd[i * NV + j] = -b.dqd[i * NV + j];
		}
		solve(M, b.dq + j, NV);
		solve(M, b.dqd + j, NV);
	}
}

/* ---- calls ---- */

static void by_pinocchio(bench &b, int f, const double *q)
{
	if (f == DERIVATIVES)
		peer_derivatives(b.peer, q);
	else
		peer_aba(b.peer, q, b.world);
}

static void call(bench &b, int f, int way, int s)
{
	const double *q = b.q(s), *qd = q + NQ, *tau = qd + NV;

	if (way == PINOCCHIO)
		by_pinocchio(b, f, q);
	else if (way == CHOLESKY)
		by_cholesky(b, f, q);
	else if (f == QDD)
		qdd_fd(q, qd, tau, b.qdd);
	else
		all_fd(q, qd, tau, b.qdd, b.dq, b.dqd);
}

/* Seconds that this thread has run: what it waited for a processor is no part of it. */
static double now()
{
	struct timespec t;

	clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
	return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static double seconds(bench &b, int f, int way)
{
	double began = now();

	for (int s = 0; s < COUNT; s++)
		call(b, f, way, s);
	return now() - began;
}

/* aba has two ways; the one that takes less time on this robot is measured. */
static void choose_convention(bench &b)
{
	double least[2] = {1e9, 1e9};

	for (int i = 0; i < 10; i++) {
		b.world = i % 2;
		least[i % 2] = std::min(least[i % 2], seconds(b, QDD, PINOCCHIO));
	}
	b.world = least[1] < least[0];
}

static double median(std::vector<double> x)
{
	std::sort(x.begin(), x.end());
	return x[x.size() / 2];
}

/* ---- are they the same? ---- */

static double apart(const double *x, const double *y, int n)
{
	double off = 0, size = 0;

	for (int i = 0; i < n; i++) {
		off = std::max(off, std::fabs(x[i] - y[i]));
		size = std::max(size, std::fabs(y[i]));
	}
	return off / size;
}

/* From the elements that are stored to the whole matrix, row by row. */
static void unpack(double *matrix, const int *row, const int *col, size_t count)
{
	static double full[NV * NV];

	std::fill(full, full + NV * NV, 0.0);
	for (size_t k = 0; k < count; k++)
		full[row[k] * NV + col[k]] = matrix[k];
	std::copy(full, full + NV * NV, matrix);
}

/* Of this way's results, in parts of the largest element of Pinocchio's. */
static double difference(bench &b, int f, int way)
{
	static double wanted[NV * NV];
	double worst = 0;

	for (int s = 0; s < COUNT; s++) {
		by_pinocchio(b, f, b.q(s));
		call(b, f, way, s);
		if (way == OURS && f == DERIVATIVES) {
			unpack(b.dq, all_dqdd_dq_row, all_dqdd_dq_col, sizeof all_dqdd_dq_row / sizeof(int));
			unpack(b.dqd, all_dqdd_dqd_row, all_dqdd_dqd_col, sizeof all_dqdd_dqd_row / sizeof(int));
		}
		for (int i = 0; i < NV; i++)
			wanted[i] = peer_qdd(b.peer, i);
		worst = std::max(worst, apart(b.qdd, wanted, NV));
		for (int m = 0; m < 2 && f == DERIVATIVES; m++) {
			for (int i = 0; i < NV * NV; i++)
				wanted[i] = peer_by(b.peer, m, i / NV, i % NV);
			worst = std::max(worst, apart(m ? b.dqd : b.dq, wanted, NV * NV));
		}
	}
	return worst;
}

int main(int argc, char **argv)
{
	int repeats = argc == 4 ? std::atoi(argv[3]) : 0;

	if (repeats < 1)
		return 2;
	bench b;
	b.peer = peer_open(argv[1]);
	FILE *file = std::fopen(argv[2], "rb");

	if (!file || std::fread(b.states.data(), sizeof(double), b.states.size(), file) != b.states.size())
		return 2;
	std::fclose(file);
	choose_convention(b);
	for (int f = 0; f < FUNCTIONS; f++) {
		std::vector<double> peer, cholesky;

		for (int i = -1; i < repeats; i++) {
			double t[WAYS];

			for (int way = 0; way < WAYS; way++)
				t[way] = seconds(b, f, way);
			if (i < 0)
				continue;
			peer.push_back(t[PINOCCHIO] / t[OURS]);
			cholesky.push_back(t[PINOCCHIO] / t[CHOLESKY]);
		}
		std::printf("%s,%s,%.4g,%.4g,%.2g,%.2g\n", f ? "derivatives" : "qdd",
			f ? "computeABADerivatives" : b.world ? "aba WORLD" : "aba LOCAL", median(peer), median(cholesky),
			difference(b, f, OURS), difference(b, f, CHOLESKY));
	}
	return 0;
}
