#include "passes/frames.h"

struct listing {
	struct frames *f;
	const struct tree *now;
	const struct body *k;
	const struct restatement *by;
	int body, i, j; /* the axes across that of the joint */
};

static struct listing listing(struct frames *f, const struct tree *now, const struct restatement *by, int body)
{
	const struct body *k = &now->bodies[body];

	f->count = 0;
	return (struct listing){f, now, k, &by[body], body, (k->axis + 1) % 3, (k->axis + 2) % 3};
}

static int is_turn(const struct turn *a, const struct turn *b)
{
	return a->s.x == b->s.x && a->c.x == b->c.x;
}

static int is_same(const struct restatement *a, const struct restatement *b)
{
	return a->slide[0].x == b->slide[0].x && a->slide[1].x == b->slide[1].x && a->slide[2].x == b->slide[2].x &&
		is_turn(&a->turn, &b->turn) && is_turn(&a->ahead, &b->ahead);
}

static void list(const struct listing *x, struct restatement r)
{
	int is_listed = is_same(&r, x->by);

	for (int i = 0; i < x->f->count; i++)
		is_listed |= is_same(&r, &x->f->of[i]);
	if (!is_listed && x->f->count < FRAMES_MOST)
		x->f->of[x->f->count++] = r;
}

/* Turned by so much more; a joint that slides has no angle. */
static void list_turn(const struct listing *x, struct turn more)
{
	struct restatement r = *x->by;

	if (turn_is_none(more))
		return;
	r.turn = turn_add(r.turn, more);
	r.ahead = TURN_NONE;
	list(x, r);
	if (x->k->type == JOINT_PRISMATIC)
		return;
	r.ahead = turn_add(x->by->ahead, more);
	if (!turn_is_none(r.ahead))
		list(x, r);
}

/* The first axis across along (u, v), and the second. */
static void list_along(const struct listing *x, struct sum u, struct sum v)
{
	if (sum_total(u).x == 0 && sum_total(v).x == 0)
		return;
	list_turn(x, turn_of(u, v));
	list_turn(x, turn_sub(turn_of(u, v), (struct turn){within_exact(1), within_exact(0)}));
}

static void list_vector(const struct listing *x, const struct within v[3])
{
	list_along(x, sum_from(v[x->i]), sum_from(v[x->j]));
}

static int is_child(const struct listing *x, int i)
{
	return x->now->bodies[i].parent == x->body;
}

/* Half the angle of (u, v), and 45 degrees more: cos^2 = (1 + u)/2, sin^2 = (1 - u)/2, 2 sin cos = v for a unit vector;
   the root is taken of the larger. */
static void list_half(const struct listing *x, struct within u, struct within v)
{
	struct within root = within_sqrt(within_exact(0.5L)), larger, other;
	struct turn unit, half;

	if (v.x == 0)
		return;
	unit = turn_of(sum_from(u), sum_from(v));
	larger = u.x < 0 ? within_sub(within_exact(1), unit.c) : within_add(within_exact(1), unit.c);
	larger = within_mul(root, within_sqrt(larger));
	other = within_div(unit.s, within_mul(within_exact(2), larger));
	half = u.x < 0 ? (struct turn){larger, other} : (struct turn){other, larger};
	list_turn(x, half);
	list_turn(x, turn_add(half, (struct turn){root, root}));
}

void frames_turned(struct frames *f, const struct tree *now, const struct restatement *by, int body)
{
	struct listing x = listing(f, now, by, body);
	const struct inertia *I = &x.k->inertia;

	if (!restate_turns(x.k))
		return;
	list_turn(&x, turn_sub(TURN_NONE, x.by->turn));
	for (int i = body + 1; i < now->body_count; i++)
		if (is_child(&x, i)) {
			const struct body *c = &now->bodies[i];
			struct within axis[3] = {c->X.R.m[0][c->axis], c->X.R.m[1][c->axis], c->X.R.m[2][c->axis]};

			list_vector(&x, axis);
			list_vector(&x, c->X.p);
		}
	for (int row = 0; row < 3; row++)
		list_vector(&x, x.k->X.R.m[row]);
	list_vector(&x, I->h);
	list_half(&x, within_sub(I->I[inertia_index(x.i, x.i)], I->I[inertia_index(x.j, x.j)]),
		within_mul(within_exact(-2), I->I[inertia_index(x.i < x.j ? x.i : x.j, x.i < x.j ? x.j : x.i)]));
}

void frames_split(struct frames *f, const struct tree *now, const struct restatement *by, int body)
{
	struct listing x = listing(f, now, by, body);

	if (!restate_turns(x.k) || x.k->type == JOINT_PRISMATIC)
		return;
	if (!turn_is_none(x.by->ahead)) {
		struct restatement r = *x.by;

		r.ahead = TURN_NONE;
		list(&x, r);
	}
	for (int row = 0; row < 3; row++) {
		const struct within *v = x.k->X.R.m[row];

		for (int second = 0; second < 2; second++) {
			struct turn more = turn_of(sum_from(v[x.i]), sum_from(v[x.j]));
			struct restatement r = *x.by;

			if (v[x.i].x == 0 || v[x.j].x == 0)
				continue;
			if (second)
				more = turn_sub(more, (struct turn){within_exact(1), within_exact(0)});
			r.ahead = turn_sub(r.ahead, more);
			list(&x, r);
		}
	}
}

static void list_slide(const struct listing *x, struct within by)
{
	struct restatement r = *x->by;
	struct sum s = sum_from(r.slide[x->k->axis]);

	if (by.x == 0)
		return;
	sum_add(&s, by);
	r.slide[x->k->axis] = sum_total(s);
	list(x, r);
}

void frames_slid(struct frames *f, const struct tree *now, const struct restatement *by, int body)
{
	struct listing x = listing(f, now, by, body);

	if (!restate_slides(x.k))
		return;
	list_slide(&x, within_neg(x.by->slide[x.k->axis]));
	for (int row = 0; row < 3; row++)
		if (x.k->X.R.m[row][x.k->axis].x != 0)
			list_slide(&x, within_neg(within_div(x.k->X.p[row], x.k->X.R.m[row][x.k->axis])));
	for (int i = body + 1; i < now->body_count; i++)
		if (is_child(&x, i))
			list_slide(&x, now->bodies[i].X.p[x.k->axis]);
}
