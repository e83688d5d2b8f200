/* The rounds of trajectories.cpp on the GPU, or on the host. Without nvcc this is C++, without kernels. */
#include "trajectories_step.h"
#include <rnea.h>
#include <cstdio>
#include <cstring>

static int failed(const rnea_error &e)
{
	if (e.code)
		fprintf(stderr, "trajectories: %s\n", e.message);
	return e.code != RNEA_OK;
}

#if defined __CUDACC__
const bool SOLVES_ON_GPU = true;
enum { SAMPLE_BLOCK = 128, STEP_BLOCK = 128 };

template <class Real> static __global__ void __launch_bounds__(SAMPLE_BLOCK) sample_kernel(batch<Real> b)
{
	const size_t sample = (size_t)blockIdx.x * SAMPLE_BLOCK + threadIdx.x;

	if (sample < b.count * NODES)
		sample_write(b, sample);
}

template <class Real> static __global__ void __launch_bounds__(STEP_BLOCK) step_kernel(batch<Real> b, int round)
{
	__shared__ scratch<Real> s;
	const team<STEP_BLOCK> t = {(int)threadIdx.x};

	step(b, (size_t)blockIdx.x, round, s, t);
}

static int failed(cudaError_t e)
{
	if (e != cudaSuccess)
		fprintf(stderr, "trajectories: %s\n", cudaGetErrorString(e));
	return e != cudaSuccess;
}

/* One round, with a mark in the stream before, between and after its launches. */
template <class Real>
static int round_on_gpu(const rnea_robot *robot, const batch<Real> &b, int round, cudaEvent_t marks[4])
{
	const unsigned blocks = (unsigned)((b.count * NODES + SAMPLE_BLOCK - 1) / SAMPLE_BLOCK);
	rnea_error e;

	cudaEventRecord(marks[0]);
	sample_kernel<<<blocks, SAMPLE_BLOCK>>>(b);
	cudaEventRecord(marks[1]);
	rnea_launch(robot, (void *const *)b.array, b.count * NODES, NULL, &e);
	cudaEventRecord(marks[2]);
	step_kernel<<<(unsigned)b.count, STEP_BLOCK>>>(b, round);
	cudaEventRecord(marks[3]);
	return failed(e) || failed(cudaGetLastError());
}

template <class Real> static int rounds_on_gpu(const rnea_robot *robot, const batch<Real> &b, int rounds, course &c)
{
	std::vector<cudaEvent_t> marks(4 * (size_t)rounds);
	int bad = 0;

	for (cudaEvent_t &mark : marks)
		bad = bad || failed(cudaEventCreate(&mark));
	for (int r = 0; r < rounds && !bad; r++)
		bad = round_on_gpu(robot, b, r, &marks[4 * (size_t)r]);
	bad = bad || failed(cudaDeviceSynchronize());
	for (int r = 0; r < rounds && !bad; r++)
		for (int i = 0; i < 3; i++) {
			const cudaEvent_t *mark = &marks[4 * (size_t)r + (size_t)i];

			bad = bad ||
			      failed(cudaEventElapsedTime(&c.rounds[(size_t)r].milliseconds[i], mark[0], mark[1]));
		}
	bad = bad || failed(cudaEventElapsedTime(&c.milliseconds, marks.front(), marks.back()));
	for (cudaEvent_t mark : marks)
		cudaEventDestroy(mark);
	return bad;
}

/* A copy of `from` on the GPU, of `bytes`, or as many of zero. */
static int gpu_array(void *slot, const void *from, size_t bytes)
{
	void *array = NULL;
	const int bad =
		failed(cudaMalloc(&array, bytes)) ||
		failed(from ? cudaMemcpy(array, from, bytes, cudaMemcpyHostToDevice) : cudaMemset(array, 0, bytes));

	memcpy(slot, &array, sizeof array);
	return bad;
}

/* What `host` points to is copied there and the results are copied back. It runs twice, for kernels are
   loaded when they are first launched. */
