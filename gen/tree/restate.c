#include "tree/restate.h"
#include <string.h>

static int is_revolute(const struct body *k)
{
	return k->type == JOINT_REVOLUTE || k->type == JOINT_CONTINUOUS;
}

int restate_turns(const struct body *k)
{
	return is_revolute(k) || k->type == JOINT_PRISMATIC;
}

int restate_slides(const struct body *k)
{
	return restate_turns(k) || k->type == JOINT_PLANAR;
}

/* ---- frames ---- */

/* Exactly 1 where nothing else is in a row and a column, and one sine and cosine for the other four. */
static void tidy(struct rotation *r)
{
	for (int i = 0; i < 3; i++)
		for (int j = 0; j < 3; j++) {
			int a = (i + 1) % 3, b = (i + 2) % 3, c = (j + 1) % 3, d = (j + 2) % 3;

			if (r->m[i][c].x != 0 || r->m[i][d].x != 0 || r->m[a][j].x != 0 || r->m[b][j].x != 0)
				continue;
			r->m[i][j] = within_exact(r->m[i][j].x < 0 ? -1 : 1);
			r->m[b][d] = r->m[i][j].x < 0 ? within_neg(r->m[a][c]) : r->m[a][c];
			r->m[b][c] = r->m[i][j].x < 0 ? r->m[a][d] : within_neg(r->m[a][d]);
		}
}

static struct placement moved(const struct placement *a, const struct placement *b)
{
	struct placement c = placement_mul(a, b);

	tidy(&c.R);
	return c;
}

/* Y: the new frame in the one that the body has. */
static struct placement frame_of(const struct body *k, const struct restatement *by)
{
	struct placement Y = {.R = rotation_by(k->axis, by->turn)};

	memcpy(Y.p, by->slide, sizeof Y.p);
	return Y;
}

/* X' = X Y, of children and links Y^-1 X, inertia as seen from Y. */
static void reframe(struct tree *t, int body, const struct restatement *by)
{
	struct body *k = &t->bodies[body];
	struct placement Y = frame_of(k, by), back = placement_inverse(&Y), at = Y, urdf = {.R = k->frame};
	struct inertia_sum s = {0};

	at.R = rotation_by(k->axis, turn_sub(by->turn, by->ahead));
	memcpy(urdf.p, k->origin, sizeof urdf.p);
	k->X = moved(&k->X, &at);
	k->ahead = by->ahead;
	urdf = moved(&urdf, &Y);
	k->frame = urdf.R;
	memcpy(k->origin, urdf.p, sizeof k->origin);
	inertia_add_from(&s, &back, &k->inertia);
	k->inertia = inertia_total(&s);
	for (int i = body + 1; i < t->body_count; i++)
		if (t->bodies[i].parent == body)
			t->bodies[i].X = moved(&back, &t->bodies[i].X);
}

static void move_links(struct tree *t, int body, const struct restatement *by)
{
	struct placement Y = frame_of(&t->bodies[body], by), back = placement_inverse(&Y);

	for (int i = 0; i < t->source->link_count; i++)
		if (t->links[i].body == body)
			t->links[i].X = moved(&back, &t->links[i].X);
}

static int is_moved(const struct restatement *by)
{
	return by->slide[0].x != 0 || by->slide[1].x != 0 || by->slide[2].x != 0 || !turn_is_none(by->turn) ||
		!turn_is_none(by->ahead);
}

/* ---- inertial parameters ---- */

/* What moves alike with body and parent: of a joint that turns, what lies on its axis, as mass, dipole and rod; of one that
   slides, what has neither mass nor first moment; of one that does both, such a rod; of one that is fixed, all. */
static struct inertia common(const struct body *k, enum regroup how)
{
	int i = (k->axis + (how == REGROUP_FIRST ? 1 : 2)) % 3;
	struct inertia I = {0};

	if (how == REGROUP_NOTHING || k->type == JOINT_FLOATING)
		return I;
	if (k->type == JOINT_FIXED)
		return k->inertia;
	if (k->type == JOINT_PRISMATIC) {
		memcpy(I.I, k->inertia.I, sizeof I.I);
		return I;
	}
	if (is_revolute(k)) {
		I.mass = k->inertia.mass;
		I.h[k->axis] = k->inertia.h[k->axis];
	}
	for (int j = 0; j < 3; j++)
		if (j != k->axis)
			I.I[inertia_index(j, j)] = k->inertia.I[inertia_index(i, i)];
	return I;
}

