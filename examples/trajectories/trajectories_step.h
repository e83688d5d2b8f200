#ifndef TRAJECTORIES_STEP_H
#define TRAJECTORIES_STEP_H
/* The two kernels of trajectories.cpp as functions for both the GPU and the host. The generated kernel runs between
   them:

     sample_write   q, qd, qdd at one node of what a trajectory tries                 one thread a node
     (generated)    tau, dtau_dq, dtau_dqd, M there                                   one thread a node
     step           [J r]'[J r], then whether to keep it and what to try next         one block a trajectory

   The step is Levenberg's and Marquardt's: (J'J + damping) d = -J'r, solved by Cholesky; the damping falls
   after a success and rises after a failure, for each trajectory by itself. */

#include "trajectories.h"
#include <math.h>
#if !defined __CUDACC__
#define __host__
#define __device__
#endif

enum array { ARRAY_Q, ARRAY_QD, ARRAY_QDD, ARRAY_TAU, ARRAY_DQ, ARRAY_DQD, ARRAY_M, ARRAYS };
constexpr int MATRIX = N * N, LOWER = N * (N + 1) / 2;
constexpr size_t HEIGHTS[ARRAYS] = {N, N, N, N, MATRIX, MATRIX, LOWER};

/* A batch in the memory of the GPU or of the host; arrays are [row][trajectory][node]. */
template <class Real> struct batch {
	size_t count;
	const tables<Real> *table;
	trajectory<Real> *all;
	Real *array[ARRAYS];
	Real *history; /* [round][trajectory]: the cost of the best so far */
};

/* The threads of a block, which share a trajectory; on the host one alone. */
template <int THREADS> struct team {
	static constexpr int threads = THREADS;
	int thread;

	__host__ __device__ void wait() const
	{
#if defined __CUDA_ARCH__
		if (THREADS > 1)
			__syncthreads();
#endif
	}
};

/* The triangle of pairs in tiles of two by two, a tile for each thread. */
constexpr int TILE = 2, TILE_SIDE = (SIDE + TILE - 1) / TILE, TILES = TILE_SIDE * (TILE_SIDE + 1) / 2;
constexpr int WIDTH = TILE_SIDE * TILE;

/* Rows that the step reads, one after the other. */
enum row {
	ROW_Q,
	ROW_QD = ROW_Q + N,
	ROW_TAU = ROW_QD + N,
	ROW_DQ = ROW_TAU + N,
	ROW_DQD = ROW_DQ + MATRIX,
	ROW_M = ROW_DQD + MATRIX,
	ROWS = ROW_M + LOWER
};

/* What a team shares, 43 KiB in double precision. A row has one number more than there are nodes, so that a column's
   numbers are in different banks. */
template <class Real> struct scratch {
	Real row[ROWS][NODES + 1];
	Real j[N][WIDTH];  /* the torques' rows of [J r] at one node, and zeros */
	Real beyond[2][N]; /* the limits' part of r there */
	Real pairs[PAIRS], d[C];
	int kept;
};

template <class Real> __host__ __device__ void sample_write(const batch<Real> &b, size_t sample)
{
	const trajectory<Real> &x = b.all[sample / NODES];
	const int node = (int)(sample % NODES);
	const size_t samples = b.count * NODES;
	const Real rate = 1 / x.seconds;

	for (int i = 0; i < N; i++) {
		Real scale = 1;

		for (int order = 0; order < 3; order++) {
			const Real *shape = b.table->shape[order][node];
			Real sum = (x.to[i] - x.from[i]) * shape[K];

			for (int k = 0; k < K; k++)
				sum += x.trial[i * K + k] * shape[k];
			b.array[ARRAY_Q + order][(size_t)i * samples + sample] = sum * scale + (order ? 0 : x.from[i]);
			scale *= rate;
		}
	}
}

/* Copy a trajectory's rows; neighbouring threads take neighbouring nodes. */
template <class Real, class Team>
__host__ __device__ void rows_read(const batch<Real> &b, size_t k, scratch<Real> &s, const Team &t)
{
	const int arrays[] = {ARRAY_Q, ARRAY_QD, ARRAY_TAU, ARRAY_DQ, ARRAY_DQD, ARRAY_M};
	const int ends[] = {ROW_QD, ROW_TAU, ROW_DQ, ROW_DQD, ROW_M, ROWS};
	const size_t samples = b.count * NODES;
	int begin = 0;

	for (int part = 0; part < 6; part++) {
		const Real *from = b.array[arrays[part]] + k * NODES;

		for (int e = t.thread; e < (ends[part] - begin) * NODES; e += t.threads)
			s.row[begin + e / NODES][e % NODES] = from[(size_t)(e / NODES) * samples + (size_t)(e % NODES)];
		begin = ends[part];
	}
}

