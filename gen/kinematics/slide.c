/* Which point of its axis stands for a joint that turns: its body moves alike about each. An offset along the parent's
   axis goes to the parent's own where that leaves fewer numbers to multiply with axes. */
#include "kinematics/kinematics.h"
#include <math.h>

static int is_turning(const struct body *k)
{
	return k->type == JOINT_REVOLUTE || k->type == JOINT_CONTINUOUS;
}

/* Offset i of those from a body's origin that count: to the points of children, and to wanted frames; NULL: it is none. */
static const struct within *offset_from(const struct kinematics *x, int body, int i)
{
	const struct want *w = &x->k->wants[i - x->t->body_count];

	if (i < x->t->body_count)
		return x->t->bodies[i].parent == body && x->points[i].is_used ? x->points[i].offset : NULL;
	return want_is(w->kind, OF_LINK) && want_is(w->kind, IS_PLACED) && w->body == body ? w->X.p : NULL;
}

/* a + s b, with what is rounding taken for zero */
static struct within sum_of(struct within a, struct within s, struct within b)
{
	struct sum x = sum_from(a);

	sum_add(&x, within_mul(s, b));
	return sum_total(x);
}

/* How many numbers are not zero in all offsets to and from the point at `along`; the world's axes take no product. */
static int cost(const struct kinematics *x, int body, struct within along)
{
	const struct body *k = &x->t->bodies[body];
	const struct within minus = within_exact(-1);
	int count = 0;

	for (int i = 0; i < 3 && k->parent >= 0; i++)
		count += sum_of(k->X.p[i], along, k->X.R.m[i][k->axis]).x != 0;
	for (int n = body + 1; n < x->t->body_count + x->k->want_count; n++) {
		const struct within *v = offset_from(x, body, n);

		for (int i = 0; i < 3 && v; i++)
			count += (i == k->axis ? sum_of(v[i], minus, along) : v[i]).x != 0;
	}
	return count;
}

static real length(const struct within v[3])
{
	return sqrtl(v[0].x * v[0].x + v[1].x * v[1].x + v[2].x * v[2].x);
}

/* How far the point may go: what is near is not told from what is far, whose digits it would lose. */
static real limit(const struct kinematics *x, int body)
{
	real least = -1;

	for (int n = body + 1; n < x->t->body_count + x->k->want_count; n++) {
		const struct within *v = offset_from(x, body, n);

		if (v && (least < 0 || length(v) < least))
			least = length(v);
	}
	return 4 * (length(x->t->bodies[body].X.p) + (least < 0 ? 0 : least));
}

static void choose(const struct kinematics *x, int body)
{
	const struct body *k = &x->t->bodies[body];
	struct axis_point *p = &x->points[body];
	int least = cost(x, body, p->along);
	real most = limit(x, body);

	for (int n = body + 1; n < x->t->body_count + x->k->want_count && is_turning(k); n++) {
		const struct within *v = offset_from(x, body, n);
		int count = v && v[k->axis].x != 0 && fabsl(v[k->axis].x) <= most ? cost(x, body, v[k->axis]) : least;

		if (count < least) {
			least = count;
			p->along = v[k->axis];
		}
	}
	for (int i = 0; i < 3; i++)
		p->offset[i] = sum_of(k->X.p[i], p->along, k->X.R.m[i][k->axis]);
}

/* Where masses are told of, origins count. */
int kinematics_slide(struct kinematics *x)
{
	int nb = x->t->body_count;

	x->points = arena_alloc(x->d->arena, (size_t)nb, sizeof *x->points);
	if (!x->points)
		return 0;
	for (int k = 0; k < nb; k++)
		for (int i = 0; i < 3; i++)
			x->points[k].offset[i] = x->t->bodies[k].X.p[i];
	for (int i = 0; i < x->k->want_count; i++)
		for (int k = x->k->wants[i].body; want_is(x->k->wants[i].kind, OF_LINK) && k >= 0; k = x->t->bodies[k].parent)
			x->points[k].is_used = 1;
	for (int k = nb - 1; k >= 0; k--)
		if (x->points[k].is_used && !request_wants_any(x->k, OF_MASSES))
			choose(x, k);
	return 1;
}

struct svec kinematics_from_point(const struct kinematics *x, int body, const struct within v[3])
{
	struct within u[3] = {v[0], v[1], v[2]};
	int axis = body < 0 ? 0 : x->t->bodies[body].axis;

	if (body >= 0)
		u[axis] = sum_of(u[axis], within_exact(-1), x->points[body].along);
	return svec_const(x->d, u);
}
