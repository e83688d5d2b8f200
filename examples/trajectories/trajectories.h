#ifndef TRAJECTORIES_H
#define TRAJECTORIES_H
/* What trajectories.cpp optimises. Every joint goes from rest to rest in T seconds,

     q(s) = from + (to - from) line(s) + sum_k c_k shape_k(s),   s = t / T from 0 to 1,

   with line = 10 s^3 - 15 s^4 + 6 s^5 (least jerk) and shape_k = (4 s (1 - s))^3 T_k(2 s - 1), T_k of Chebyshev: these
   vanish at both ends with their first and second derivatives. What is sought are the C numbers c_k of all joints. */

#include <cstddef>
#include <rnea.h>
#include <vector>

constexpr int N = 7, K = 4, C = N * K; /* joints of the iiwa 14, shapes for each, numbers sought */
constexpr int NODES = 32;	       /* moments of a trajectory at which its torques are computed */
constexpr int SIDE = C + 1, PAIRS = SIDE * (SIDE + 1) / 2;
constexpr double PUSH = 3; /* weight of an angle (1/rad) and of a speed (s/rad) beyond its limit */

/* iiwa14.urdf: <limit effort upper velocity>; lower is -upper */
#define EFFORTS 320, 320, 176, 176, 110, 40, 40
#define ANGLES 2.96705972839, 2.09439510239, 2.96705972839, 2.09439510239, 2.96705972839, 2.09439510239, 3.05432619099
#define SPEEDS                                                                                                         \
	1.4835298641951802, 1.4835298641951802, 1.7453292519943295, 1.3089969389957472, 2.2689280275926285,            \
		2.356194490192345, 2.356194490192345

/* The shapes and, in column K, the line, with their derivatives by s, at the nodes; the robot's limits. */
template <class Real> struct tables {
	Real shape[3][NODES][K + 1];
	Real limit[2][N];   /* of angles, of speeds */
	Real per_effort[N]; /* 1 / (N m) */
};

/* One trajectory and what is known of it. `pairs` is the lower triangle, row by row, of [J r]'[J r], where r are the
   weighted torques at the nodes, and what is beyond limits, at c, and J their derivatives by c: the last row is half
   the gradient of the cost and, in the end, the cost. */
template <class Real> struct trajectory {
	Real from[N], to[N], seconds;
	Real c[C], trial[C]; /* the best so far, and what is tried next */
	Real pairs[PAIRS];
	Real cost, damping;
};

/* Element (a, b) of a lower triangle, a >= b. */
#define PAIR(a, b) ((a) * ((a) + 1) / 2 + (b))

/* What became of a batch. */
struct course {
	struct round {
		std::vector<double> costs; /* of every trajectory, the best so far */
		float milliseconds[3];	   /* on the GPU, of each kernel */
	};
	std::vector<round> rounds;
	float milliseconds; /* on the GPU, from the beginning of the first round to the end of the last */
};

/* Some rounds over a batch, on what the robot was opened for, in the precision of its text; the GPU only where
   SOLVES_ON_GPU, which nvcc makes true. Returns 1, having said why, if that cannot be done. */
extern const bool SOLVES_ON_GPU;
int solve(
	const rnea_robot *robot, const tables<double> &t, std::vector<trajectory<double>> &all, int rounds, course &c);

tables<double> make_tables();

/* Between random poses, within limits, as fast as 0.8 of the speeds allow; nothing is tried yet but the line itself. */
std::vector<trajectory<double>> random_trajectories(size_t count);

/* Small random c to try first. */
void bend(std::vector<trajectory<double>> &all);

/* The cost in double precision by the C function, of the torques alone if `most` is not NULL: then most[0] and most[1]
   are how far an angle and a speed are beyond their limits, and most[2] is the largest part of an effort. */
double exact_cost(const tables<double> &t, const trajectory<double> &x, const double c[C], double most[3]);

/* How far `pairs` is off at c, beside exact_cost: of the cost, as a part of it; of the gradient, beside differences of
   the cost, and of J'J, beside differences of r, as parts of what the lengths of r and of J's columns allow. */
struct difference {
	double cost, gradient, matrix;
};
difference pairs_error(const tables<double> &t, const trajectory<double> &x);

/* The largest difference of the tables from the shapes in their trigonometric form and its differences. */
double tables_error(const tables<double> &t);

#endif
