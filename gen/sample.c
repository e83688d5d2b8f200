/* erand48 */
#define _XOPEN_SOURCE 700
#include "sample.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

struct range {
	double lower, upper;
};

static const double PI = 3.14159265358979323846;

const struct sample_options SAMPLE_EFFECTS = {.seed = 1, .count = 100, .qd_range = 3, .qdd_range = 10};

static double draw(unsigned short seed[3], struct range r)
{
	return r.lower + (r.upper - r.lower) * erand48(seed);
}

static struct range range_around(double size)
{
	return (struct range){-size, size};
}

/* Of the row of a revolute, continuous or prismatic joint. */
static struct range position_range(const struct joint *j)
{
	int limited = j->has_limits && j->lower < j->upper && fabs(j->lower) <= SAMPLE_LIMIT && fabs(j->upper) <= SAMPLE_LIMIT;

	if (limited && j->type != JOINT_CONTINUOUS)
		return (struct range){j->lower, j->upper};
	return range_around(j->type == JOINT_PRISMATIC ? 1 : PI);
}

static struct range velocity_range(const struct joint *j, double otherwise)
{
	int limited = j && j->has_limits && j->velocity > 0 && j->velocity <= SAMPLE_LIMIT;

	return range_around(limited ? j->velocity : otherwise);
}

/* A uniform rotation from three uniform numbers (Shoemake, Uniform random rotations, Graphics Gems III, 1992). */
static void draw_quaternion(unsigned short seed[3], double *q)
{
	double u = erand48(seed), a = 2 * PI * erand48(seed), b = 2 * PI * erand48(seed);

	q[0] = sqrt(1 - u) * sin(a);
	q[1] = sqrt(1 - u) * cos(a);
	q[2] = sqrt(u) * sin(b);
	q[3] = sqrt(u) * cos(b);
}

static void draw_position(unsigned short seed[3], const struct tree_joint *t, const struct joint *j, double *q)
{
	if (t->type == JOINT_FLOATING || t->type == JOINT_PLANAR) {
		for (int i = 0; i < (t->type == JOINT_FLOATING ? 3 : 2); i++)
			q[i] = draw(seed, range_around(1));
		if (t->type == JOINT_FLOATING)
			draw_quaternion(seed, q + 3);
		else
			q[2] = draw(seed, range_around(PI));
		return;
	}
	q[0] = draw(seed, position_range(j));
}

static void draw_state(unsigned short seed[3], const struct robot *r, const struct tree *tree, const struct sample_options *o,
	double *q, double *qd, double *qdd)
{
	for (int i = 0; i < tree->joint_count; i++) {
		const struct tree_joint *t = &tree->joints[i];
		const struct joint *j = tree_joint_of(r, tree, i);

		draw_position(seed, t, j, q + t->iq);
		for (int k = t->iv; k < t->iv + t->nv; k++) {
			qd[k] = draw(seed, velocity_range(j, o->qd_range));
			qdd[k] = draw(seed, range_around(o->qdd_range));
		}
	}
}

int sample_states(struct states *s, const struct robot *r, const struct tree *t, const struct sample_options *o)
{
	size_t nq = (size_t)t->nq, nv = (size_t)t->nv;
	unsigned short seed[3] = {(unsigned short)o->seed, (unsigned short)(o->seed >> 16), (unsigned short)(o->seed >> 32)};

	*s = (struct states){.count = o->count, .nq = nq, .nv = nv, .q = calloc(o->count, nq * sizeof(double)),
		.qd = calloc(o->count, nv * sizeof(double)), .qdd = calloc(o->count, nv * sizeof(double))};
	if (!s->q || !s->qd || !s->qdd) {
		sample_free(s);
		return 0;
	}
	for (size_t k = 0; k < o->count; k++)
		draw_state(seed, r, t, o, s->q + k * nq, s->qd + k * nv, s->qdd + k * nv);
	return 1;
}

double sample_input(const struct states *s, const struct tree *t, const struct argument *x, int row, size_t state)
{
	size_t i = (size_t)row;

	if (!strcmp(x->name, "q"))
		return s->q[state * s->nq + i];
	if (!strcmp(x->name, "qd"))
		return s->qd[state * s->nv + i];
	if (!strcmp(x->name, "qdd"))
		return s->qdd[state * s->nv + i];
	for (int k = 0; k < t->task.freed_count; k++)
		if (!strcmp(x->name, t->task.freed[k].argument))
			return (double)t->task.freed[k].nominal[row];
	return 1;
}

void sample_free(struct states *s)
{
	free(s->q);
	free(s->qd);
	free(s->qdd);
	*s = (struct states){0};
}
