/* The searches of ik.cpp: inverse kinematics in one kernel. Each thread walks towards one goal with the inlined
   panda_hand_f32_kin or panda_hand_f64_kin, and takes another goal when it is done, so that no lane of a warp waits for the
   longest search of the others. Poses and Jacobians never reach memory.

   The same functions (ik_step.h) run on the host. Without nvcc this is C++, without kernels. */
#include "ik_step.h"
#include "../gpu.h"
#include <chrono>

#if defined RNEAGEN_STRICT_SINCOSF_CORE
const bool IS_STRICT = true;
#else
const bool IS_STRICT = false;
#endif

template <class Real> static std::vector<Real> rows_of(const std::vector<goal> &goals)
{
	std::vector<Real> rows(7 * goals.size());

	for (size_t k = 0; k < goals.size(); k++)
		for (size_t i = 0; i < 7; i++)
			rows[i * goals.size() + k] = (Real)goals[k].of[i];
	return rows;
}

/* What searches write, on the host. */
template <class Real> struct results {
	std::vector<Real> q;
	std::vector<int> steps, reached;

	explicit results(size_t count) : q(N * count), steps(count), reached(count)
	{
	}

	void give(std::vector<solution> &found) const
	{
		const size_t count = steps.size();

		found.resize(count);
		for (size_t k = 0; k < count; k++) {
			found[k].steps = steps[k];
			found[k].tries = reached[k];
			for (size_t j = 0; j < N; j++)
				found[k].q[j] = (double)q[j * count + k];
		}
	}
};

template <class Real>
static int host_search(const settings &s, const std::vector<goal> &goals, std::vector<solution> &found, double *seconds)
{
	const std::vector<Real> rows = rows_of<Real>(goals);
	const long count = (long)goals.size();
	results<Real> r(goals.size());
	const work<Real> w = {goals.size(), s.tries, s.seed, rows.data(), r.q.data(), r.steps.data(), r.reached.data()};
	const auto begun = std::chrono::steady_clock::now();

#pragma omp parallel for schedule(dynamic, 64)
	for (long k = 0; k < count; k++) {
		search<Real> one = search_begin(w, (size_t)k);

		while (!search_step(w, one))
			;
	}
	*seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begun).count();
	r.give(found);
	return 0;
}

int solve_on_host(const settings &s, const std::vector<goal> &goals, std::vector<solution> &found, double *seconds)
{
	return s.is_f64 ? host_search<double>(s, goals, found, seconds) : host_search<float>(s, goals, found, seconds);
}

#if defined __CUDACC__
#if !defined IK_BLOCK
#define IK_BLOCK 128
#endif

template <class Real> static __global__ void __launch_bounds__(IK_BLOCK) search_kernel(work<Real> w, unsigned *next)
{
	size_t k = (size_t)blockIdx.x * IK_BLOCK + threadIdx.x;
	search<Real> s;
	bool is_new = true;

	while (k < w.count) {
		if (is_new)
			s = search_begin(w, k);
		is_new = search_step(w, s);
		if (is_new)
			k = atomicAdd(next, 1u);
	}
}

/* As many blocks as the GPU holds at once. */
template <class Real> static int blocks_at_once(size_t count, unsigned *blocks)
{
	int device, each, processors;

	if (failed(cudaGetDevice(&device)) ||
		failed(cudaDeviceGetAttribute(&processors, cudaDevAttrMultiProcessorCount, device)) ||
		failed(cudaOccupancyMaxActiveBlocksPerMultiprocessor(&each, search_kernel<Real>, IK_BLOCK, 0)))
		return 1;
	*blocks = (unsigned)each * (unsigned)processors;
	if (*blocks > (count + IK_BLOCK - 1) / IK_BLOCK)
		*blocks = (unsigned)((count + IK_BLOCK - 1) / IK_BLOCK);
	return 0;
}

