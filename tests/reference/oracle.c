#include "reference/oracle.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static struct link_pose unit_pose(void)
{
	return (struct link_pose){{{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}, {0, 0, 0, 1}}};
}

static struct link_pose compose(struct link_pose a, struct link_pose b)
{
	struct link_pose c = {0};

	for (int i = 0; i < 4; i++)
		for (int j = 0; j < 4; j++)
			for (int k = 0; k < 4; k++)
				c.m[i][j] += a.m[i][k] * b.m[k][j];
	return c;
}

static void cross(const wide *a, const wide *b, wide *out)
{
	out[0] = a[1] * b[2] - a[2] * b[1];
	out[1] = a[2] * b[0] - a[0] * b[2];
	out[2] = a[0] * b[1] - a[1] * b[0];
}

// Columns are the turned basis: e cos + (n x e) sin + n (n . e) (1 - cos).
static struct link_pose turn(const wide *n, wide angle)
{
	struct link_pose t = unit_pose();
	wide s = wide_sin(angle), c = wide_cos(angle);

	for (int k = 0; k < 3; k++) {
		wide e[3] = {k == 0, k == 1, k == 2}, side[3];

		cross(n, e, side);
		for (int i = 0; i < 3; i++)
			t.m[i][k] = e[i] * c + side[i] * s + n[i] * n[k] * (1 - c);
	}
	return t;
}

static struct link_pose shift(wide x, wide y, wide z)
{
	return (struct link_pose){{{1, 0, 0, x}, {0, 1, 0, y}, {0, 0, 1, z}, {0, 0, 0, 1}}};
}

// Fixed axes: roll about x first, then pitch about y, then yaw about z.
static struct link_pose origin(const wide *xyz, const wide *rpy)
{
	static const wide axes[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
	struct link_pose t = shift(xyz[0], xyz[1], xyz[2]);

	for (int i = 2; i >= 0; i--)
		t = compose(t, turn(axes[i], rpy[i]));
	return t;
}

// w + x i + y j + z k turns e into e + 2 w (u x e) + 2 u x (u x e).
static struct link_pose floating(const wide *q)
{
	struct link_pose t = shift(q[0], q[1], q[2]);

	for (int k = 0; k < 3; k++) {
		wide e[3] = {k == 0, k == 1, k == 2}, once[3], twice[3];

		cross(q + 3, e, once);
		cross(q + 3, once, twice);
		for (int i = 0; i < 3; i++)
			t.m[i][k] = e[i] + 2 * q[6] * once[i] + 2 * twice[i];
	}
	return t;
}

static wide length(const wide *v)
{
	return wide_sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
}

// z turned onto n by the least angle: about z x n, or about x where they are opposite.
static struct link_pose planar(const wide *n, const wide *q)
{
	static const wide z[3] = {0, 0, 1};
	wide about[3], sine, half_turn[3] = {1, 0, 0};
	struct link_pose frame = unit_pose(), slide;

	cross(z, n, about);
	sine = length(about);
	for (int i = 0; i < 3 && sine > 0; i++)
		about[i] /= sine;
	if (sine > 0)
		frame = turn(about, atan2l((long double)sine, (long double)n[2]));
	else if (n[2] < 0)
		frame = turn(half_turn, WIDE_PI);
	slide = compose(frame, shift(q[0], q[1], 0));
	return compose(shift(slide.m[0][3], slide.m[1][3], slide.m[2][3]), turn(n, q[2]));
}

static struct link_pose joint_pose(const struct reference_joint *j, const wide *axis, const wide *q)
{
	wide n[3] = {axis[0], axis[1], axis[2]}, size = length(n);

