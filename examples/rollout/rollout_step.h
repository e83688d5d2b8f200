#ifndef ROLLOUT_STEP_H
#define ROLLOUT_STEP_H
/* What one thread of rollout.cu does, on the GPU and on the host:

     rollout_cost   one rollout from the present state, under the plan with noise          one thread a rollout
     share_make     what some of the rollouts have to say about one step of the next plan  PLAN_BLOCK threads a step

   Besides the generated texts there are only operations that every processor rounds alike, in an order that is fixed.
   So with texts of --strict, and where the compiler joins no products to sums (-ffp-contract=off, nvcc's -fmad=false),
   the host and the GPU have the same bits. */

#include "../philox.h"
#include "rollout.h"
#include "panda_energy_rnea.h"
#include "panda_f32_rnea.h"
#include "panda_f64_rnea.h"
#include "panda_hold_f32_rnea.h"
#include "panda_hold_f64_rnea.h"
#include <math.h>
#if defined __CUDACC__
#define BOTH static __host__ __device__ __forceinline__
#define UNROLLED _Pragma("unroll")
#define NOT_UNROLLED _Pragma("unroll 1")
#else
#define BOTH static inline
#define UNROLLED
#define NOT_UNROLLED
#endif

constexpr int PLAN_BLOCK = 256;

/* A number for each joint, and one that nobody uses: a row is read by 16 bytes at a time. */
template <class Real> struct alignas(16) row {
	Real of[N + 1];
};

/* All that the rollouts of a tick read, and what they write. */
template <class Real> struct work {
	size_t count;
	int steps;
	uint32_t tick;
	uint64_t seed;
	const row<Real> *state; /* q, qd */
	const row<Real> *goals; /* [step][2]: q, qd */
	const row<Real> *plan;	/* [step]: speeds */
	Real *costs;		/* [count] */
	row<Real> *next;	/* [steps + 1]: the speeds to command now, and the next plan */
};

BOTH void forward_dynamics(const float *q, const float *qd, const float *tau, float *qdd)
{
	panda_f32_fd(q, qd, tau, qdd);
}

BOTH void forward_dynamics(const double *q, const double *qd, const double *tau, double *qdd)
{
	panda_f64_fd(q, qd, tau, qdd);
}

BOTH void gravity_torques(const float *q, float *tau)
{
	panda_hold_f32_rnea(q, tau);
}

BOTH void gravity_torques(const double *q, double *tau)
{
	panda_hold_f64_rnea(q, tau);
}

template <class Real> BOTH Real clamp(Real x, Real low, Real high)
{
	return x < low ? low : x > high ? high : x;
}

/* The speeds that rollout k commands at a step: the plan's with noise, within limits. */
template <class Real> BOTH void sample(const work<Real> &w, size_t k, int step, Real speed[N])
{
	const double most[N] = {SPEEDS};
	const row<Real> plan = w.plan[step];
	const philox a = philox4x32_10({{(uint32_t)k, (uint32_t)step, w.tick, 0}}, w.seed);
	const philox b = philox4x32_10({{(uint32_t)k, (uint32_t)step, w.tick, 1}}, w.seed);

	UNROLLED
	for (int j = 0; j < N; j++) {
		const Real bell = (Real)philox_bell(j < 4 ? a.word[j] : b.word[j - 4]);

		speed[j] =
			clamp(plan.of[j] + (Real)(DEVIATION / PHILOX_DEVIATION) * bell, (Real)-most[j], (Real)most[j]);
	}
}

/* What the joints' servos make of it: they hold the arm, and damp what a speed is off, as far as the motors can. */
template <class Real> BOTH void servo(const Real q[N], const Real qd[N], const Real speed[N], Real tau[N])
{
	const double gains[N] = {GAINS}, efforts[N] = {EFFORTS};
	Real gravity[N];

	gravity_torques(q, gravity);
	UNROLLED
	for (int j = 0; j < N; j++)
		tau[j] = clamp(gravity[j] + (Real)gains[j] * (speed[j] - qd[j]), (Real)-efforts[j], (Real)efforts[j]);
}

/* qd += qdd dt, then q += qd dt */
template <class Real> BOTH void euler(Real q[N], Real qd[N], const Real tau[N], Real dt)
{
	Real qdd[N];

	forward_dynamics(q, qd, tau, qdd);
	UNROLLED
	for (int j = 0; j < N; j++) {
		qd[j] = qd[j] + dt * qdd[j];
		q[j] = q[j] + dt * qd[j];
	}
}

