/* erand48 */
#define _XOPEN_SOURCE 700
#include "draw/draw.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double PI = 3.14159265358979323846;

const struct draw_options DRAW_EFFECTS = {.seed = 1, .count = 100, .each = 1};

/* ---- ranges ---- */

static struct draw_range between(double lower, double upper)
{
	return (struct draw_range){DRAW_NUMBER, lower, upper, 0};
}

static struct draw_range known(struct draw_range r, int is_known)
{
	r.is_known = is_known;
	return r;
}

static struct draw_range around(double size)
{
	return between(-size, size);
}

/* Of the row of a revolute, continuous or prismatic joint. */
static struct draw_range position_range(const struct joint *j)
{
	int limited = j->has_limits && j->lower < j->upper && fabs(j->lower) <= DRAW_LIMIT && fabs(j->upper) <= DRAW_LIMIT;

	if (limited && j->type != JOINT_CONTINUOUS)
		return known(between(j->lower, j->upper), 1);
	return known(around(j->type == JOINT_PRISMATIC ? 1 : PI), j->type == JOINT_CONTINUOUS);
}

static struct draw_range velocity_range(const struct joint *j)
{
	int limited = j && j->has_limits && j->velocity > 0 && j->velocity <= DRAW_LIMIT;

	return known(around(limited ? j->velocity : 3), limited);
}

static struct draw_range torque_range(const struct joint *j)
{
	int limited = j && j->has_limits && j->effort > 0 && j->effort <= DRAW_LIMIT;

	return known(around(limited ? j->effort : 10), limited);
}

static void range_position(const struct tree_joint *t, const struct joint *j, struct draw_range *q)
{
	int lengths = t->type == JOINT_FLOATING ? 3 : t->type == JOINT_PLANAR ? 2 : 0;

	for (int i = 0; i < t->nq; i++)
		q[i] = i < lengths ? around(1) : around(PI);
	for (int i = lengths; i < t->nq && t->type == JOINT_FLOATING; i++)
		q[i] = (struct draw_range){DRAW_ROTATION, -1, 1, 1};
	if (t->type == JOINT_PLANAR)
		q[lengths].is_known = 1;
	if (!lengths)
		q[0] = position_range(j);
}

static void range_joints(struct drawn *x, const struct tree *t, int is_forward)
{
	for (int i = 0; i < t->joint_count; i++) {
		const struct tree_joint *k = &t->joints[i];
		const struct joint *j = tree_joint_of(t->source, t, i);

		range_position(k, j, x->arrays[DRAWN_Q].ranges + k->iq);
		for (int r = k->iv; r < k->iv + k->nv; r++) {
			x->arrays[DRAWN_QD].ranges[r] = velocity_range(j);
			x->arrays[DRAWN_DRIVE].ranges[r] = is_forward ? torque_range(j) : around(10);
		}
	}
}

/* Of a joint's own term: 0 to 0.1 kg m^2, 1 N m s or 1 N m where the URDF has none. */
static struct draw_range own_range(const struct freed *f, int row)
{
	double own = (double)f->nominal[row];

	return own > 0 ? between(0.9 * own, 1.1 * own) : between(0, f->kind == FREED_OWN + OWN_ARMATURE ? 0.1 : 1);
}

static struct draw_range freed_range(const struct freed *f)
{
	double mass = (double)f->nominal[0], length = 0;
	struct draw_range r = mass > 0 ? between(0.9 * mass, 1.1 * mass) : between(0, 1);

	for (int i = 0; i < 3 && f->kind == FREED_GRAVITY; i++)
		length = hypot(length, (double)f->nominal[i]);
	if (f->kind == FREED_GRAVITY)
		return around(length > 0 ? length : 9.81);
	if (f->kind == FREED_OFFSET)
		return around(0.1);
	if (f->kind == FREED_ACCEL)
		return around(1);
	r.kind = f->kind == FREED_MASS ? DRAW_NUMBER : DRAW_BODY;
	return r;
}

/* Rows of what is freed of all joints. */
static void range_own(struct drawn *x)
{
	for (int i = 0; i < x->count; i++)
		for (int r = 0; r < x->arrays[i].rows && x->arrays[i].freed && x->arrays[i].freed->kind >= FREED_OWN; r++)
			x->arrays[i].ranges[r] = own_range(x->arrays[i].freed, r);
}

/* What the scene says; a quaternion is drawn over all rotations. */
static void range_as_said(struct drawn_array *a, const struct request *k)
{
	for (int row = 0; row < a->rows; row++) {
		const struct request_range *r = request_range_of(k, a->name, row);

		if (!r || a->ranges[row].kind == DRAW_ROTATION)
			continue;
		a->ranges[row].lower = r->lower;
		a->ranges[row].upper = r->upper;
		a->ranges[row].is_known = 1;
	}
}

