/* controller SECONDS OFFSET TRACE: a KUKA iiwa 14 moved from pose to pose by computed torque at 1 kHz,

     tau = ID(q, qd, qdd) + damping (qd + qdd T/2),   qdd = qdd_r + KD (qd_r - qd) + KP (q_r - q),   T = 1 ms,

   beginning OFFSET rad away from the first pose. The arm is simulated (plant.c): where control() stands between a state
   and plant_move(), a driver's read and write would stand. The loop allocates nothing and writes no file; what it did
   goes to TRACE when it is over. The exit status tells whether the arm followed within its limits. */
#define _POSIX_C_SOURCE 200809L
#include "plant.h"
#include "trace.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

enum { RATE = 1000, TICK_LIMIT = 60 * RATE, SETTLED = RATE }; /* Hz, ticks, ticks */

static struct record records[TICK_LIMIT];
static const double KP = 400, KD = 40;	   /* 1/s^2, 1/s: two poles at -20/s */
static const double MARGIN = 0.02;	   /* rad kept from every joint limit */
static const double TRACKING_LIMIT = 1e-3; /* rad, once settled */

/* iiwa14.urdf: <dynamics damping>, N m s/rad; its limits are tables of the generated header. With --damping the text has this
   term. */
static const double DAMPING[N] = {0.5, 0.5, 0.5, 0.5, 0.5, 0.5, 0.5};

/* Where to go, again and again; the third pose asks for more than joint 4 has. */
static const double POSES[][N] = {
	{0, 0.5, 0, -1.5, 0, 1, 0},
	{1.2, 0.9, -0.6, -1.1, 0.8, -0.7, 2},
	{-0.8, 0.3, 1.1, -2.4, -1, 1.3, -1.5},
	{0.4, -1, 0.5, 1.2, 1.5, 0.9, 0.5},
};
enum { POSE_COUNT = sizeof POSES / sizeof *POSES };

struct reference {
	double q[N], qd[N], qdd[N];
};

/* From one pose to the next in `duration` seconds. */
struct move {
	double from[N], to[N], duration, time;
	int next;
};

static double clamp(double x, double lower, double upper)
{
	return fmin(fmax(x, lower), upper);
}

/* A quintic's peak velocity is 15/8 of its mean; the slowest joint to get there within its limit sets the time. */
static void move_begin(struct move *m, const double from[N])
{
	m->time = m->duration = 0;
	for (int j = 0; j < N; j++) {
		m->from[j] = from[j];
		m->to[j] = clamp(POSES[m->next][j], iiwa14_q_min[j] + MARGIN, iiwa14_q_max[j] - MARGIN);
		m->duration = fmax(m->duration, 1.875 * fabs(m->to[j] - m->from[j]) / iiwa14_qd_max[j]);
	}
	m->duration = fmax(m->duration * 1.05, 0.1); /* a little speed left for the feedback */
	m->next = (m->next + 1) % POSE_COUNT;
}

/* s(x) = 10 x^3 - 15 x^4 + 6 x^5 from 0 to 1, at rest at both ends. */
static void move_advance(struct move *m, struct reference *r)
{
	double x = fmin(m->time / m->duration, 1), rate = 1 / m->duration;
	double s = x * x * x * (10 + x * (6 * x - 15)), sd = 30 * x * x * (1 - x) * (1 - x) * rate;
	double sdd = 60 * x * (1 - x) * (1 - 2 * x) * rate * rate;

	for (int j = 0; j < N; j++) {
		r->q[j] = m->from[j] + s * (m->to[j] - m->from[j]);
		r->qd[j] = sd * (m->to[j] - m->from[j]);
		r->qdd[j] = sdd * (m->to[j] - m->from[j]);
	}
	m->time += 1.0 / RATE;
	if (x >= 1)
		move_begin(m, m->to);
}

/* The controller: torques for a measured state, never above the joints' effort. Returns whether one was held there. */
static int control(const struct state *s, const struct reference *r, double tau[N])
{
	double qdd[N];
	int limited = 0;

	for (int j = 0; j < N; j++)
		qdd[j] = r->qdd[j] + KD * (r->qd[j] - s->qd[j]) + KP * (r->q[j] - s->q[j]);
	iiwa14_rnea(s->q, s->qd, qdd, tau);
	for (int j = 0; j < N; j++) {
		double wanted = tau[j] + DAMPING[j] * (s->qd[j] + qdd[j] * 0.5 / RATE);

		tau[j] = clamp(wanted, -iiwa14_tau_max[j], iiwa14_tau_max[j]);
		limited |= tau[j] != wanted;
	}
	return limited;
}

/* The joint beyond its limit, or -1; not a number counts as beyond. */
static int outside(const struct state *s)
{
	for (int j = 0; j < N; j++)
		if (!(s->q[j] >= iiwa14_q_min[j] && s->q[j] <= iiwa14_q_max[j]))
			return j;
	return -1;
}

static double seconds_now(void)
{
	struct timespec t;

	clock_gettime(CLOCK_MONOTONIC, &t);
	return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

/* Returns how many ticks were done: fewer than asked for if a joint left its range; a brake would be applied then. */
static size_t loop(struct state *s, size_t ticks)
{
	struct move move = {0};
	struct reference r;

	move_begin(&move, POSES[0]);
	for (size_t k = 0; k < ticks; k++) {
		struct record *t = &records[k];
		double start = seconds_now();

		if (outside(s) >= 0)
			return k;
		move_advance(&move, &r);
		t->limited = control(s, &r, t->tau);
		t->seconds = seconds_now() - start;
		for (int j = 0; j < N; j++) {
			t->error[j] = r.q[j] - s->q[j];
			t->effort[j] = t->tau[j] / iiwa14_tau_max[j];
		}
		plant_move(s, t->tau, DAMPING, 1.0 / RATE);
	}
	return ticks;
}

int main(int argc, char **argv)
{
	double seconds = argc == 4 ? atof(argv[1]) : 0;
	size_t asked = seconds > 0 && seconds <= TICK_LIMIT / RATE ? (size_t)(seconds * RATE) : 0, done;
	struct state s = {0};
	struct summary sum;

	if (asked <= SETTLED) {
		fprintf(stderr, "usage: controller SECONDS OFFSET TRACE, with SECONDS above %d and up to %d\n",
			SETTLED / RATE, TICK_LIMIT / RATE);
		return 2;
	}
	for (int j = 0; j < N; j++)
		s.q[j] = POSES[0][j] + atof(argv[2]);
	done = loop(&s, asked);
	if (done < asked)
		printf("stopped after %zu ms: joint %d is beyond its limit\n", done, outside(&s) + 1);
	sum = trace_summary(records, done, SETTLED);
	printf("%zu calls, of %d us each: median %.2f us, 99.9 %% within %.2f us, worst %.2f us\n", done,
		1000000 / RATE, 1e6 * sum.median, 1e6 * sum.most, 1e6 * sum.worst);
	printf("torques: at most %.3f of the effort limit, held there in %d ticks\n", sum.effort, sum.limited);
	printf("tracking error after %d s: at most %.3f mrad\n", SETTLED / RATE, 1e3 * sum.error);
	return trace_write(argv[3], records, done, RATE) || done < asked || !(sum.error <= TRACKING_LIMIT);
}