static struct inertia_sum inertia_sum_of(const struct inertia *I)
{
	struct inertia_sum s = {.mass = sum_from(I->mass)};

	for (int i = 0; i < 3; i++)
		s.h[i] = sum_from(I->h[i]);
	for (int i = 0; i < 6; i++)
		s.I[i] = sum_from(I->I[i]);
	return s;
}

static void take_off(struct inertia_sum *s, const struct inertia *I)
{
	sum_add(&s->mass, within_neg(I->mass));
	for (int i = 0; i < 3; i++)
		sum_add(&s->h[i], within_neg(I->h[i]));
	for (int i = 0; i < 6; i++)
		sum_add(&s->I[i], within_neg(I->I[i]));
}

/* At the ground it has no effect. */
static void regroup(struct tree *t, int body, enum regroup how)
{
	struct body *k = &t->bodies[body], *parent = &t->bodies[k->parent < 0 ? 0 : k->parent];
	struct inertia I = common(k, how);
	struct inertia_sum own = inertia_sum_of(&k->inertia), taken = inertia_sum_of(&parent->inertia);
	struct placement X = k->X, turn = {.R = rotation_about(k->axis, k->turn)};

	take_off(&own, &I);
	k->inertia = inertia_total(&own);
	if (k->parent < 0)
		return;
	if (k->type == JOINT_FIXED)
		X = placement_mul(&X, &turn);
	inertia_add_from(&taken, &X, &I);
	parent->inertia = inertia_total(&taken);
}

/* ---- the whole ---- */

/* Bodies of its own, and links of its own where there are to be any. */
static int copy(struct tree *out, const struct tree *t, int has_links, struct arena *a)
{
	size_t bodies = (size_t)t->body_count, links = (size_t)t->source->link_count;

	*out = *t;
	out->bodies = arena_alloc(a, bodies, sizeof *out->bodies);
	if (!out->bodies)
		return 0;
	memcpy(out->bodies, t->bodies, bodies * sizeof *out->bodies);
	if (!has_links)
		return 1;
	out->links = arena_alloc(a, links, sizeof *out->links);
	if (out->links)
		memcpy(out->links, t->links, links * sizeof *out->links);
	return out->links != NULL;
}

int tree_restate(struct tree *out, const struct tree *t, const struct restatement *by, struct arena *a)
{
	if (!copy(out, t, 1, a))
		return 0;
	for (int k = 0; k < t->body_count; k++)
		if (is_moved(&by[k])) {
			reframe(out, k, &by[k]);
			move_links(out, k, &by[k]);
		}
	for (int k = t->body_count - 1; k >= 0; k--)
		if (by[k].regroup)
			regroup(out, k, by[k].regroup);
	return 1;
}

/* Does what a body's parent takes depend on the frame of another? */
static int depends(const struct tree *t, int k, int body)
{
	if (t->bodies[k].parent == body)
		return 1;
	while (body > k)
		body = t->bodies[body].parent;
	return body == k;
}

int tree_restate_around(struct tree *out, const struct tree *t, const struct restatement *by, int body, struct arena *a)
{
	if (!copy(out, t, 0, a))
		return 0;
	for (int k = 0; k < t->body_count; k++)
		if (k != body && is_moved(&by[k]))
			reframe(out, k, &by[k]);
	for (int k = t->body_count - 1; k >= 0; k--)
		if (by[k].regroup && !depends(t, k, body))
			regroup(out, k, by[k].regroup);
	return 1;
}

int tree_restate_body(struct tree *out, const struct tree *around, const struct restatement *by, int body, struct arena *a)
{
	if (!copy(out, around, 0, a))
		return 0;
	if (is_moved(&by[body]))
		reframe(out, body, &by[body]);
	for (int k = around->body_count - 1; k >= 0; k--)
		if (by[k].regroup && depends(around, k, body))
			regroup(out, k, by[k].regroup);
	return 1;
}