/* The element in row i and column a of the torques' [J r]: dtau_dq shape + dtau_dqd shape' / T + M shape'' / T^2. */
template <class Real>
__host__ __device__ Real torque_element(
	const tables<Real> &t, const scratch<Real> &s, Real rate, int node, int i, int a)
{
	const int other = a / K, k = a % K;

	if (a >= C)
		return a == C ? s.row[ROW_TAU + i][node] : 0;
	return s.row[ROW_DQ + i * N + other][node] * t.shape[0][node][k] +
	       rate * s.row[ROW_DQD + i * N + other][node] * t.shape[1][node][k] +
	       rate * rate * s.row[ROW_M + (i > other ? PAIR(i, other) : PAIR(other, i))][node] * t.shape[2][node][k];
}

/* Tile e: row r has r + 1 of them, and what is left of TILE_SIDE is a short row's. */
static inline __host__ __device__ int tile_row(int e)
{
	const int r = TILE_SIDE - 1 - e / TILE_SIDE;

	return e % TILE_SIDE <= r ? r : TILE_SIDE - 2 - r;
}

static inline __host__ __device__ int tile_column(int e)
{
	const int r = TILE_SIDE - 1 - e / TILE_SIDE;

	return e % TILE_SIDE <= r ? e % TILE_SIDE : e % TILE_SIDE - r - 1;
}

/* Positive above the limit, negative below its opposite. */
template <class Real> __host__ __device__ Real beyond(Real x, Real limit)
{
	return x > limit ? x - limit : x < -limit ? x + limit : 0;
}

/* What the limits add to element (a, b), b <= a: each joint's are rows of its own. */
template <class Real>
__host__ __device__ Real limits_pair(
	const tables<Real> &t, const scratch<Real> &s, Real weight, Real rate, int node, int a, int b)
{
	const int first = b == C ? 0 : b / K, last = b == C ? N - 1 : first;
	Real sum = 0;

	if (a > C || (a < C && a / K != first))
		return 0;
	for (int order = 0; order < 2; order++)
		for (int i = first; i <= last; i++) {
			const Real over = s.beyond[order][i], scale = (Real)PUSH * weight * (order ? rate : 1);

			if (over != 0)
				sum += (a == C ? over : scale * t.shape[order][node][a % K]) *
				       (b == C ? over : scale * t.shape[order][node][b % K]);
		}
	return sum;
}

/* The rows of [J r] at one node. */
template <class Real, class Team>
__host__ __device__ void node_rows(
	const tables<Real> &table, scratch<Real> &s, Real weight, Real rate, int node, const Team &t)
{
	for (int e = t.thread; e < N * WIDTH; e += t.threads)
		s.j[e / WIDTH][e % WIDTH] = weight * table.per_effort[e / WIDTH] *
					    torque_element(table, s, rate, node, e / WIDTH, e % WIDTH);
	for (int e = t.thread; e < 2 * N; e += t.threads)
		s.beyond[e / N][e % N] =
			(Real)PUSH * weight * beyond(s.row[ROW_Q + e][node], table.limit[e / N][e % N]);
}

/* Add what one node adds to tile (a, b), whose first element is (TILE a, TILE b). */
template <class Real>
__host__ __device__ void tile_add(const tables<Real> &t, const scratch<Real> &s, Real weight, Real rate, int node,
	int a, int b, Real sum[TILE][TILE])
{
	for (int y = 0; y < TILE; y++)
		for (int x = 0; x < TILE; x++) {
			const int row = a * TILE + y, column = b * TILE + x;

			for (int i = 0; i < N; i++)
				sum[y][x] += s.j[i][row] * s.j[i][column];
			if (column <= row)
				sum[y][x] += limits_pair(t, s, weight, rate, node, row, column);
		}
}