template <class Real> struct arrays {
	Real *goals = NULL, *q = NULL;
	int *steps = NULL, *reached = NULL;
	unsigned *next = NULL;
	cudaEvent_t marks[2] = {};

	~arrays()
	{
		for (cudaEvent_t mark : marks)
			cudaEventDestroy(mark);
		for (void *array : {(void *)goals, (void *)q, (void *)steps, (void *)reached, (void *)next})
			cudaFree(array);
	}

	int make(const std::vector<Real> &rows, size_t count)
	{
		return failed(cudaMalloc(&goals, rows.size() * sizeof *goals)) || failed(cudaMalloc(&q, N * count * sizeof *q)) ||
		       failed(cudaMalloc(&steps, count * sizeof *steps)) ||
		failed(cudaMalloc(&reached, count * sizeof *reached)) ||
		       failed(cudaMalloc(&next, sizeof *next)) || failed(cudaEventCreate(&marks[0])) ||
		       failed(cudaEventCreate(&marks[1])) ||
		       failed(cudaMemcpy(goals, rows.data(), rows.size() * sizeof *goals, cudaMemcpyHostToDevice));
	}

	int take(results<Real> &r)
	{
		return failed(cudaMemcpy(r.q.data(), q, r.q.size() * sizeof *q, cudaMemcpyDeviceToHost)) ||
		       failed(cudaMemcpy(r.steps.data(), steps, r.steps.size() * sizeof *steps, cudaMemcpyDeviceToHost)) ||
		       failed(cudaMemcpy(r.reached.data(), reached, r.reached.size() * sizeof *reached, cudaMemcpyDeviceToHost));
	}
};

template <class Real>
static int gpu_search(const settings &s, const std::vector<goal> &goals, std::vector<solution> &found, double *seconds)
{
	const std::vector<Real> rows = rows_of<Real>(goals);
	results<Real> r(goals.size());
	arrays<Real> a;
	unsigned blocks, first;
	float ms = 0;

	if (a.make(rows, goals.size()) || blocks_at_once<Real>(goals.size(), &blocks))
		return 1;
	first = blocks * IK_BLOCK;
	const work<Real> w = {goals.size(), s.tries, s.seed, a.goals, a.q, a.steps, a.reached};

	/* the first launch may have to load the kernel */
	for (int again = 0; again < 2; again++) {
		if (failed(cudaMemcpy(a.next, &first, sizeof first, cudaMemcpyHostToDevice)))
			return 1;
		cudaEventRecord(a.marks[0]);
		search_kernel<<<blocks, IK_BLOCK>>>(w, a.next);
		cudaEventRecord(a.marks[1]);
		if (failed(cudaGetLastError()) || failed(cudaEventSynchronize(a.marks[1])))
			return 1;
	}
	if (a.take(r) || failed(cudaEventElapsedTime(&ms, a.marks[0], a.marks[1])))
		return 1;
	*seconds = 1e-3 * (double)ms;
	r.give(found);
	return 0;
}

int solve_on_gpu(const settings &s, const std::vector<goal> &goals, std::vector<solution> &found, double *seconds)
{
	return s.is_f64 ? gpu_search<double>(s, goals, found, seconds) : gpu_search<float>(s, goals, found, seconds);
}

int gpu_registers(const settings &s, int *registers, size_t *spilled)
{
	cudaFuncAttributes a = {};
	const int bad = failed(s.is_f64 ? cudaFuncGetAttributes(&a, search_kernel<double>)
					: cudaFuncGetAttributes(&a, search_kernel<float>));

	*registers = a.numRegs;
	*spilled = a.localSizeBytes;
	return bad;
}
#else
int solve_on_gpu(const settings &, const std::vector<goal> &, std::vector<solution> &, double *)
{
	return 1;
}

int gpu_registers(const settings &, int *, size_t *)
{
	return 1;
}
#endif

goal hand_at(const double q[N])
{
	double J[6 * N];
	goal at;

	hand(q, at.of, J);
	return at;
}

void draw_angles(uint64_t seed, uint32_t k, double q[N])
{
	draw(seed, k, 0, q);
}

bool limits_match()
{
	const double lowers[N] = {LOWERS}, uppers[N] = {UPPERS};
	bool match = panda_hand_f64_nq == N && panda_hand_f64_nv == N;

	for (int j = 0; j < N; j++)
		match = match && panda_hand_f64_q_min[j] == lowers[j] && panda_hand_f64_q_max[j] == uppers[j];
	return match;
}
