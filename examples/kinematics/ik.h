#ifndef IK_H
#define IK_H
/* What ik.cpp asks of ik.cu: configurations of a Panda whose hand is where it shall be. Angles are in the order of
   panda.urdf. */

#include <cstddef>
#include <cstdint>
#include <vector>

constexpr int N = 7;
constexpr double TOLERANCE = 1e-3, TOLERANCE_ANGLE = 0.01; /* m, rad: what solvers publish as reached */
constexpr double WITHIN = 0.999e-3, WITHIN_ANGLE = 0.00999; /* where a search ends: m, 2 sin(angle/2) */
constexpr double DAMPING = 1e-4; /* beside a fiftieth of the squared error */
constexpr int STEPS = 12;   /* of one try; the next begins elsewhere */

/* panda.urdf: <limit lower upper> */
#define LOWERS -2.8973, -1.7628, -2.8973, -3.0718, -2.8973, -0.0175, -2.8973
#define UPPERS 2.8973, 1.7628, 2.8973, -0.0698, 2.8973, 3.7525, 2.8973

/* Position of panda_hand_tcp in the frame of the arm's base, m, and a unit quaternion x y z w. */
struct goal {
	double of[7];
};

/* `tries` is 0 where no try came to the goal; steps are those of all tries. */
struct solution {
	double q[N];
	int steps, tries;
};

struct settings {
	int tries;
	bool is_f64;
	uint64_t seed; /* of the configurations where tries begin */
};

/* On the GPU, or on the host by all threads of OpenMP. `seconds` is the time of the search, without copies of the arrays.
   Returns 1, having said why, if that cannot be done. */
int solve_on_host(const settings &s, const std::vector<goal> &goals, std::vector<solution> &found, double *seconds);
int solve_on_gpu(const settings &s, const std::vector<goal> &goals, std::vector<solution> &found, double *seconds);

/* The registers and the spilled bytes of a thread. */
int gpu_registers(const settings &s, int *registers, size_t *spilled);

/* Where configuration q has the hand, in f64; a configuration within the limits, which a seed and a number k draw. */
goal hand_at(const double q[N]);
void draw_angles(uint64_t seed, uint32_t k, double q[N]);

/* Whether LOWERS and UPPERS are those that the text has from the URDF. */
bool limits_match();

/* Whether results are the same to the bit on the host and on the GPU: the texts are --strict. */
extern const bool IS_STRICT;

#endif