static void add_array(struct drawn *x, struct drawn_array array, struct draw_range all, struct arena *a)
{
	struct drawn_array *to = &x->arrays[x->count++];

	*to = array;
	to->ranges = arena_alloc(a, (size_t)to->rows, sizeof *to->ranges);
	for (int i = 0; to->ranges && i < to->rows; i++)
		to->ranges[i] = all;
}

int draw_ranges(struct drawn *x, const struct tree *t, const struct request *k, struct arena *a)
{
	*x = (struct drawn){.count = 0};
	add_array(x, (struct drawn_array){.name = "q", .rows = t->nq}, around(1), a);
	add_array(x, (struct drawn_array){.name = "qd", .rows = t->nv}, around(1), a);
	add_array(x, (struct drawn_array){.name = k->is_forward ? "tau" : "qdd", .rows = t->nv}, around(1), a);
	for (int i = 0; i < k->freed_count; i++) {
		const struct freed *f = &k->freed[i];

		add_array(x, (struct drawn_array){f->argument, f->rows, f->per_batch, f, NULL, NULL}, freed_range(f), a);
	}
	for (int i = 0; i < k->push_count; i++)
		add_array(x, (struct drawn_array){.name = k->pushes[i].argument, .rows = 6}, around(10), a);
	if (request_wants(k, WANT_JVP))
		add_array(x, (struct drawn_array){.name = "jvp_v", .rows = 3 * t->nv}, around(1), a);
	if (request_wants(k, WANT_VJP))
		add_array(x, (struct drawn_array){.name = "vjp_v", .rows = k->vjp.rows}, around(1), a);
	for (int i = 0; i < k->by_count && request_wants(k, WANT_JVP); i++)
		add_array(x, (struct drawn_array){.name = k->by[i].direction, .rows = k->by[i].rows,
			.per_batch = k->by[i].per_batch}, around(1), a);
	if (a->failed)
		return 0;
	range_joints(x, t, k->is_forward);
	range_own(x);
	for (int i = 0; i < x->count; i++)
		range_as_said(&x->arrays[i], k);
	return 1;
}

/* ---- bounds ---- */

static void widen(double bounds[2], double lower, double upper)
{
	bounds[0] += fmin(lower, 0) * (1 + 0x1p-40);
	bounds[1] += fmax(upper, 0) * (1 + 0x1p-40);
}

/* What draw_body makes of all masses from r.lower to r.upper: a box of no more mass than `box`, and the rest as the URDF has
   it. */
static void bound_body(const struct freed *f, struct draw_range r, double (*bounds)[2])
{
	double box = f->nominal[0] > 0 ? 0.1 * r.upper : r.upper, most;

	for (int i = 0; i < FREED_ROWS; i++) {
		bounds[i][0] = bounds[i][1] = 0;
		most = f->nominal[0] > 0 ? r.upper * (double)(f->nominal[i] / f->nominal[0]) : 0;
		widen(bounds[i], most, most);
		if (i > 0 && i < 4)
			widen(bounds[i], -0.1 * box, 0.1 * box);
	}
	for (int i = 0; i < 3; i++)
		for (int j = i; j < 3; j++)
			widen(bounds[4 + inertia_index(i, j)], i == j ? 0 : -0.01 * box,
				i == j ? (0.02 / 3 + 0.02) * box : 0.01 * box);
	bounds[0][0] = r.lower;
	bounds[0][1] = r.upper;
}

void draw_bounds(const struct drawn_array *x, double (*bounds)[2])
{
	for (int i = 0; i < x->rows; i++) {
		bounds[i][0] = x->ranges[i].lower;
		bounds[i][1] = x->ranges[i].upper;
	}
	if (x->rows && x->ranges[0].kind == DRAW_BODY)
		bound_body(x->freed, x->ranges[0], bounds);
}

/* ---- drawing ---- */

