/* The controller of rollout.cpp: rollouts in one kernel. Each thread walks through a whole rollout of the panda with
   the inlined panda_f32_fd or panda_f64_fd; it reads the present state, the plan and the goal, makes its own noise, and
   writes one number. A second kernel makes the next plan: a block a step, whose threads make the noise again for the
   rollouts that weigh something. Positions, torques and noise never reach memory.

   The same functions (rollout_step.h) run on the host. Without nvcc this is C++, without kernels. */
#include "rollout_step.h"
#include "../gpu.h"
#include <chrono>
#include <memory>

#if defined RNEAGEN_STRICT_SINCOSF_CORE
const bool IS_STRICT = true;
#else
const bool IS_STRICT = false;
#endif

template <class Real> static row<Real> make_row(const double x[N])
{
	row<Real> r = {};

	for (int j = 0; j < N; j++)
		r.of[j] = (Real)x[j];
	return r;
}

/* State and goals, one after the other: what is new in every tick. */
template <class Real> static std::vector<row<Real>> make_news(const arm &now, const std::vector<arm> &goals)
{
	std::vector<row<Real>> news = {make_row<Real>(now.q), make_row<Real>(now.qd)};

	for (const arm &goal : goals) {
		news.push_back(make_row<Real>(goal.q));
		news.push_back(make_row<Real>(goal.qd));
	}
	return news;
}

template <class Real> static work<Real> make_work(const settings &s, uint32_t tick, const row<Real> *news)
{
	return {s.rollouts, s.steps, tick, s.seed, news, news + 2, NULL, NULL, NULL};
}

