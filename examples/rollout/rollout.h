#ifndef ROLLOUT_H
#define ROLLOUT_H
/* What rollout.cpp asks of rollout.cu: a controller that samples. Arrays of joints are in the order of panda.urdf. */

#include <cstddef>
#include <cstdint>
#include <vector>

constexpr int N = 7;
constexpr double DT = 0.01;	/* s: a step of a rollout, and the time from one command to the next */
constexpr double LAMBDA = 0.02; /* a rollout that costs so much more than the best weighs 1/e of it */
constexpr double DEVIATION = 1; /* rad/s: of the noise in the plan's speeds */
constexpr double WEIGHT_ANGLE = 20, WEIGHT_SPEED = 0.2, WEIGHT_LIMIT = 1000; /* a second: 1/rad^2, s^2/rad^2, 1/rad^2 */

/* rad: where the arm begins, and where it swings from */
#define READY 0, -0.785, 0, -2.356, 0, 1.571, 0.785
#define SWING 0.3, 0.9, -0.4, -1.2, 0.7, 1.1, 0.5

/* panda.urdf: <limit lower upper velocity effort>; what the servos of the joints make of a speed, N m s/rad */
#define LOWERS -2.8973, -1.7628, -2.8973, -3.0718, -2.8973, -0.0175, -2.8973
#define UPPERS 2.8973, 1.7628, 2.8973, -0.0698, 2.8973, 3.7525, 2.8973
#define SPEEDS 2.175, 2.175, 2.175, 2.175, 2.61, 2.61, 2.61
#define EFFORTS 87, 87, 87, 87, 12, 12, 12
#define GAINS 3, 12, 5, 6, 0.4, 0.5, 0.06

enum integrator { EULER, RK4 }; /* EULER: semi-implicit, qd first and q by the new qd */

struct arm {
	double q[N], qd[N];
};

struct settings {
	size_t rollouts;
	int steps;
	integrator method;
	bool is_f64;
	uint64_t seed;
};

/* Samples speeds around a plan, and moves the plan to the mean of the samples, the cheaper the heavier. The plan begins
   with rest. */
struct controller {
	virtual ~controller() = default;
	/* The speeds to command for the next DT, where goals[i] is for (i + 1) DT from now, i < steps. Returns 1,
	   having said why, if that cannot be done. */
	virtual int next(uint32_t tick, const arm &now, const std::vector<arm> &goals, double speed[N]) = 0;
	/* What the rollouts of the last call cost. */
	virtual int costs(std::vector<double> &to) = 0;
	/* The rollouts, and moving the plan: of all calls but the first, which may have to load a kernel. */
	double rollout_seconds = 0, plan_seconds = 0;
	int calls = 0;

      protected:
	void took(uint32_t tick, double rollouts, double plan)
	{
		if (tick == 0)
			return;
		rollout_seconds += rollouts;
		plan_seconds += plan;
		calls++;
	}
};

/* On the host, by all threads of OpenMP, or on the GPU; NULL, having said why, if that cannot be. */
controller *host_controller(const settings &s);
controller *gpu_controller(const settings &s);

/* The registers and the spilled bytes of a thread of the GPU's rollouts. */
int gpu_registers(const settings &s, int *registers, size_t *spilled);

/* The arm itself moves for DT: in f64, by Runge and Kutta's method in steps of DT / 10. */
void arm_moves(arm &a, const double speed[N]);

/* How far the energy of an arm is off, at most, while it swings freely for a second in steps of dt: J. */
double swing_drift(integrator method, double dt);

/* Whether LOWERS, UPPERS, SPEEDS and EFFORTS are those that the text has from the URDF. */
bool limits_match();

/* Whether results are the same to the bit on the host and on the GPU: the texts are --strict. */
extern const bool IS_STRICT;

#endif
