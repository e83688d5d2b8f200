#ifndef IK_STEP_H
#define IK_STEP_H
/* What one thread of ik.cu does, on the GPU and on the host: search_step is one step of damped least squares towards one
   goal, with the pose and the Jacobian of the hand from the generated text.

   Besides the texts there are only operations that every processor rounds alike (+ - * / and the square root), in an order
   that is fixed. So with texts of --strict, and where the compiler joins no products to sums (-ffp-contract=off, nvcc's
   -fmad=false), the host and the GPU have the same bits. */

#include "../philox.h"
#include "ik.h"
#include "panda_hand_f32_rnea.h"
#include "panda_hand_f64_rnea.h"
#include <math.h>
#if defined __CUDACC__
#define BOTH static __host__ __device__ __forceinline__
#define UNROLLED _Pragma("unroll")
#else
#define BOTH static inline
#define UNROLLED
#endif

/* Where one search is. */
template <class Real> struct search {
	Real goal[7], q[N];
	uint32_t k;
	int steps, tries; /* so far */
};

/* All that the searches read, and what they write: rows of `count`. */
template <class Real> struct work {
	size_t count;
	int tries;
	uint64_t seed;
	const Real *goals; /* [7] */
	Real *q;	   /* [N] */
	int *steps, *reached;
};

/* x y z, quaternion x y z w; J[6][N], linear rows first, in the base's axes at the hand. */
BOTH void hand(const float *q, float *pose, float *J)
{
	panda_hand_f32_kin(q, pose, J);
}

BOTH void hand(const double *q, double *pose, double *J)
{
	panda_hand_f64_kin(q, pose, J);
}

/* Angles between the limits, by 24 random bits each. */
template <class Real> BOTH void draw(uint64_t seed, uint32_t k, uint32_t number, Real q[N])
{
	const double low[N] = {LOWERS}, high[N] = {UPPERS};
	const philox a = philox4x32_10({{k, number, 0, 0}}, seed), b = philox4x32_10({{k, number, 1, 0}}, seed);

	UNROLLED for (int j = 0; j < N; j++)
	{
		const uint32_t word = j < 4 ? a.word[j] : b.word[j - 4];

		q[j] = (Real)low[j] + (Real)(high[j] - low[j]) * ((Real)(word >> 8) * (Real)5.9604644775390625e-8);
	}
}

template <class Real> BOTH search<Real> search_begin(const work<Real> &w, size_t k)
{
	search<Real> s;

	UNROLLED for (int i = 0; i < 7; i++)
		s.goal[i] = w.goals[(size_t)i * w.count + k];
	s.k = (uint32_t)k;
	s.steps = 0;
	s.tries = 1;
	draw(w.seed, s.k, 1, s.q);
	return s;
}

/* How far the hand is off: a shift, and for the rotation u* conj(u) = (v, cos) the vector 2 v, of length 2 sin(angle/2). */
template <class Real> BOTH void error_of(const Real goal[7], const Real pose[7], Real e[6])
{
	const Real *a = goal + 3, *b = pose + 3;
	const Real turn = a[3] * b[3] + a[0] * b[0] + a[1] * b[1] + a[2] * b[2], two = turn < 0 ? (Real)-2 : (Real)2;

	UNROLLED for (int i = 0; i < 3; i++)
	{
		const int j = (i + 1) % 3, k = (i + 2) % 3;

		e[i] = goal[i] - pose[i];
		e[3 + i] = two * (b[3] * a[i] - a[3] * b[i] - (a[j] * b[k] - a[k] * b[j]));
	}
}

/* A = L L^T, [6][6] with the lower triangle set; x = A^-1 b. */
template <class Real> BOTH void solve(Real A[6][6], Real x[6])
{
	UNROLLED for (int j = 0; j < 6; j++)
	{
		UNROLLED for (int k = 0; k < j; k++)
			UNROLLED for (int i = j; i < 6; i++)
				A[i][j] = A[i][j] - A[i][k] * A[j][k];
		const Real root = (Real)1 / (Real)sqrt(A[j][j]);

		UNROLLED for (int i = j; i < 6; i++)
			A[i][j] = A[i][j] * root;
	}
	UNROLLED for (int i = 0; i < 6; i++)
	{
		UNROLLED for (int k = 0; k < i; k++)
			x[i] = x[i] - A[i][k] * x[k];
		x[i] = x[i] / A[i][i];
	}
	UNROLLED for (int i = 5; i >= 0; i--)
	{
		UNROLLED for (int k = i + 1; k < 6; k++)
			x[i] = x[i] - A[k][i] * x[k];
		x[i] = x[i] / A[i][i];
	}
}

/* dq = J^T (J J^T + (e^T e / 50 + DAMPING) 1)^-1 e (Sugihara 2011), without the joints that would leave their limits. */
template <class Real> BOTH void descend(const Real J[6][N], const Real e[6], Real square, Real q[N])
{
	const double lowers[N] = {LOWERS}, uppers[N] = {UPPERS};
	const Real damping = (Real)0.02 * square + (Real)DAMPING;
	Real A[6][6], x[6], free[N];

	UNROLLED for (int j = 0; j < N; j++)
	{
		Real pull = 0;

		UNROLLED for (int i = 0; i < 6; i++)
			pull = pull + J[i][j] * e[i];
		free[j] = (q[j] <= (Real)lowers[j] && pull < 0) || (q[j] >= (Real)uppers[j] && pull > 0) ? (Real)0 : (Real)1;
	}
	UNROLLED for (int i = 0; i < 6; i++)
	{
		UNROLLED for (int k = 0; k <= i; k++)
		{
			A[i][k] = i == k ? damping : (Real)0;
			UNROLLED for (int j = 0; j < N; j++)
				A[i][k] = A[i][k] + J[i][j] * free[j] * J[k][j];
		}
		x[i] = e[i];
	}
	solve(A, x);
	UNROLLED for (int j = 0; j < N; j++)
	{
		const Real low = (Real)lowers[j], high = (Real)uppers[j];
		Real to = 0;

		UNROLLED for (int i = 0; i < 6; i++)
			to = to + J[i][j] * x[i];
		to = q[j] + free[j] * to;
		q[j] = to < low ? low : to > high ? high : to;
	}
}

/* One look at where the hand is, and one step. Returns whether the search is over, and then writes what it found. */
template <class Real> BOTH bool search_step(const work<Real> &w, search<Real> &s)
{
	Real pose[7], J[6][N], e[6];

	hand(s.q, pose, &J[0][0]);
	error_of(s.goal, pose, e);
	const Real off = e[0] * e[0] + e[1] * e[1] + e[2] * e[2], turned = e[3] * e[3] + e[4] * e[4] + e[5] * e[5];
	const bool is_there = off <= (Real)(WITHIN * WITHIN) && turned <= (Real)(WITHIN_ANGLE * WITHIN_ANGLE);
	const bool is_over = s.steps == s.tries * STEPS;

	if (is_there || (is_over && s.tries == w.tries)) {
		UNROLLED for (int j = 0; j < N; j++)
			w.q[(size_t)j * w.count + s.k] = s.q[j];
		w.steps[s.k] = s.steps;
		w.reached[s.k] = is_there ? s.tries : 0;
		return true;
	}
	if (is_over)
		draw(w.seed, s.k, (uint32_t)++s.tries, s.q);
	else
		descend(J, e, off + turned, s.q);
	s.steps += !is_over;
	return false;
}

#endif