static double seconds_now()
{
	return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

template <class Real> static Real least_cost(const work<Real> &w)
{
	Real least = (Real)INFINITY;

	for (size_t k = 0; k < w.count; k++)
		least = w.costs[k] < least ? w.costs[k] : least;
	return least;
}

/* A step of the next plan on the host; sums in the order of plan_kernel. */
template <class Real> static void plan_step(const work<Real> &w, int step, Real least)
{
	share<Real> shares[PLAN_BLOCK];

	for (size_t i = 0; i < PLAN_BLOCK; i++)
		shares[i] = share_make(w, step, least, i);
	for (size_t half = PLAN_BLOCK / 2; half > 0; half /= 2)
		for (size_t i = 0; i < half; i++)
			share_add(shares[i], shares[i + half]);
	plan_write(w, step, shares[0]);
}

template <integrator METHOD, class Real> static void rollouts_on_host(const work<Real> &w)
{
	const long count = (long)w.count;

#pragma omp parallel for schedule(static)
	for (long k = 0; k < count; k++)
		w.costs[k] = rollout_cost<METHOD>(w, (size_t)k);
}

template <class Real> struct host_sampler : controller {
	settings s;
	std::vector<row<Real>> plan, next_plan;
	std::vector<Real> cost;

	explicit host_sampler(const settings &wanted)
	    : s(wanted), plan((size_t)wanted.steps + 1), next_plan(plan), cost(wanted.rollouts)
	{
	}

	int next(uint32_t tick, const arm &now, const std::vector<arm> &goals, double speed[N]) override
	{
		const std::vector<row<Real>> news = make_news<Real>(now, goals);
		const double begun = seconds_now();
		work<Real> w = make_work(s, tick, news.data());
		double between;

		w.plan = plan.data() + 1;
		w.costs = cost.data();
		w.next = next_plan.data();
		s.method == EULER ? rollouts_on_host<EULER>(w) : rollouts_on_host<RK4>(w);
		between = seconds_now();
		const Real least = least_cost(w);

#pragma omp parallel for schedule(static)
		for (int step = 0; step < s.steps; step++)
			plan_step(w, step, least);
		took(tick, between - begun, seconds_now() - between);
		plan.swap(next_plan);
		for (int j = 0; j < N; j++)
			speed[j] = (double)plan[0].of[j];
		return 0;
	}

	int costs(std::vector<double> &to) override
	{
		to.assign(cost.begin(), cost.end());
		return 0;
	}
};

controller *host_controller(const settings &s)
{
	if (s.is_f64)
		return new host_sampler<double>(s);
	return new host_sampler<float>(s);
}

#if defined __CUDACC__
#if !defined ROLLOUT_BLOCK
#define ROLLOUT_BLOCK 128 /* 16384 rollouts: a warp for each of four schedulers of 128 of an H100's 132 processors */
#endif

template <integrator METHOD, class Real>
static __global__ void __launch_bounds__(ROLLOUT_BLOCK) rollout_kernel(work<Real> w)
{
	const size_t k = (size_t)blockIdx.x * ROLLOUT_BLOCK + threadIdx.x;

	if (k < w.count)
		w.costs[k] = rollout_cost<METHOD>(w, k);
}

/* A block for each step of the plan. The least cost is the same in any order, sums are made in one. */
template <class Real> static __global__ void __launch_bounds__(PLAN_BLOCK) plan_kernel(work<Real> w)
{
	__shared__ Real lowest[PLAN_BLOCK];
	__shared__ share<Real> shares[PLAN_BLOCK];
	const unsigned i = threadIdx.x;
	Real least = (Real)INFINITY;

	for (size_t k = i; k < w.count; k += PLAN_BLOCK)
		least = w.costs[k] < least ? w.costs[k] : least;
	lowest[i] = least;
	__syncthreads();
	for (int other = 0; other < PLAN_BLOCK; other++)
		least = lowest[other] < least ? lowest[other] : least;
	shares[i] = share_make(w, (int)blockIdx.x, least, i);
	for (unsigned half = PLAN_BLOCK / 2; half > 0; half /= 2) {
		__syncthreads();
		if (i < half)
			share_add(shares[i], shares[i + half]);
	}
	if (i == 0)
		plan_write(w, (int)blockIdx.x, shares[0]);
}

template <class Real> static void (*kernel_of(integrator method))(work<Real>)
{
	return method == EULER ? rollout_kernel<EULER, Real> : rollout_kernel<RK4, Real>;
}

template <class Real> struct gpu_sampler : controller {
	settings s;
	row<Real> *news = NULL, *plan = NULL, *next_plan = NULL;
	Real *cost = NULL;
	cudaEvent_t marks[3] = {};

	explicit gpu_sampler(const settings &wanted) : s(wanted)
	{
	}

	~gpu_sampler() override
	{
		for (cudaEvent_t mark : marks)
			cudaEventDestroy(mark);
		for (void *array : {(void *)news, (void *)plan, (void *)next_plan, (void *)cost})
			cudaFree(array);
	}

	int begin()
	{
		const size_t bytes = ((size_t)s.steps + 1) * sizeof *plan;
		int bad = failed(cudaMalloc(&news, 2 * bytes)) || failed(cudaMalloc(&plan, bytes)) ||
			  failed(cudaMalloc(&next_plan, bytes)) ||
			  failed(cudaMalloc(&cost, s.rollouts * sizeof *cost)) || failed(cudaMemset(plan, 0, bytes));

		for (cudaEvent_t &mark : marks)
			bad = bad || failed(cudaEventCreate(&mark));
		return bad;
	}

	int launch(const work<Real> &w)
	{
		const unsigned blocks = (unsigned)((s.rollouts + ROLLOUT_BLOCK - 1) / ROLLOUT_BLOCK);

		cudaEventRecord(marks[0]);
		kernel_of<Real>(s.method)<<<blocks, ROLLOUT_BLOCK>>>(w);
		cudaEventRecord(marks[1]);
		plan_kernel<<<(unsigned)s.steps, PLAN_BLOCK>>>(w);
		cudaEventRecord(marks[2]);
		return failed(cudaGetLastError());
	}

	int next(uint32_t tick, const arm &now, const std::vector<arm> &goals, double speed[N]) override
	{
		const std::vector<row<Real>> fresh = make_news<Real>(now, goals);
		work<Real> w = make_work<Real>(s, tick, news);
		float ms[2] = {0, 0};
		row<Real> first;

		w.plan = plan + 1;
		w.costs = cost;
		w.next = next_plan;
		if (failed(cudaMemcpy(news, fresh.data(), fresh.size() * sizeof fresh[0], cudaMemcpyHostToDevice)) ||
			launch(w) || failed(cudaMemcpy(&first, next_plan, sizeof first, cudaMemcpyDeviceToHost)) ||
			failed(cudaEventElapsedTime(&ms[0], marks[0], marks[1])) ||
			failed(cudaEventElapsedTime(&ms[1], marks[1], marks[2])))
			return 1;
		took(tick, 1e-3 * (double)ms[0], 1e-3 * (double)ms[1]);
		std::swap(plan, next_plan);
		for (int j = 0; j < N; j++)
			speed[j] = (double)first.of[j];
		return 0;
	}

	int costs(std::vector<double> &to) override
	{
		std::vector<Real> copy(s.rollouts);

		if (failed(cudaMemcpy(copy.data(), cost, copy.size() * sizeof copy[0], cudaMemcpyDeviceToHost)))
			return 1;
		to.assign(copy.begin(), copy.end());
		return 0;
	}
};

template <class Real> static controller *make_gpu(const settings &s)
{
	std::unique_ptr<gpu_sampler<Real>> made(new gpu_sampler<Real>(s));

	return made->begin() ? NULL : made.release();
}

controller *gpu_controller(const settings &s)
{
	return s.is_f64 ? make_gpu<double>(s) : make_gpu<float>(s);
}

int gpu_registers(const settings &s, int *registers, size_t *spilled)
{
	cudaFuncAttributes a = {};
	const int bad = failed(s.is_f64 ? cudaFuncGetAttributes(&a, kernel_of<double>(s.method))
					: cudaFuncGetAttributes(&a, kernel_of<float>(s.method)));

	*registers = a.numRegs;
	*spilled = a.localSizeBytes;
	return bad;
}
#else
controller *gpu_controller(const settings &)
{
	return NULL;
}

int gpu_registers(const settings &, int *, size_t *)
{
	return 1;
}
#endif

void arm_moves(arm &a, const double speed[N])
{
	double tau[N];

	for (int i = 0; i < 10; i++) {
		servo(a.q, a.qd, speed, tau);
		rk4(a.q, a.qd, tau, DT / 10);
	}
}

static double energy(const arm &a)
{
	double kinetic, potential;

	panda_energy_rnea(a.q, a.qd, &kinetic, &potential);
	return kinetic + potential;
}

double swing_drift(integrator method, double dt)
{
	const double free[N] = {};
	arm a = {{SWING}, {}};
	const double begun = energy(a);
	double drift = 0;

	for (int i = 0; i < (int)(1 / dt + 0.5); i++) {
		method == EULER ? euler(a.q, a.qd, free, dt) : rk4(a.q, a.qd, free, dt);
		drift = fmax(drift, fabs(energy(a) - begun));
	}
	return drift;
}

bool limits_match()
{
	const double lowers[N] = {LOWERS}, uppers[N] = {UPPERS}, speeds[N] = {SPEEDS}, efforts[N] = {EFFORTS};
	bool match = panda_f64_nq == N && panda_f64_nv == N;

	for (int j = 0; j < N; j++)
		match = match && panda_f64_q_min[j] == lowers[j] && panda_f64_q_max[j] == uppers[j] &&
			panda_f64_qd_max[j] == speeds[j] && panda_f64_tau_max[j] == efforts[j];
	return match;
}
