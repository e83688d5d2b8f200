/* gravity: a Franka Panda that floats. Each millisecond its motors are given

     tau = g(q) - DAMPING qd,

   g the torques that hold it still where it is, and nothing of where it ought to be: it stays where a hand leaves it.
   The text of g has nothing else in it (CMakeLists.txt): joint 1, whose axis is upright and carries no weight, and the
   fingers are held, velocities and accelerations are left out, and under a hundred operations of single precision
   remain, in a header of a few pages without a table or a heap. The arm that is simulated (plant.c) is the whole model,
   in doubles. For three poses: how far the arm sinks without g, how far a push moves it with g, how far it drifts once
   it has come to rest. The exit status tells whether it stayed where it was left. */
#include "panda_hold_rnea.h"
#include "plant.h"
#include <math.h>
#include <stdio.h>

enum { RATE = 1000, HELD = panda_hold_nq, FIRST = N - HELD }; /* Hz; joints that carry weight, the first of them */

static const double DAMPING[N] = {10, 10, 10, 10, 1, 1, 0.2};  /* N m s/rad, of the controller */
static const double BEARINGS[N] = {3e-3, 3e-3, 3e-3, 3e-3, 3e-3, 3e-3, 3e-3}; /* N m s/rad, panda.urdf: damping */
static const double PUSH[N] = {5, 15, -5, 15, 1, -1, 0.2};       /* N m, for 0.3 s */
static const double DRIFT_LIMIT = 1e-3;				       /* rad in 4 s */

static const double POSES[][N] = {
	{0, 0, 0, -1.57, 0, 1.57, 0.785},
	{0.5, 0.8, -0.4, -1.2, 0.6, 2, -0.5},
	{-1, -0.6, 1.1, -2.2, -1.3, 0.8, 1.5},
};
enum { POSE_COUNT = sizeof POSES / sizeof *POSES };

/* The controller, for a measured state. */
static void hold(const struct state *s, double tau[N])
{
	float q[HELD], g[HELD];

	for (int j = 0; j < HELD; j++)
		q[j] = (float)s->q[FIRST + j];
	panda_hold_rnea(q, g);
	for (int j = 0; j < N; j++)
		tau[j] = -DAMPING[j] * s->qd[j];
	for (int j = 0; j < HELD; j++)
		tau[FIRST + j] += (double)g[j];
}

/* Torques of the controller, or of its damping alone, and of the hand, for so many seconds. */
static void run(struct state *s, double seconds, int held, const double push[N])
{
	for (int k = 0; k < (int)(seconds * RATE); k++) {
		double tau[N];

		if (held)
			hold(s, tau);
		for (int j = 0; j < N; j++)
			tau[j] = (held ? tau[j] : -DAMPING[j] * s->qd[j]) + push[j];
		plant_move(s, tau, BEARINGS, 1.0 / RATE);
	}
}

/* The largest angle between two states; not a number counts as far. */
static double distance(const struct state *a, const struct state *b)
{
	double most = 0;

	for (int j = 0; j < N; j++)
		if (!(fabs(a->q[j] - b->q[j]) <= most))
			most = fabs(a->q[j] - b->q[j]);
	return most;
}

static struct state rest_at(const double q[N])
{
	struct state s = {0};

	for (int j = 0; j < N; j++)
		s.q[j] = q[j];
	return s;
}

/* Returns whether the arm stayed where it was left. */
static int try_pose(const double pose[N])
{
	static const double nothing[N];
	const struct state start = rest_at(pose);
	struct state loose = start, s = start, left;
	double still;

	run(&loose, 0.5, 0, nothing);
	run(&s, 1, 1, nothing);
	still = distance(&s, &start);
	run(&s, 0.3, 1, PUSH);
	run(&s, 4, 1, nothing); /* comes to rest */
	left = s;
	run(&s, 4, 1, nothing);
	printf("%20.3f %20.3f %20.3f %20.6f\n", 1e3 * distance(&loose, &start), 1e3 * still, 1e3 * distance(&left, &start),
		1e3 * distance(&s, &left));
	return still < DRIFT_LIMIT && distance(&left, &start) > 0.1 && distance(&s, &left) < DRIFT_LIMIT;
}

int main(void)
{
	int good = 1;

	printf("%20s %20s %20s %20s\n", "0.5 s alone, mrad", "1 s held, mrad", "pushed, mrad", "4 s afterwards, mrad");
	for (int p = 0; p < POSE_COUNT; p++)
		good &= try_pose(POSES[p]);
	puts(good ? "the arm stays where it is left" : "the arm does not stay where it is left");
	return !good;
}
