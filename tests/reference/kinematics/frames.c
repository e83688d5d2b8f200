#include "reference/kinematics/frames.h"

#include <stdlib.h>
#include <string.h>

#include "reference/forward.h"
#include "reference/read.h"
#include "reference/tree.h"

struct reference_pose reference_shift(wide x, wide y, wide z)
{
	return (struct reference_pose){{{1, 0, 0, x}, {0, 1, 0, y}, {0, 0, 1, z}, {0, 0, 0, 1}}};
}

static struct reference_pose compose(struct reference_pose a, struct reference_pose b)
{
	struct reference_pose c = {0};

	for (int i = 0; i < 4; i++)
		for (int j = 0; j < 4; j++)
			for (int k = 0; k < 4; k++)
				c.m[i][j] += a.m[i][k] * b.m[k][j];
	return c;
}

static struct reference_pose turned(struct d3_mat r)
{
	struct reference_pose t = reference_shift(0, 0, 0);

	for (int i = 0; i < 9; i++)
		t.m[i / 3][i % 3] = r.m[i / 3][i % 3];
	return t;
}

struct reference_pose reference_origin(const wide xyz[3], const wide rpy[3])
{
	return compose(reference_shift(xyz[0], xyz[1], xyz[2]), turned(d3_rpy(rpy)));
}

struct reference_frame reference_frame_named(const struct reference *r, const char *name)
{
	struct reference_frame f = {-1, reference_shift(0, 0, 0)};

	for (int i = 0; i < r->nj; i++)
		if (!strcmp(r->joints[i].link, name) || (i && f.entry < 0 && !strcmp(r->joints[i].name, name)))
			f.entry = i;
	return f;
}

// ---- poses ----

// [r^T, -r^T [p]] of a motion transform, back to r and p.
static struct reference_pose placed(const struct d6_mat *x)
{
	struct d3_mat r, corner, cross;
	struct reference_pose t;

	for (int i = 0; i < 9; i++) {
		r.m[i % 3][i / 3] = x->m[i / 3][i % 3];
		corner.m[i / 3][i % 3] = -x->m[i / 3][3 + i % 3];
	}
	cross = d3_mul(r, corner);
	t = turned(r);
	t.m[0][3] = cross.m[2][1];
	t.m[1][3] = cross.m[0][2];
	t.m[2][3] = cross.m[1][0];
	return t;
}

static struct reference_pose joint_pose(const struct reference_joint *j, const struct reference_link *l, const wide *q)
{
	const wide *n = l->axis.x, *x = l->plane[0].x, *y = l->plane[1].x;

	switch (j->type) {
	case REFERENCE_REVOLUTE:
	case REFERENCE_CONTINUOUS:
		return turned(d3_about(l->axis, wide_sin(q[0]), wide_cos(q[0])));
	case REFERENCE_PRISMATIC:
		return reference_shift(q[0] * n[0], q[0] * n[1], q[0] * n[2]);
	case REFERENCE_FLOATING:
		return compose(reference_shift(q[0], q[1], q[2]), turned(d3_quaternion(q + 3)));
	case REFERENCE_PLANAR:
		return compose(reference_shift(q[0] * x[0] + q[1] * y[0], q[0] * x[1] + q[1] * y[1],
			q[0] * x[2] + q[1] * y[2]),
		                         turned(d3_about(l->axis, wide_sin(q[2]), wide_cos(q[2]))));
	case REFERENCE_FIXED:
		break;
	}
	return reference_shift(0, 0, 0);
}

// Of all links, and of the frames of their joints at q = 0.
static void all_poses(const struct reference *r, const wide *q, struct reference_pose *links, struct reference_pose *joints)
{
	for (int i = 0; i < r->nj; i++) {
		const struct reference_joint *j = &r->joints[i], *d = &r->joints[j->driver];
		wide own[7] = {0};

		for (int k = 0; k < d->nq; k++)
			own[k] = j->multiplier * q[d->iq + k] + j->offset;
		joints[i] = placed(&r->links[i].tree);
		if (i)
			joints[i] = compose(links[j->parent], joints[i]);
		links[i] = compose(joints[i], joint_pose(j, &r->links[i], own));
	}
}

void reference_poses(const struct reference *r, const wide *q, struct reference_pose *out)
{
	struct reference_pose *joints = raw_memory(NULL, (size_t)r->nj, sizeof *joints);

	all_poses(r, q, out, joints);
	free(joints);
}

struct reference_pose reference_pose(const struct reference *r, const struct reference_frame *f, const wide *q)
{
	struct reference_pose *links = raw_memory(NULL, (size_t)r->nj, sizeof *links), out;

