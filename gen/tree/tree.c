#include "tree/tree.h"
#include "tree/rows.h"
#include <string.h>

/* A link on its way into the tree. */
struct placed {
	int body;            /* the moving body that it belongs to; -1: the world */
	struct placement at; /* its frame in that body's URDF frame */
};

struct builder {
	struct tree *t;
	const struct robot *r;
	const struct selection *c;
	struct inertia_sum *sums; /* one per body */
	struct inertia_sum fixed;
	struct placed *placed; /* by link */
};

/* The joint's unit axis: a coordinate axis with a sign where it is one, else z of a turned frame. */
static void body_set_axis(struct body *k, const struct joint *j)
{
	struct within square = {0}, n[3];
	int nonzero = 0;

	k->axis = 2;
	k->sign = 1;
	k->frame = ROTATION_IDENTITY;
	if (j->type == JOINT_FLOATING)
		return;
	for (int i = 0; i < 3; i++)
		square = within_add(square, within_mul(j->axis[i], j->axis[i]));
	for (int i = 0; i < 3; i++) {
		n[i] = within_div(j->axis[i], within_sqrt(square));
		nonzero += n[i].x != 0;
	}
	if (j->type == JOINT_PLANAR) {
		k->frame = rotation_shortest(n);
	} else if (nonzero > 1) {
		k->frame = rotation_to_axis(n);
	} else {
		for (int i = 0; i < 3; i++)
			if (n[i].x != 0)
				k->axis = i;
		k->sign = n[k->axis].x < 0 ? -1 : 1;
	}
}

static int turns(const struct joint *j)
{
	return j->type == JOINT_REVOLUTE || j->type == JOINT_CONTINUOUS;
}

/* In the direction of the coordinate axis */
static struct within along(const struct body *k, struct within x)
{
	return k->sign < 0 ? within_neg(x) : x;
}

/* The constant part of a follower's offset goes into the joint's placement, where it is not rounded with q. */
static void body_add_offset(struct body *k, struct within offset)
{
	struct placement shift = {.R = ROTATION_IDENTITY};

	if (k->type == JOINT_PRISMATIC)
		shift.p[k->axis] = along(k, offset);
	else
		shift.R = rotation_about(k->axis, along(k, offset));
	k->X = placement_mul(&k->X, &shift);
}

static struct placement joint_placement(const struct joint *j)
{
	return (struct placement){rotation_rpy(j->rpy), {j->xyz[0], j->xyz[1], j->xyz[2]}};
}

/* From the joint's URDF frame in the parent body's URDF frame to the body frames: X = frame_p^T X frame_k. */
static void body_set_placement(struct builder *b, struct body *k, const struct placement *urdf)
{
	struct placement turned = {.R = k->frame};

	k->X = placement_mul(urdf, &turned);
	if (k->parent >= 0) {
		struct placement back = {.R = rotation_transpose(&b->t->bodies[k->parent].frame)};

		k->X = placement_mul(&back, &k->X);
	}
}

static int body_add(struct builder *b, int joint, int parent, const struct placement *urdf)
{
	int index = b->t->body_count++;
	struct body *k = &b->t->bodies[index];
	const struct joint *j = &b->r->joints[joint];

	k->number = b->t->floating ? index : index + 1;
	k->link = b->r->links[j->child].name;
	k->joint = j->name;
	k->parent = parent;
	k->type = b->c->joints[joint].state == SELECTION_HELD ? JOINT_FIXED : j->type;
	k->multiplier = within_exact(1);
	k->follower = k->type != JOINT_FIXED && b->c->joints[joint].leader != joint;
	if (k->type == JOINT_FIXED && !turns(j))
		k->frame = ROTATION_IDENTITY;
	else
		body_set_axis(k, j);
	if (k->type == JOINT_FIXED && turns(j))
		k->turn = along(k, b->c->joints[joint].value[0]);
	body_set_placement(b, k, urdf);
	if (k->follower) {
		const struct selection_joint *c = &b->c->joints[joint];
		struct tree_mimic m = {j->name, b->r->joints[c->leader].name, index, c->multiplier, c->offset};

		k->multiplier = m.multiplier;
		if (m.offset.x != 0)
			body_add_offset(k, m.offset);
		b->t->mimics[b->t->mimic_count++] = m;
	}
	return index;
}

static void body_add_base(struct builder *b)
{
	struct body *k = &b->t->bodies[b->t->body_count++];

	*k = (struct body){.link = b->t->root, .joint = "", .parent = -1, .type = JOINT_FLOATING, .axis = 2, .sign = 1,
		.X = {.R = ROTATION_IDENTITY}, .frame = ROTATION_IDENTITY, .multiplier = within_exact(1)};
}

/* What a joint that is held adds to its placement, in its URDF frame: frame (motion about or along its axis) frame^T. */
static struct placement held_motion(const struct joint *j, const struct within *q)
{
	struct body k = {.type = j->type};
	struct placement X = {.R = ROTATION_IDENTITY}, turned = {.R = ROTATION_IDENTITY}, back;

	body_set_axis(&k, j);
	if (j->type == JOINT_FLOATING) {
		memcpy(X.p, q, sizeof X.p);
		X.R = rotation_quaternion(q + 3);
		return X;
	}
	if (j->type == JOINT_PRISMATIC)
		X.p[k.axis] = along(&k, q[0]);
	else if (j->type != JOINT_PLANAR)
		X.R = rotation_about(k.axis, along(&k, q[0]));
	else
		X = (struct placement){rotation_about(2, q[2]), {q[0], q[1]}};
	turned.R = k.frame;
	back = (struct placement){.R = rotation_transpose(&k.frame)};
	X = placement_mul(&X, &back);
	return placement_mul(&turned, &X);
}

