/* bench MODEL FRAME STATES REPEATS: speeds and differences of the generated functions that this program is linked with, beside
   Pinocchio's on MODEL, which Pinocchio wrote. STATES holds COUNT times q. calls.h, which run writes, calls the texts. */
#include "calls.h"
#include "peer.h"
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <vector>

enum { COUNT = 256, NV = BENCH_NV, NQ = BENCH_NQ, LINKS = sizeof frames_of / sizeof *frames_of };

struct bench {
	struct peer *peer;
	std::vector<double> states = std::vector<double>(COUNT * NQ), out = std::vector<double>(12 * LINKS + 6 * NV);
};

static void by_pinocchio(bench &b, int f, const double *q)
{
	static void (*const calls[FUNCTIONS])(struct peer *, const double *) = {peer_poses, peer_frames, peer_jacobian,
		peer_com_jacobian, peer_momentum_matrix};

	calls[f](b.peer, q);
}

static void by_text(bench &b, int f, const double *q)
{
	static void (*const calls[FUNCTIONS])(const double *, double *) = {call_poses, call_frames, call_jacobian,
		call_com_jacobian, call_momentum_matrix};

	calls[f](q, b.out.data());
}

/* Seconds that this thread has run: what it waited for a processor is no part of it. */
static double now()
{
	struct timespec t;

	clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
	return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static double seconds(bench &b, int f, void (*way)(bench &, int, const double *))
{
	enum { TIMES = 20 }; /* a call takes some tens of nanoseconds */
	double began = now();

	for (int i = 0; i < TIMES; i++)
		for (int s = 0; s < COUNT; s++)
			way(b, f, b.states.data() + s * NQ);
	return (now() - began) / TIMES;
}

static double median(std::vector<double> x)
{
	std::sort(x.begin(), x.end());
	return x[x.size() / 2];
}

/* ---- are they the same? ---- */

static double pose_difference(bench &b, int f)
{
	const int count = f == POSES ? (int)(sizeof joints_of / sizeof *joints_of) : LINKS;
	double worst = 0, size = 1;

	for (int k = 0; k < count; k++)
		for (int e = 0; e < 12; e++) {
			double want = peer_pose(b.peer, f, f == POSES ? joints_of[k] : frames_of[k], e / 4, e % 4);

			size = std::max(size, std::fabs(want));
			worst = std::max(worst, std::fabs(b.out[(size_t)(12 * k + e)] - want));
		}
	return worst / size;
}

/* What is not stored has to be zero. */
static double matrix_difference(bench &b, int f)
{
	const struct stored s = matrices[f];
	std::vector<double> full((size_t)(6 * NV), 0.0);
	double worst = 0, size = 0;

	for (size_t k = 0; k < s.count; k++)
		full[(size_t)(s.row[k] * NV + s.col[k])] = b.out[k];
	for (int i = 0; i < (f == COM_JACOBIAN ? 3 : 6); i++)
		for (int j = 0; j < NV; j++) {
			double want = peer_element(b.peer, f, i, j);

			size = std::max(size, std::fabs(want));
			worst = std::max(worst, std::fabs(full[(size_t)(i * NV + j)] - want));
		}
	return worst / size;
}

/* In parts of the largest element of Pinocchio's. */
static double difference(bench &b, int f)
{
	double worst = 0;

	for (int s = 0; s < COUNT; s++) {
		by_pinocchio(b, f, b.states.data() + s * NQ);
		by_text(b, f, b.states.data() + s * NQ);
		worst = std::max(worst, f < JACOBIAN ? pose_difference(b, f) : matrix_difference(b, f));
	}
	return worst;
}

int main(int argc, char **argv)
{
	static const char *const names[] = {"poses", "frames", "jacobian", "com_jacobian", "momentum_matrix"};
	static const char *const peers[] = {"forwardKinematics", "framesForwardKinematics", "computeFrameJacobian",
		"jacobianCenterOfMass", "computeCentroidalMap"};
	int repeats = argc == 5 ? std::atoi(argv[4]) : 0;

	if (repeats < 1)
		return 2;
	bench b;
	b.peer = peer_open(argv[1], std::atoi(argv[2]));
	FILE *file = std::fopen(argv[3], "rb");

	if (!file || std::fread(b.states.data(), sizeof(double), b.states.size(), file) != b.states.size())
		return 2;
	std::fclose(file);
	for (int f = 0; f < FUNCTIONS; f++) {
		std::vector<double> ratios, ours;

		for (int i = -1; i < repeats; i++) {
			double theirs = seconds(b, f, by_pinocchio), own = seconds(b, f, by_text);

			if (i < 0)
				continue;
			ratios.push_back(theirs / own);
			ours.push_back(1e9 * own / COUNT);
		}
		std::printf("%s,%s,%.4g,%.4g,%.2g\n", names[f], peers[f], median(ratios), median(ours), difference(b, f));
	}
	return 0;
}