/* Runge and Kutta's method of the fourth order; a loop over its stages, so that the text is there once. */
template <class Real> BOTH void rk4(Real q[N], Real qd[N], const Real tau[N], Real dt)
{
	Real at_q[N], at_qd[N], qdd[N], sum_q[N], sum_qd[N];

	UNROLLED
	for (int j = 0; j < N; j++) {
		sum_q[j] = at_q[j] = q[j];
		sum_qd[j] = at_qd[j] = qd[j];
	}
	NOT_UNROLLED
	for (int stage = 0; stage < 4; stage++) {
		const Real part = dt * (Real)(stage == 0 || stage == 3 ? 1.0 / 6 : 1.0 / 3);
		const Real ahead = dt * (Real)(stage == 2 ? 1 : 0.5);

		forward_dynamics(at_q, at_qd, tau, qdd);
		UNROLLED
		for (int j = 0; j < N; j++) {
			sum_q[j] = sum_q[j] + part * at_qd[j];
			sum_qd[j] = sum_qd[j] + part * qdd[j];
			at_q[j] = q[j] + ahead * at_qd[j];
			at_qd[j] = qd[j] + ahead * qdd[j];
		}
	}
	UNROLLED
	for (int j = 0; j < N; j++) {
		q[j] = sum_q[j];
		qd[j] = sum_qd[j];
	}
}

template <integrator METHOD, class Real> BOTH void advance(Real q[N], Real qd[N], const Real tau[N], Real dt)
{
	if (METHOD == EULER)
		euler(q, qd, tau, dt);
	else
		rk4(q, qd, tau, dt);
}

template <class Real> BOTH Real square(Real x)
{
	return x * x;
}

/* What a step costs that ends in q and qd. */
template <class Real> BOTH Real step_cost(const Real q[N], const Real qd[N], const row<Real> goal[2])
{
	const double lowers[N] = {LOWERS}, uppers[N] = {UPPERS};
	const row<Real> goal_q = goal[0], goal_qd = goal[1];
	Real angles = 0, speeds = 0, limits = 0;

	UNROLLED
	for (int j = 0; j < N; j++) {
		angles = angles + square(q[j] - goal_q.of[j]);
		speeds = speeds + square(qd[j] - goal_qd.of[j]);
		limits = limits + square(q[j] - clamp(q[j], (Real)lowers[j], (Real)uppers[j]));
	}
	return (Real)(DT * WEIGHT_ANGLE) * angles + (Real)(DT * WEIGHT_SPEED) * speeds +
	       (Real)(DT * WEIGHT_LIMIT) * limits;
}

/* What rollout k costs, all of it; what is read is the same for all threads of a block. */
template <integrator METHOD, class Real> BOTH Real rollout_cost(const work<Real> &w, size_t k)
{
	Real q[N], qd[N], speed[N], tau[N], cost = 0;

	UNROLLED
	for (int j = 0; j < N; j++) {
		q[j] = w.state[0].of[j];
		qd[j] = w.state[1].of[j];
	}
	NOT_UNROLLED
	for (int step = 0; step < w.steps; step++) {
		sample(w, k, step, speed);
		servo(q, qd, speed, tau);
		advance<METHOD>(q, qd, tau, (Real)DT);
		cost = cost + step_cost(q, qd, &w.goals[2 * step]);
	}
	return cost;
}

/* e^-x for x >= 0, to 1e-4 of it, by squaring what a series gives for x / 1024; 0 beyond 16 and for a NaN. */
template <class Real> BOTH Real exp_minus(Real x)
{
	const Real y = x * (Real)(1.0 / 1024);
	Real e = 1 - y * (1 - y * (Real)(1.0 / 2) * (1 - y * (Real)(1.0 / 3) * (1 - y * (Real)(1.0 / 4))));

	if (!(x < 16))
		return 0;
	UNROLLED
	for (int i = 0; i < 10; i++)
		e = e * e;
	return e;
}

/* Weights of rollouts, and their speeds at a step times these. */
template <class Real> struct share {
	Real weight, pull[N];
};

template <class Real> BOTH void share_add(share<Real> &a, const share<Real> &b)
{
	a.weight = a.weight + b.weight;
	UNROLLED
	for (int j = 0; j < N; j++)
		a.pull[j] = a.pull[j] + b.pull[j];
}

/* Of the rollouts thread, thread + PLAN_BLOCK, ... The noise is made again, not kept. */
template <class Real> BOTH share<Real> share_make(const work<Real> &w, int step, Real least, size_t thread)
{
	share<Real> sum = {}, one;

	for (size_t k = thread; k < w.count; k += PLAN_BLOCK) {
		one.weight = exp_minus((w.costs[k] - least) / (Real)LAMBDA);
		if (!(one.weight > 0))
			continue;
		sample(w, k, step, one.pull);
		UNROLLED
		for (int j = 0; j < N; j++)
			one.pull[j] = one.weight * one.pull[j];
		share_add(sum, one);
	}
	return sum;
}

/* The mean is what this step of the plan becomes; the last step is there twice. */
template <class Real> BOTH void plan_write(const work<Real> &w, int step, const share<Real> &sum)
{
	for (int j = 0; j < N; j++) {
		const Real mean = sum.pull[j] / sum.weight;

		w.next[step].of[j] = mean;
		if (step == w.steps - 1)
			w.next[w.steps].of[j] = mean;
	}
}

#endif
