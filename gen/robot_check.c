#include "robot_check.h"
#include <math.h>

struct check {
	struct robot *robot;
	const struct outline *outline;
	const char *file;
	struct arena *arena;
	struct rneagen_error *error;
};

/* Eigenvalues of a symmetric 3x3 matrix (xx xy xz yy yz zz), ascending, by Jacobi rotations: each takes one
   off-diagonal element to zero; five sweeps are more than doubles need. */
static void eigenvalues(const double in[6], double out[3])
{
	double m[3][3] = {{in[0], in[1], in[2]}, {in[1], in[3], in[4]}, {in[2], in[4], in[5]}};

	for (int k = 0; k < 15; k++) {
		int p = k % 3 == 2, q = k % 3 == 0 ? 1 : 2, other = 3 - p - q;
		double theta = 0.5 * atan2(2 * m[p][q], m[q][q] - m[p][p]), c = cos(theta), s = sin(theta);
		double pp = m[p][p], qq = m[q][q], pq = m[p][q], po = m[p][other], qo = m[q][other];

		m[p][p] = c * c * pp - 2 * s * c * pq + s * s * qq;
		m[q][q] = s * s * pp + 2 * s * c * pq + c * c * qq;
		m[p][q] = m[q][p] = 0;
		m[p][other] = m[other][p] = c * po - s * qo;
		m[q][other] = m[other][q] = s * po + c * qo;
	}
	out[0] = fmin(m[0][0], fmin(m[1][1], m[2][2]));
	out[2] = fmax(m[0][0], fmax(m[1][1], m[2][2]));
	out[1] = fmax(fmin(m[0][0], m[1][1]), fmin(fmax(m[0][0], m[1][1]), m[2][2]));
}

/* No mass distribution has such an inertia: its principal moments are positive and none exceeds the sum of the others.
   All zero is a point mass. The tolerances forgive rounding of the file's digits. */
static void check_inertia(const struct check *c, int index)
{
	const struct link *l = &c->robot->links[index];
	const char *fault = NULL;
	double eigen[3];

	eigenvalues(l->inertia, eigen);
	if (eigen[0] == 0 && eigen[2] == 0)
		return;
	if (eigen[0] <= 1e-14 * eigen[2])
		fault = "not positive definite";
	else if (eigen[0] + eigen[1] < eigen[2] * (1 - 1e-6))
		fault = "not that of any body: one principal moment exceeds the sum of the others";
	if (fault)
		robot_warn(c->robot, c->arena, "%s:%ld: link '%s': its inertia is %s (eigenvalues %g %g %g); used as given", c->file,
			c->outline->links[index].id.line, l->name, fault, eigen[0], eigen[1], eigen[2]);
}

static void check_link(const struct check *c, int index)
{
	const struct link *l = &c->robot->links[index];

	if (l->mass < 0)
		error_set(c->error, RNEAGEN_NUMBER, "%s:%ld: link '%s': mass %g is negative; correct it", c->file,
			c->outline->links[index].id.line, l->name, l->mass);
	else if (l->has_inertial)
		check_inertia(c, index);
}

static void check_axis(const struct check *c, int index)
{
	const struct joint *j = &c->robot->joints[index];
	long line = c->outline->joints[index].id.line;
	double norm = hypot(hypot(j->axis[0], j->axis[1]), j->axis[2]);

	if (j->type == JOINT_FIXED || j->type == JOINT_FLOATING)
		return;
	if (norm == 0)
		error_set(c->error, RNEAGEN_NUMBER, "%s:%ld: joint '%s': its axis is 0 0 0; give a direction", c->file, line,
			j->name);
	else if (fabs(norm - 1) > 1e-12)
		robot_warn(c->robot, c->arena, "%s:%ld: joint '%s': its axis is %.10g long, not 1; normalised", c->file, line,
			j->name, norm);
}

/* A follower must be able to follow and its driver to lead. */
static void check_mimic(const struct check *c, int index)
{
	struct joint *j = &c->robot->joints[index];
	const struct joint *driver = &c->robot->joints[j->driver];
	long line = c->outline->joints[index].id.line;

	if (j->driver == index)
		error_set(c->error, RNEAGEN_MIMIC, "%s:%ld: joint '%s' mimics itself; name another joint", c->file, line, j->name);
	else if (j->type == JOINT_FIXED) {
		robot_warn(c->robot, c->arena, "%s:%ld: joint '%s' is fixed; its <mimic> of joint '%s' is ignored", c->file, line,
			j->name, driver->name);
		j->driver = -1;
	} else if (j->type == JOINT_PLANAR || j->type == JOINT_FLOATING)
		error_set(c->error, RNEAGEN_MIMIC, "%s:%ld: joint '%s' is %s and cannot mimic joint '%s'; remove its <mimic>",
			c->file, line, j->name, joint_type_name(j->type), driver->name);
	else if (driver->type == JOINT_FIXED || driver->type == JOINT_PLANAR || driver->type == JOINT_FLOATING)
		error_set(c->error, RNEAGEN_MIMIC, "%s:%ld: joint '%s' mimics joint '%s', which is %s; name a joint with one angle "
			"or length", c->file, line, j->name, driver->name, joint_type_name(driver->type));
}

/* A chain of drivers that is longer than there are joints is in a cycle. */
static void check_mimic_chain(const struct check *c, int index)
{
	const struct joint *joints = c->robot->joints;
	int steps = c->robot->joint_count, j = index;

	while (steps-- > 0 && joints[j].driver >= 0)
		j = joints[j].driver;
	if (joints[j].driver >= 0)
		error_set(c->error, RNEAGEN_MIMIC, "%s:%ld: joints '%s' and '%s' mimic each other in a cycle; let one of them lead",
			c->file, c->outline->joints[j].id.line, joints[j].name, joints[joints[j].driver].name);
}

/* A joint that moves nothing with mass or inertia has torque 0: seldom meant. */
static enum rneagen_code check_massless(const struct check *c)
{
	struct robot *r = c->robot;
	char *moves = arena_alloc(c->arena, (size_t)r->joint_count, 1);

	if (!moves)
		return error_memory(c->error);
	for (int i = 0; i < r->link_count; i++) {
		if (!r->links[i].has_inertial)
			continue;
		for (int k = i, up; (up = r->links[k].parent_joint) >= 0 && !moves[up]; k = r->joints[up].parent)
			moves[up] = 1;
	}
	for (int i = 0; i < r->joint_count; i++)
		if (!moves[i] && r->joints[i].type != JOINT_FIXED)
			robot_warn(r, c->arena,
				"%s:%ld: joint '%s' moves no mass: link '%s' and all beyond have no <inertial>; its torque is 0", c->file,
				c->outline->joints[i].id.line, r->joints[i].name, r->links[r->joints[i].child].name);
	return RNEAGEN_OK;
}

enum rneagen_code robot_check(
	struct robot *r, const struct outline *o, const char *file, struct arena *a, struct rneagen_error *e)
{
	const struct check c = {r, o, file, a, e};

	for (int i = 0; i < r->link_count; i++)
		check_link(&c, i);
	for (int i = 0; i < r->joint_count; i++) {
		check_axis(&c, i);
		if (r->joints[i].driver >= 0)
			check_mimic(&c, i);
	}
	for (int i = 0; i < r->joint_count; i++)
		check_mimic_chain(&c, i);
	if (!e->code && check_massless(&c))
		return e->code;
	if (a->failed)
		error_memory(e);
	return e->code;
}
