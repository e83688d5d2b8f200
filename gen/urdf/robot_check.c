#include "urdf/robot_check.h"
#include <math.h>

/* Eigenvalues of a symmetric 3x3 matrix (xx xy xz yy yz zz), ascending, by Jacobi rotations: each takes one
   off-diagonal element to zero; five sweeps are more than doubles need. */
static void eigenvalues(const struct within in[6], double out[3])
{
	const double xx = (double)in[0].x, xy = (double)in[1].x, xz = (double)in[2].x, yz = (double)in[4].x;
	double m[3][3] = {{xx, xy, xz}, {xy, (double)in[3].x, yz}, {xz, yz, (double)in[5].x}};

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

/* No body has another inertia: no principal moment is negative and none exceeds the sum of the other two. Moments are
   zero that are no more than rounding beside the largest; a point mass has none, and one alone is given for what turns
   about one axis, or to fill the place. The last tolerance forgives the rounding of the file's digits. */
static void check_inertia(const struct link *l, long line, const struct diagnostic *p)
{
	const char *fault = NULL;
	double eigen[3], largest;

	eigenvalues(l->inertia, eigen);
	largest = fmax(fabs(eigen[0]), fabs(eigen[2]));
	for (int i = 0; i < 3; i++)
		if (fabs(eigen[i]) <= 1e-14 * largest)
			eigen[i] = 0;
	if (eigen[0] < 0)
		fault = "is not positive definite";
	else if (eigen[1] > 0 && eigen[0] + eigen[1] < (1 - 1e-6) * eigen[2])
		fault = "violates the triangle inequality";
	if (fault)
		diagnostic_warning(p, line, "link '%s': its inertia %s (eigenvalues %.7g %.7g %.7g); used as given", l->name,
			fault, eigen[0], eigen[1], eigen[2]);
}

static void check_link(const struct link *l, long line, const struct diagnostic *p)
{
	if (l->mass.x < 0)
		diagnostic_error(
			p, RNEAGEN_NUMBER, line, "link '%s': its mass %g is negative; correct it", l->name, (double)l->mass.x);
	check_inertia(l, line, p);
}

static int has_axis(enum joint_type type)
{
	return type != JOINT_FIXED && type != JOINT_FLOATING;
}

/* One coordinate: it can mimic and be mimicked. */
static int has_one_coordinate(enum joint_type type)
{
	return type == JOINT_REVOLUTE || type == JOINT_CONTINUOUS || type == JOINT_PRISMATIC;
}

static void check_axis(const struct joint *j, long line, const struct diagnostic *p)
{
	double norm = hypot(hypot((double)j->axis[0].x, (double)j->axis[1].x), (double)j->axis[2].x);

	if (norm == 0)
		diagnostic_error(p, RNEAGEN_NUMBER, line, "joint '%s': its axis is 0 0 0; give a direction", j->name);
	else if (fabs(norm - 1) > 1e-12)
		diagnostic_warning(p, line, "joint '%s': its axis is %.*g long, not 1; normalised", j->name,
			fabs(norm - 1) < 1e-9 ? 13 : 10, norm);
}

/* What would drive a joint, not brake it. */
static void check_loss(const struct joint *j, const char *what, double loss, long line, const struct diagnostic *p)
{
	if (loss < 0)
		diagnostic_warning(p, line, "joint '%s': its %s %g is negative; used as given where %s is asked for", j->name, what, loss,
			what);
}

static void check_mimic(struct joint *j, long line, const struct diagnostic *p)
{
	const struct joint *driver = &p->robot->joints[j->driver];

	if (j == driver)
		diagnostic_error(p, RNEAGEN_MIMIC, line, "joint '%s' mimics itself; name another joint", j->name);
	else if (j->type == JOINT_FIXED) {
		diagnostic_warning(
			p, line, "joint '%s' is fixed; its <mimic> of joint '%s' is ignored", j->name, driver->name);
		j->driver = -1;
	} else if (!has_one_coordinate(j->type))
		diagnostic_error(p, RNEAGEN_MIMIC, line, "joint '%s' is %s and cannot mimic joint '%s'; remove its <mimic>",
			j->name, joint_type_name(j->type), driver->name);
	else if (!has_one_coordinate(driver->type))
		diagnostic_error(p, RNEAGEN_MIMIC, line,
			"joint '%s' mimics joint '%s', which is %s; name a revolute, continuous or prismatic joint",
			j->name, driver->name, joint_type_name(driver->type));
}

/* A chain of drivers that still goes on after as many joints as there are is in a cycle. */
static void check_mimic_chain(int j, const struct outline *o, const struct diagnostic *p)
{
	const struct joint *joints = p->robot->joints;

	for (int steps = p->robot->joint_count; steps > 0 && joints[j].driver >= 0; steps--)
		j = joints[j].driver;
	if (joints[j].driver >= 0)
		diagnostic_error(p, RNEAGEN_MIMIC, o->joints[j].id.line,
			"joints '%s' and '%s' mimic each other in a cycle; let one of them lead", joints[j].name,
			joints[joints[j].driver].name);
}

/* A joint that moves no inertial has torque 0: seldom meant. */
static void check_massless(const struct outline *o, const struct diagnostic *p)
{
	struct robot *r = p->robot;
	char *moves = arena_alloc(p->arena, (size_t)r->joint_count, 1);

	if (!moves)
		return;
	for (int i = 0; i < r->link_count; i++)
		if (r->links[i].has_inertial)
			for (int up = r->links[i].parent_joint; up >= 0 && !moves[up];) {
				moves[up] = 1;
				up = r->links[r->joints[up].parent].parent_joint;
			}
	for (int i = 0; i < r->joint_count; i++)
		if (!moves[i] && r->joints[i].type != JOINT_FIXED)
			diagnostic_warning(p, o->joints[i].id.line,
				"joint '%s' moves no mass: link '%s' and all beyond have no <inertial>; its torque is 0",
				r->joints[i].name, r->links[r->joints[i].child].name);
}

enum rneagen_code robot_check(const struct outline *o, const struct diagnostic *p)
{
	struct robot *r = p->robot;

	for (int i = 0; i < r->link_count; i++)
		check_link(&r->links[i], o->links[i].id.line, p);
	for (int i = 0; i < r->joint_count; i++) {
		check_loss(&r->joints[i], "damping", (double)r->joints[i].damping.x, o->joints[i].id.line, p);
		check_loss(&r->joints[i], "friction", (double)r->joints[i].friction.x, o->joints[i].id.line, p);
		if (has_axis(r->joints[i].type))
			check_axis(&r->joints[i], o->joints[i].id.line, p);
		if (r->joints[i].driver >= 0)
			check_mimic(&r->joints[i], o->joints[i].id.line, p);
	}
	for (int i = 0; i < r->joint_count; i++)
		check_mimic_chain(i, o, p);
	check_massless(o, p);
	if (p->arena->failed)
		error_memory(p->error);
	return p->error->code;
}