	for (int i = 0; i < 3 && size > 0; i++)
		n[i] /= size;
	switch (j->type) {
	case REFERENCE_PRISMATIC:
		return shift(q[0] * n[0], q[0] * n[1], q[0] * n[2]);
	case REFERENCE_FLOATING:
		return floating(q);
	case REFERENCE_PLANAR:
		return planar(n, q);
	case REFERENCE_FIXED:
		return unit_pose();
	case REFERENCE_REVOLUTE:
	case REFERENCE_CONTINUOUS:
		break;
	}
	return turn(n, q[0]);
}

// A follower's angle by asking its driver, and that one its own.
static wide follow(const struct oracle *o, int entry, const wide *q)
{
	const struct raw_joint *raw = &o->raw.joints[o->source[entry]];
	int i = 1;

	if (o->r->joints[entry].driver == entry)
		return q[o->r->joints[entry].iq];
	while (strcmp(o->r->joints[i].name, raw->mimic))
		i++;
	return raw->multiplier * follow(o, i, q) + raw->offset;
}

void oracle_poses(const struct oracle *o, const wide *q, struct link_pose *out)
{
	for (int i = 0; i < o->r->nj; i++) {
		const struct reference_joint *j = &o->r->joints[i];
		const struct raw_joint *raw = i ? &o->raw.joints[o->source[i]] : NULL;
		wide angle[1] = {j->driver != i ? follow(o, i, q) : 0};
		const wide *x = j->driver != i ? angle : q + j->iq;

		if (!raw)
			out[i] = j->nq ? floating(x) : unit_pose();
		else
			out[i] = compose(compose(out[j->parent], origin(raw->xyz, raw->rpy)),
			                 joint_pose(j, raw->axis, x));
	}
}

// Body twist (v, w) and its derivative (a, b): p = p0 + R (v t + (a + w x v) t^2/2), R exp(w t + b t^2/2).
static void move_floating(const wide *q, const wide *v, const wide *a, wide t, wide *out)
{
	wide turned[3], local[3], u[3], half, s;
	struct link_pose r = floating(q);

	cross(v + 3, v, turned);
	for (int i = 0; i < 3; i++) {
		local[i] = v[i] * t + (a[i] + turned[i]) * t * t / 2;
		u[i] = (v[3 + i] * t + a[3 + i] * t * t / 2) / 2;
	}
	half = length(u);
	s = half > 0 ? wide_sin(half) / half : 1;
	cross(q + 3, u, turned);
	for (int i = 0; i < 3; i++) {
		out[i] = q[i] + r.m[i][0] * local[0] + r.m[i][1] * local[1] + r.m[i][2] * local[2];
		out[3 + i] = q[3 + i] * wide_cos(half) + s * (q[6] * u[i] + turned[i]);
	}
	out[6] = q[6] * wide_cos(half) - s * (q[3] * u[0] + q[4] * u[1] + q[5] * u[2]);
}

void oracle_move(const struct reference *r, const wide *q, const wide *qd, const wide *qdd, wide t, wide *out)
{
	for (int i = 0; i < r->nj; i++) {
		const struct reference_joint *j = &r->joints[i];

		if (j->nq == 7)
			move_floating(q + j->iq, qd + j->iv, qdd + j->iv, t, out + j->iq);
		for (int k = 0; k < j->nq && j->nq < 7; k++)
			out[j->iq + k] = q[j->iq + k] + qd[j->iv + k] * t + qdd[j->iv + k] * t * t / 2;
	}
}

// Central differences of order 8.
void oracle_derivative(const struct oracle *o, const wide *q, const wide *qd, const wide *qdd, int order,
                       struct link_pose *out)
{
	static const wide first[5] = {0, WIDE_C(4.0) / 5, -WIDE_C(1.0) / 5, WIDE_C(4.0) / 105, -WIDE_C(1.0) / 280};
	static const wide second[5] = {-WIDE_C(205.0) / 72, WIDE_C(8.0) / 5, -WIDE_C(1.0) / 5, WIDE_C(8.0) / 315,
	                               -WIDE_C(1.0) / 560};
	const wide h = WIDE_C(0.002);
	int nj = o->r->nj;
	struct link_pose *poses = raw_memory(NULL, (size_t)nj, sizeof *poses);
	wide *moved = raw_memory(NULL, (size_t)o->r->nq, sizeof *moved);