	reference_poses(r, q, links);
	out = compose(links[f->entry], f->at);
	free(links);
	return out;
}

// ---- Jacobians ----

static void cross(const wide *a, const wide *b, wide *out)
{
	out[0] = a[1] * b[2] - a[2] * b[1];
	out[1] = a[2] * b[0] - a[0] * b[2];
	out[2] = a[0] * b[1] - a[1] * b[0];
}

static void apply(const struct reference_pose *t, const wide *v, wide *out)
{
	for (int i = 0; i < 3; i++)
		out[i] = t->m[i][0] * v[0] + t->m[i][1] * v[1] + t->m[i][2] * v[2];
}

// What one unit of speed does at point p: a slide along v, or a turn about v through c.
static void add_slide(const wide *v, wide factor, int nv, wide *column)
{
	for (int i = 0; i < 3; i++)
		column[i * nv] += factor * v[i];
}

static void add_turn(const wide *v, const wide *c, const wide *p, wide factor, int nv, wide *column)
{
	wide arm[3] = {p[0] - c[0], p[1] - c[1], p[2] - c[2]}, linear[3];

	cross(v, arm, linear);
	add_slide(linear, factor, nv, column);
	add_slide(v, factor, nv, column + 3 * nv);
}

// The columns of one joint, of a point p of a link that it carries; `before` and `after` are the joint's frame and the link's.
static void add_joint(const struct reference_joint *j, const struct reference_link *l, const struct reference_pose *before,
                      const struct reference_pose *after, const wide *p, int nv, wide *column)
{
	const wide c[3] = {after->m[0][3], after->m[1][3], after->m[2][3]};
	wide v[3];

	apply(before, l->axis.x, v);
	if (j->type == REFERENCE_REVOLUTE || j->type == REFERENCE_CONTINUOUS)
		add_turn(v, c, p, j->multiplier, nv, column);
	if (j->type == REFERENCE_PRISMATIC)
		add_slide(v, j->multiplier, nv, column);
	if (j->type == REFERENCE_PLANAR) {
		add_turn(v, c, p, 1, nv, column + 2);
		for (int k = 0; k < 2; k++) {
			apply(before, l->plane[k].x, v);
			add_slide(v, 1, nv, column + k);
		}
	}
	for (int k = 0; k < 6 && j->type == REFERENCE_FLOATING; k++) {
		for (int i = 0; i < 3; i++)
			v[i] = after->m[i][k % 3];
		if (k < 3)
			add_slide(v, 1, nv, column + k);
		else
			add_turn(v, c, p, 1, nv, column + k);
	}
}

// From the ground's axes at the frame's origin to what is asked for.
static void express(const struct reference_pose *t, enum reference_axes axes, int nv, wide *column)
{
	const wide p[3] = {t->m[0][3], t->m[1][3], t->m[2][3]};
	wide v[3], w[3], moved[3];

	for (int i = 0; i < 3; i++) {
		v[i] = column[i * nv];
		w[i] = column[(3 + i) * nv];
	}
	if (axes == REFERENCE_WORLD) {
		cross(p, w, moved);
		add_slide(moved, 1, nv, column);
	}
	for (int i = 0; i < 3 && axes == REFERENCE_LINK; i++) {
		column[i * nv] = t->m[0][i] * v[0] + t->m[1][i] * v[1] + t->m[2][i] * v[2];
		column[(3 + i) * nv] = t->m[0][i] * w[0] + t->m[1][i] * w[1] + t->m[2][i] * w[2];
	}
}

void reference_jacobian(const struct reference *r, const struct reference_frame *f, enum reference_axes axes, const wide *q,
                        wide *J)
{
	struct reference_pose *links = raw_memory(NULL, 2 * (size_t)r->nj, sizeof *links), *joints = links + r->nj, t;

	all_poses(r, q, links, joints);
	t = compose(links[f->entry], f->at);
	const wide p[3] = {t.m[0][3], t.m[1][3], t.m[2][3]};

	memset(J, 0, 6 * (size_t)r->nv * sizeof *J);
	for (int i = f->entry; i >= 0; i = r->joints[i].parent)
		if (r->joints[i].type != REFERENCE_FIXED)
			add_joint(&r->joints[i], &r->links[i], &joints[i], &links[i], p, r->nv,
				J + r->joints[r->joints[i].driver].iv);
	for (int k = 0; k < r->nv; k++)
		express(&t, axes, r->nv, J + k);
	free(links);
}