template <class Real> static int solve_on_gpu(const rnea_robot *robot, const batch<Real> &host, int rounds, course &c)
{
	const size_t all = host.count * sizeof *host.all, history = host.count * (size_t)rounds * sizeof(Real);
	batch<Real> b = host;
	int bad = gpu_array(&b.table, host.table, sizeof *host.table);

	bad |= gpu_array(&b.all, host.all, all);
	bad |= gpu_array(&b.history, NULL, history);
	for (int i = 0; i < ARRAYS; i++)
		bad |= gpu_array(&b.array[i], NULL, HEIGHTS[i] * host.count * NODES * sizeof(Real));
	bad = bad || rounds_on_gpu(robot, b, rounds, c) ||
	      failed(cudaMemcpy(b.all, host.all, all, cudaMemcpyHostToDevice)) || rounds_on_gpu(robot, b, rounds, c) ||
	      failed(cudaMemcpy(host.all, b.all, all, cudaMemcpyDeviceToHost)) ||
	      failed(cudaMemcpy(host.history, b.history, history, cudaMemcpyDeviceToHost));
	for (Real *array : b.array)
		cudaFree(array);
	cudaFree(b.history);
	cudaFree(b.all);
	cudaFree((void *)b.table);
	return bad;
}
#else
const bool SOLVES_ON_GPU = false;

template <class Real> static int solve_on_gpu(const rnea_robot *, const batch<Real> &, int, course &)
{
	fprintf(stderr, "trajectories: built without nvcc\n");
	return 1;
}
#endif

template <class Real> static int solve_on_host(const rnea_robot *robot, batch<Real> &b, int rounds)
{
	const team<1> alone = {0};
	std::vector<scratch<Real>> s(1);
	std::vector<Real> arrays[ARRAYS];
	rnea_error e;

	for (int i = 0; i < ARRAYS; i++) {
		arrays[i].resize(HEIGHTS[i] * b.count * NODES);
		b.array[i] = arrays[i].data();
	}
	for (int r = 0; r < rounds; r++) {
		for (size_t sample = 0; sample < b.count * NODES; sample++)
			sample_write(b, sample);
		if (rnea_launch(robot, (void *const *)b.array, b.count * NODES, NULL, &e))
			return failed(e);
		for (size_t k = 0; k < b.count; k++)
			step(b, k, r, s[0], alone);
	}
	return 0;
}

template <class To, class From> static void convert(const From *from, To *to, size_t count)
{
	for (size_t i = 0; i < count; i++)
		to[i] = (To)from[i];
}

template <class To, class From> static trajectory<To> convert(const trajectory<From> &from)
{
	trajectory<To> to;

	convert(from.from, to.from, N);
	convert(from.to, to.to, N);
	convert(from.c, to.c, C);
	convert(from.trial, to.trial, C);
	convert(from.pairs, to.pairs, PAIRS);
	convert(&from.seconds, &to.seconds, 1);
	convert(&from.cost, &to.cost, 1);
	convert(&from.damping, &to.damping, 1);
	return to;
}

template <class Real>
static int solve_in(const rnea_robot *robot, const tables<double> &t, std::vector<trajectory<double>> &all, course &c)
{
	const int rounds = (int)c.rounds.size();
	std::vector<trajectory<Real>> ours;
	std::vector<Real> history(all.size() * c.rounds.size());
	tables<Real> table;
	batch<Real> b = {all.size(), &table, NULL, {}, history.data()};

	for (int i = 0; i < 3 * NODES; i++)
		convert(t.shape[i / NODES][i % NODES], table.shape[i / NODES][i % NODES], K + 1);
	for (int i = 0; i < 2; i++)
		convert(t.limit[i], table.limit[i], N);
	convert(t.per_effort, table.per_effort, N);
	for (const trajectory<double> &x : all)
		ours.push_back(convert<Real>(x));
	b.all = ours.data();
	if (rnea_build(robot)->backend == RNEA_BACKEND_CUDA ? solve_on_gpu(robot, b, rounds, c)
							    : solve_on_host(robot, b, rounds))
		return 1;
	for (size_t k = 0; k < all.size(); k++)
		all[k] = convert<double>(ours[k]);
	for (size_t r = 0; r < c.rounds.size(); r++)
		c.rounds[r].costs.assign(&history[r * all.size()], &history[r * all.size()] + all.size());
	return 0;
}

int solve(const rnea_robot *robot, const tables<double> &t, std::vector<trajectory<double>> &all, int rounds, course &c)
{
	c = course();
	c.rounds.resize((size_t)rounds);
	return rnea_info(robot)->precision == RNEA_F64 ? solve_in<double>(robot, t, all, c)
						       : solve_in<float>(robot, t, all, c);
}