static double draw(unsigned short seed[3], struct draw_range r)
{
	return r.lower + (r.upper - r.lower) * erand48(seed);
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

/* A box of mass m with half sides s and its centre at c: h = m c,  I = m/3 (s.s 1 - s s^T, diagonal) + m (c.c 1 - c c^T). */
static void draw_box(unsigned short seed[3], double m, double *x)
{
	double s[3], c[3];

	x[0] = m;
	for (int i = 0; i < 3; i++) {
		s[i] = 0.1 * erand48(seed);
		c[i] = draw(seed, around(0.1));
		x[1 + i] = m * c[i];
	}
	for (int i = 0; i < 3; i++)
		for (int j = i; j < 3; j++) {
			int k = (i + 1) % 3, l = (i + 2) % 3;

			x[4 + inertia_index(i, j)] =
				i == j ? m / 3 * (s[k] * s[k] + s[l] * s[l]) + m * (c[k] * c[k] + c[l] * c[l]) : -m * c[i] * c[j];
		}
}

/* A body that can be, and none of whose ten numbers is 0 in all samples: a box; beside a body that the URDF has. */
static void draw_body(unsigned short seed[3], const struct freed *f, struct draw_range r, double *x)
{
	double mass = draw(seed, r), box = f->nominal[0] > 0 ? 0.1 * erand48(seed) : 1;

	draw_box(seed, box * mass, x);
	for (int i = 0; i < FREED_ROWS && f->nominal[0] > 0; i++)
		x[i] += (1 - box) * mass * (double)(f->nominal[i] / f->nominal[0]);
}

/* Rows first to end - 1 of one sample. */
static void draw_sample(unsigned short seed[3], const struct drawn_array *a, int first, int end, double *x)
{
	for (int i = first; i < end; i++)
		if (a->ranges[i].kind == DRAW_NUMBER) {
			x[i] = draw(seed, a->ranges[i]);
		} else if (a->ranges[i].kind == DRAW_ROTATION) {
			draw_quaternion(seed, x + i);
			i += 3;
		} else {
			draw_body(seed, a->freed, a->ranges[i], x + i);
			i += FREED_ROWS - 1;
		}
}

/* Joint by joint: all states are one sequence. */
static void draw_state(unsigned short seed[3], const struct drawn *x, const struct tree *t, size_t sample)
{
	const struct drawn_array *q = &x->arrays[DRAWN_Q], *qd = &x->arrays[DRAWN_QD], *drive = &x->arrays[DRAWN_DRIVE];

	for (int i = 0; i < t->joint_count; i++) {
		const struct tree_joint *j = &t->joints[i];

		draw_sample(seed, q, j->iq, j->iq + j->nq, q->values + sample * (size_t)q->rows);
		for (int k = j->iv; k < j->iv + j->nv; k++) {
			draw_sample(seed, qd, k, k + 1, qd->values + sample * (size_t)qd->rows);
			draw_sample(seed, drive, k, k + 1, drive->values + sample * (size_t)drive->rows);
		}
	}
}

static size_t samples_of(const struct drawn *x, const struct drawn_array *a)
{
	return a->per_batch ? 1 : x->samples;
}

int draw_inputs(struct drawn *x, const struct tree *t, const struct request *k, const struct draw_options *o, struct arena *a)
{
	unsigned short states[3] = {(unsigned short)o->seed, (unsigned short)(o->seed >> 16), (unsigned short)(o->seed >> 32)};
	/* another sequence for what is no state */
	unsigned short others[3] = {
		(unsigned short)~o->seed, (unsigned short)~(o->seed >> 16), (unsigned short)~(o->seed >> 32)};

	if (!draw_ranges(x, t, k, a))
		return 0;
	x->samples = o->count;
	for (int i = 0; i < x->count; i++) {
		x->arrays[i].per_batch &= !o->each;
		x->arrays[i].values = arena_alloc(a, samples_of(x, &x->arrays[i]), (size_t)x->arrays[i].rows * sizeof(double));
	}
	for (size_t s = 0; !a->failed && s < o->count; s++)
		draw_state(states, x, t, s);
	for (int i = DRAWN_OTHERS; !a->failed && i < x->count; i++) {
		const struct drawn_array *y = &x->arrays[i];

		for (size_t s = 0; s < samples_of(x, y); s++)
			draw_sample(others, y, 0, y->rows, y->values + s * (size_t)y->rows);
	}
	return !a->failed;
}

void draw_round(struct drawn *x)
{
	for (int i = 0; i < x->count; i++)
		for (size_t k = 0; k < samples_of(x, &x->arrays[i]) * (size_t)x->arrays[i].rows; k++)
			x->arrays[i].values[k] = (double)(float)x->arrays[i].values[k];
}

const struct drawn_array *draw_array(const struct drawn *x, const struct argument *a)
{
	for (int i = 0; i < x->count && !a->is_output; i++)
		if (!strcmp(x->arrays[i].name, a->name))
			return &x->arrays[i];
	return NULL;
}

const double *draw_rows(const struct drawn *x, const struct argument *a, size_t sample)
{
	const struct drawn_array *y = draw_array(x, a);

	return y ? y->values + (y->per_batch ? 0 : sample * (size_t)y->rows) : NULL;
}