/* [J r]'[J r]. Each node stands for the same part of the time. Long rows of tiles and short ones make pairs of equal
   length, along which tiles are counted. */
template <class Real, class Team>
__host__ __device__ void pairs_make(
	const tables<Real> &table, const trajectory<Real> &x, scratch<Real> &s, const Team &t)
{
	const Real weight = sqrt(x.seconds / NODES), rate = 1 / x.seconds;
	constexpr int shares = (TILES + Team::threads - 1) / Team::threads; /* tiles of a thread */
	Real sum[shares][TILE][TILE] = {};

	for (int node = 0; node < NODES; node++) {
		node_rows(table, s, weight, rate, node, t);
		t.wait();
		for (int i = 0, e = t.thread; i < shares; i++, e += t.threads)
			if (e < TILES)
				tile_add(table, s, weight, rate, node, tile_row(e), tile_column(e), sum[i]);
		t.wait();
	}
	for (int i = 0, e = t.thread; i < shares; i++, e += t.threads)
		for (int k = 0; k < TILE * TILE && e < TILES; k++) {
			const int a = tile_row(e) * TILE + k / TILE, b = tile_column(e) * TILE + k % TILE;

			if (a < SIDE && b <= a)
				s.pairs[PAIR(a, b)] = sum[i][k / TILE][k % TILE];
		}
	t.wait();
}

/* Keep what was tried if it costs less (not a number does not); otherwise go back to the best so far. */
template <class Real, class Team> __host__ __device__ void judge(trajectory<Real> &x, scratch<Real> &s, const Team &t)
{
	if (t.thread == 0)
		s.kept = s.pairs[PAIR(C, C)] < x.cost;
	t.wait();
	for (int e = t.thread; e < C && s.kept; e += t.threads)
		x.c[e] = x.trial[e];
	for (int e = t.thread; e < PAIRS; e += t.threads)
		if (s.kept)
			x.pairs[e] = s.pairs[e];
		else
			s.pairs[e] = x.pairs[e];
	if (t.thread == 0) {
		x.cost = s.kept ? s.pairs[PAIR(C, C)] : x.cost;
		x.damping = s.kept ? fmax(x.damping / 2, (Real)1e-6) : x.damping * 3;
	}
	t.wait();
}

/* L L' of the damped matrix in its place, column by column; its last row is then y, L y = J'r. */
template <class Real, class Team> __host__ __device__ void factor(Real *l, Real damping, const Team &t)
{
	for (int e = t.thread; e < C; e += t.threads)
		l[PAIR(e, e)] += damping;
	t.wait();
	for (int k = 0; k < C; k++) {
		const Real pivot = sqrt(l[PAIR(k, k)]);

		t.wait();
		for (int a = k + t.thread; a < SIDE; a += t.threads)
			l[PAIR(a, k)] /= pivot;
		t.wait();
		for (int e = t.thread; e < SIDE * SIDE; e += t.threads) {
			const int a = e / SIDE, b = e % SIDE;

			if (b > k && a >= b)
				l[PAIR(a, b)] -= l[PAIR(a, k)] * l[PAIR(b, k)];
		}
		t.wait();
	}
}

/* L' d = -y from the last row upwards. */
template <class Real, class Team> __host__ __device__ void substitute(const Real *l, Real d[C], const Team &t)
{
	for (int e = t.thread; e < C; e += t.threads)
		d[e] = -l[PAIR(C, e)];
	t.wait();
	for (int k = C - 1; k >= 0; k--) {
		if (t.thread == 0)
			d[k] /= l[PAIR(k, k)];
		t.wait();
		for (int e = t.thread; e < k; e += t.threads)
			d[e] -= l[PAIR(k, e)] * d[k];
		t.wait();
	}
}

template <class Real, class Team>
__host__ __device__ void step(const batch<Real> &b, size_t k, int round, scratch<Real> &s, const Team &t)
{
	trajectory<Real> &x = b.all[k];

	rows_read(b, k, s, t);
	t.wait();
	pairs_make(*b.table, x, s, t);
	judge(x, s, t);
	factor(s.pairs, x.damping, t);
	substitute(s.pairs, s.d, t);
	for (int e = t.thread; e < C; e += t.threads)
		x.trial[e] = x.c[e] + s.d[e];
	if (t.thread == 0)
		b.history[(size_t)round * b.count + k] = x.cost;
}

#endif