	memset(out, 0, (size_t)nj * sizeof *out);
	for (int step = -4; step <= 4; step++) {
		wide weight = order == 1 ? first[abs(step)] * (step < 0 ? -1 : 1) / h : second[abs(step)] / (h * h);

		oracle_move(o->r, q, qd, qdd, (wide)step * h, moved);
		oracle_poses(o, moved, poses);
		for (int i = 0; i < nj; i++)
			for (int k = 0; k < 16; k++)
				out[i].m[k / 4][k % 4] += weight * poses[i].m[k / 4][k % 4];
	}
	free(poses);
	free(moved);
}

static const struct raw_link *find_link(const struct oracle *o, const char *name)
{
	int i = 0;

	while (strcmp(o->raw.links[i].name, name))
		i++;
	return &o->raw.links[i];
}

// sum over the mass of (r, 1)(r, 1)^T: in the inertial's own axes the second moments are tr(I)/2 - I.
static struct link_pose pseudo_inertia(const struct raw_link *l)
{
	const wide *in = l->inertia;
	wide half = (in[0] + in[3] + in[5]) / 2;
	wide xy = -in[1], xz = -in[2], yz = -in[4];
	struct link_pose at = origin(l->xyz, l->rpy), transposed;
	struct link_pose j = {{{half - in[0], xy, xz, 0}, {xy, half - in[3], yz, 0},
	                  {xz, yz, half - in[5], 0}, {0, 0, 0, l->mass}}};

	for (int i = 0; i < 16; i++)
		transposed.m[i % 4][i / 4] = at.m[i / 4][i % 4];
	return compose(at, compose(j, transposed));
}

struct link_pose oracle_inertia(const struct oracle *o, int entry)
{
	return pseudo_inertia(find_link(o, o->r->joints[entry].link));
}

// tr(dT J (T'' - G)^T) with G the pose whose last column is gravity: g acts on every mass point alike.
static wide virtual_work(struct link_pose d, struct link_pose j, struct link_pose second, const wide *gravity)
{
	struct link_pose dj = compose(d, j);
	wide sum = 0;

	for (int i = 0; i < 3; i++)
		for (int k = 0; k < 4; k++)
			sum += dj.m[i][k] * (second.m[i][k] - (k == 3 ? gravity[i] : 0));
	return sum;
}

void oracle_torque(const struct oracle *o, const wide *q, const wide *qd, const wide *qdd, wide *tau)
{
	const struct reference *r = o->r;
	struct link_pose *second = raw_memory(NULL, 2 * (size_t)r->nj, sizeof *second), *d = second + r->nj, inertia;
	wide *unit = raw_memory(NULL, 2 * (size_t)r->nv, sizeof *unit), *zero = unit + r->nv;

	memset(unit, 0, 2 * (size_t)r->nv * sizeof *unit);
	oracle_derivative(o, q, qd, qdd, 2, second);
	for (int k = 0; k < r->nv; k++) {
		unit[k] = 1;
		oracle_derivative(o, q, unit, zero, 1, d);
		unit[k] = 0;
		tau[k] = 0;
		for (int i = 0; i < r->nj; i++) {
			inertia = pseudo_inertia(find_link(o, r->joints[i].link));
			tau[k] += virtual_work(d[i], inertia, second[i], r->gravity);
		}
	}
	free(second);
	free(unit);
}

struct oracle oracle_open(const struct reference *r, const char *urdf, size_t length_of_text)
{
	struct oracle o = {.r = r};
	char message[256];

	if (!raw_read(&o.raw, urdf, length_of_text, false, message, sizeof message))
		abort();
	o.source = raw_memory(NULL, (size_t)r->nj, sizeof *o.source);
	for (int i = 1; i < r->nj; i++)
		for (int k = 0; k < o.raw.njoints; k++)
			if (!strcmp(o.raw.joints[k].name, r->joints[i].name))
				o.source[i] = k;
	return o;
}

void oracle_close(struct oracle *o)
{
	raw_free(&o->raw);
	free(o->source);
}