wide reference_opspace_inverse(struct reference *r, const struct reference_frame *f, enum reference_axes axes,
                               const char *held, const wide *q, wide *out)
{
	int n = r->nv;
	wide *J = raw_memory(NULL, (size_t)(6 * n + n * n), sizeof *J), *X = J + 6 * n, least = reference_inverse(r, held, q, X);

	reference_jacobian(r, f, axes, q, J);
	for (int i = 0; i < 36; i++) {
		out[i] = 0;
		for (int k = 0; k < n; k++)
			for (int l = 0; l < n; l++)
				out[i] += J[i / 6 * n + k] * X[k * n + l] * J[i % 6 * n + l];
	}
	free(J);
	return least;
}

// ---- rates ----

// Body twist (v, w) and its derivative (a, b): p = p0 + R (v t + (a + w x v) t^2/2), R exp(w t + b t^2/2).
static void travel_floating(const wide *q, const wide *v, const wide *a, wide t, wide *out)
{
	struct reference_pose r = turned(d3_quaternion(q + 3));
	wide local[3], u[3], side[3], moved[3], half, s;

	cross(v + 3, v, side);
	for (int i = 0; i < 3; i++) {
		local[i] = v[i] * t + (a[i] + side[i]) * t * t / 2;
		u[i] = (v[3 + i] * t + a[3 + i] * t * t / 2) / 2;
	}
	apply(&r, local, moved);
	half = wide_sqrt(u[0] * u[0] + u[1] * u[1] + u[2] * u[2]);
	s = half > 0 ? wide_sin(half) / half : 1;
	cross(q + 3, u, side);
	for (int i = 0; i < 3; i++) {
		out[i] = q[i] + moved[i];
		out[3 + i] = q[3 + i] * wide_cos(half) + s * (q[6] * u[i] + side[i]);
	}
	out[6] = q[6] * wide_cos(half) - s * (q[3] * u[0] + q[4] * u[1] + q[5] * u[2]);
}

// The state on the curve through q with velocity qd and acceleration qdd, at time t; the velocity there is qd + t qdd.
static void travel(const struct reference *r, const wide *q, const wide *qd, const wide *qdd, wide t, wide *out)
{
	for (int i = 0; i < r->nj; i++) {
		const struct reference_joint *j = &r->joints[i];

		if (j->nq == 7)
			travel_floating(q + j->iq, qd + j->iv, qdd + j->iv, t, out + j->iq);
		for (int k = 0; k < j->nq && j->nq < 7; k++)
			out[j->iq + k] = q[j->iq + k] + qd[j->iv + k] * t + qdd[j->iv + k] * t * t / 2;
	}
}

void reference_rate(const struct reference *r, const wide *q, const wide *qd, const wide *qdd, reference_curve *f,
                    void *context, int n, wide *out)
{
	static const wide weights[4] = {WIDE_C(4.0) / 5, -WIDE_C(1.0) / 5, WIDE_C(4.0) / 105, -WIDE_C(1.0) / 280};
	wide *p = raw_memory(NULL, (size_t)(r->nq + r->nv + n), sizeof *p), *v = p + r->nq, *x = v + r->nv;

	memset(out, 0, (size_t)n * sizeof *out);
	for (int step = -4; step <= 4; step++) {
		const wide t = (wide)step * REFERENCE_STEP;

		if (step == 0)
			continue;
		travel(r, q, qd, qdd, t, p);
		for (int k = 0; k < r->nv; k++)
			v[k] = qd[k] + t * qdd[k];
		f(context, p, v, x);
		for (int k = 0; k < n; k++)
			out[k] += weights[abs(step) - 1] * (step < 0 ? -x[k] : x[k]) / REFERENCE_STEP;
	}
	free(p);
}

struct moving {
	const struct reference *r;
	const struct reference_frame *f;
	enum reference_axes axes;
	wide *J;
};

static void twist(void *context, const wide *q, const wide *qd, wide *out)
{
	const struct moving *m = context;

	reference_jacobian(m->r, m->f, m->axes, q, m->J);
	for (int i = 0; i < 6; i++) {
		out[i] = 0;
		for (int k = 0; k < m->r->nv; k++)
			out[i] += m->J[i * m->r->nv + k] * qd[k];
	}
}

void reference_acceleration(const struct reference *r, const struct reference_frame *f, enum reference_axes axes,
                            const wide *q, const wide *qd, const wide *qdd, wide *out)
{
	struct moving m = {r, f, axes, raw_memory(NULL, 6 * (size_t)r->nv, sizeof(wide))};

	reference_rate(r, q, qd, qdd, twist, &m, 6, out);
	free(m.J);
}