static int is_zero(const struct joint *j, const struct within *q)
{
	for (int i = 0; i < joint_nq(j->type); i++)
		if (q[i].x != (j->type == JOINT_FLOATING && i == 6 ? 1 : 0))
			return 0;
	return 1;
}

/* A joint that is held moves its child link to where it is held; the turn of one that is a body is left to that body. */
static void hold(const struct builder *b, int joint, struct placement *at)
{
	const struct joint *j = &b->r->joints[joint];
	const struct selection_joint *c = &b->c->joints[joint];

	if (!is_zero(j, c->value) && !(c->is_body && turns(j))) {
		struct placement motion = held_motion(j, c->value);

		*at = placement_mul(at, &motion);
	}
}

/* A link's inertia goes to the body that carries it. */
static void place_link(struct builder *b, int link, int body, const struct placement *at)
{
	const struct link *l = &b->r->links[link];
	struct placement X = *at;

	b->placed[link] = (struct placed){body, *at};
	if (body >= 0) {
		struct placement back = {.R = rotation_transpose(&b->t->bodies[body].frame)};

		X = placement_mul(&back, at);
	}
	b->t->links[link] = (struct carried){body, X};
	if (l->has_inertial && !b->c->freed[link])
		inertia_add(body >= 0 ? &b->sums[body] : &b->fixed, &X, l->mass, l->com, l->com_rpy, l->inertia);
}

static void place_joint(struct builder *b, int joint)
{
	const struct placement identity = {.R = ROTATION_IDENTITY};
	const struct joint *j = &b->r->joints[joint];
	const struct selection_joint *c = &b->c->joints[joint];
	const struct placed *parent = &b->placed[j->parent];
	struct placement origin = joint_placement(j), at = placement_mul(&parent->at, &origin);

	if (c->state == SELECTION_HELD)
		hold(b, joint, &at);
	if (j->type == JOINT_FIXED || (c->state == SELECTION_HELD && !c->is_body))
		place_link(b, j->child, parent->body, &at);
	else
		place_link(b, j->child, body_add(b, joint, parent->body, &at), &identity);
}

static void place_all(struct builder *b)
{
	const struct placement identity = {.R = ROTATION_IDENTITY};

	for (int i = 0; i < b->r->link_count; i++)
		b->t->links[i].body = -2;
	if (b->t->floating)
		body_add_base(b);
	place_link(b, b->c->root, b->t->floating ? 0 : -1, &identity);
	for (int i = 0; i < b->c->walk_count; i++)
		place_joint(b, b->c->walk[i]);
	for (int k = 0; k < b->t->body_count; k++)
		b->t->bodies[k].inertia = inertia_total(&b->sums[k]);
	b->t->fixed = inertia_total(&b->fixed);
}

enum rneagen_code tree_build(struct tree *t, const struct robot *r, const struct selection *c, const struct rneagen_options *o,
	struct arena *a, struct rneagen_error *e)
{
	size_t links = (size_t)r->link_count, joints = (size_t)r->joint_count;
	struct builder b = {.t = t, .r = r, .c = c};

	*t = (struct tree){.source = r, .robot = r->name, .root = r->links[c->root].name,
		.floating = o->base == RNEAGEN_FLOATING};
	for (int i = 0; i < 3; i++)
		t->gravity[i] = within_double(o->gravity[i]);
	t->bodies = arena_alloc(a, joints + 1, sizeof *t->bodies);
	t->joints = arena_alloc(a, joints + 1, sizeof *t->joints);
	t->mimics = arena_alloc(a, joints, sizeof *t->mimics);
	t->links = arena_alloc(a, links, sizeof *t->links);
	b.sums = arena_alloc(a, joints + 1, sizeof *b.sums);
	b.placed = arena_alloc(a, links, sizeof *b.placed);
	if (a->failed)
		return error_memory(e);
	place_all(&b);
	return rows_number(t, o, a, e);
}

const struct tree_joint *tree_joint_of_row(const struct tree *t, int row)
{
	const struct tree_joint *j = t->joints;

	while (row >= j->iv + j->nv)
		j++;
	return j;
}

const struct tree_joint *tree_joint_of_q(const struct tree *t, int row)
{
	for (int i = 0; i < t->joint_count; i++)
		if (row >= t->joints[i].iq && row < t->joints[i].iq + t->joints[i].nq)
			return &t->joints[i];
	return NULL;
}

int tree_end(const struct tree *t, int body)
{
	int end = body + 1;

	while (end < t->body_count && t->bodies[end].parent >= body)
		end++;
	return end;
}

int body_is_ahead(const struct body *k)
{
	return k->ahead.s.x != 0 || k->ahead.c.x < 0;
}

int tree_has_type(const struct tree *t, enum joint_type type)
{
	for (int i = 0; i < t->joint_count; i++)
		if (t->joints[i].type == type)
			return 1;
	return 0;
}

int tree_is_quaternion(const struct tree *t, int row)
{
	const struct tree_joint *j = tree_joint_of_q(t, row);

	return j && j->type == JOINT_FLOATING && row >= j->iq + 3;
}
