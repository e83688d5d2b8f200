#include "tree/tree.h"
#include "scene/select.h"
#include "tree/rows.h"
#include <math.h>
#include <stdio.h>
#include <string.h>

/* What the depth-first walk carries: the joint it goes through next, and where the joint's parent link stands. */
struct step {
	int joint;
	int body;                /* the moving body that the parent link belongs to; -1: the world */
	struct placement parent; /* the parent link's frame in that body's URDF frame */
};

struct builder {
	struct tree *t;
	const struct robot *r;
	const struct rneagen_options *o;
	struct arena *a;
	struct rneagen_error *e;
	struct inertia_sum *sums; /* one per body */
	struct inertia_sum fixed;
	struct step *stack;
	int depth;
	int *first_child, *next_sibling; /* joints, by link and by joint */
	int *body_of_joint;              /* -1: none */
	struct selection cut;
	char *visited; /* by link */
};

int joint_nq(enum joint_type type)
{
	static const int rows[] = {
		[JOINT_REVOLUTE] = 1, [JOINT_CONTINUOUS] = 1, [JOINT_PRISMATIC] = 1, [JOINT_PLANAR] = 3, [JOINT_FLOATING] = 7};

	return rows[type];
}

int joint_nv(enum joint_type type)
{
	return type == JOINT_FLOATING ? 6 : joint_nq(type);
}

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
	k->type = b->cut.joints[joint].state == SELECTION_HELD ? JOINT_FIXED : j->type;
	k->multiplier = within_exact(1);
	k->follower = k->type != JOINT_FIXED && b->cut.joints[joint].leader != joint;
	if (k->type == JOINT_FIXED && !turns(j))
		k->frame = ROTATION_IDENTITY;
	else
		body_set_axis(k, j);
	if (k->type == JOINT_FIXED && turns(j))
		k->turn = along(k, b->cut.joints[joint].value[0]);
	body_set_placement(b, k, urdf);
	if (k->follower) {
		const struct selection_joint *c = &b->cut.joints[joint];
		struct tree_mimic m = {j->name, b->r->joints[c->leader].name, index, c->multiplier, c->offset};

		k->multiplier = m.multiplier;
		if (m.offset.x != 0)
			body_add_offset(k, m.offset);
		b->t->mimics[b->t->mimic_count++] = m;
	}
	if (k->type != JOINT_FIXED)
		b->body_of_joint[joint] = index;
	return index;
}

static void body_add_base(struct builder *b)
{
	struct body *k = &b->t->bodies[b->t->body_count++];

	*k = (struct body){.link = b->t->root, .joint = "", .parent = -1, .type = JOINT_FLOATING, .axis = 2, .sign = 1,
		.X = {.R = ROTATION_IDENTITY}, .frame = ROTATION_IDENTITY, .multiplier = {1, 1, 0}};
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

/* A kept joint's turn is left to its body. */
static int is_kept(const struct builder *b, int joint)
{
	return b->t->adjust.kept && b->t->adjust.kept[joint];
}

static int is_zero(const struct joint *j, const struct within *q)
{
	for (int i = 0; i < joint_nq(j->type); i++)
		if (q[i].x != (j->type == JOINT_FLOATING && i == 6 ? 1 : 0))
			return 0;
	return 1;
}

static void hold(struct builder *b, int joint, struct placement *at)
{
	const struct joint *j = &b->r->joints[joint];
	const struct selection_joint *c = &b->cut.joints[joint];

	if (!is_zero(j, c->value) && !(is_kept(b, joint) && turns(j))) {
		struct placement motion = held_motion(j, c->value);

		*at = placement_mul(at, &motion);
	}
	b->t->held[b->t->held_count++] = (struct tree_held){j->name, c->why, j->type, c->value, joint, selection_beyond(j, c)};
}

/* A link's inertia goes to the body that carries it; then its joints wait on the stack, first in name order on top. */
static void visit_link(struct builder *b, int link, int body, const struct placement *at)
{
	const struct link *l = &b->r->links[link];
	struct placement X = *at;

	b->visited[link] = 1;
	if (body >= 0) {
		struct placement back = {.R = rotation_transpose(&b->t->bodies[body].frame)};

		X = placement_mul(&back, at);
	}
	b->t->links[link] = (struct carried){body, X};
	if (l->has_inertial && !request_frees_link(&b->t->scene, l->name))
		inertia_add(body >= 0 ? &b->sums[body] : &b->fixed, &X, l->mass, l->com, l->com_rpy, l->inertia);
	for (int j = b->first_child[link]; j >= 0; j = b->next_sibling[j])
		if (b->cut.joints[j].state != SELECTION_GONE)
			b->stack[b->depth++] = (struct step){j, body, *at};
}

static void walk(struct builder *b)
{
	struct placement identity = {.R = ROTATION_IDENTITY};

	if (b->t->floating)
		body_add_base(b);
	visit_link(b, b->cut.root, b->t->floating ? 0 : -1, &identity);
	while (b->depth) {
		struct step s = b->stack[--b->depth];
		const struct joint *j = &b->r->joints[s.joint];
		struct placement origin = joint_placement(j), at = placement_mul(&s.parent, &origin);

		if (b->cut.joints[s.joint].state == SELECTION_HELD)
			hold(b, s.joint, &at);
		if (j->type == JOINT_FIXED || (b->cut.joints[s.joint].state == SELECTION_HELD && !is_kept(b, s.joint)))
			visit_link(b, j->child, s.body, &at);
		else
			visit_link(b, j->child, body_add(b, s.joint, s.body, &at), &identity);
	}
}

/* Children of each link, linked so that pushing them one by one leaves the first name on top of the stack. */
static void link_children(struct builder *b)
{
	for (int i = 0; i < b->r->link_count; i++)
		b->first_child[i] = -1;
	for (int j = 0; j < b->r->joint_count; j++) {
		int parent = b->r->joints[j].parent;

		b->body_of_joint[j] = -1;
		b->next_sibling[j] = b->first_child[parent];
		b->first_child[parent] = j;
	}
}

/* What the walk did not come to. */
static void list_cut(struct builder *b)
{
	struct tree_cut *c = &b->t->cut;

	for (int i = 0; i < b->r->link_count; i++)
		if (!b->visited[i]) {
			c->links[c->link_count++] = b->r->links[i].name;
			c->mass += b->r->links[i].mass.x;
		}
	for (int j = 0; j < b->r->joint_count; j++)
		if (b->r->joints[j].type != JOINT_FIXED && !(b->visited[b->r->joints[j].child] && b->visited[b->r->joints[j].parent]))
			c->joints[c->joint_count++] = b->r->joints[j].name;
}

static enum rneagen_code allocate(struct builder *b)
{
	size_t links = (size_t)b->r->link_count, joints = (size_t)b->r->joint_count;
	struct arena *a = b->a;
	struct tree *t = b->t;

	t->bodies = arena_alloc(a, joints + 1, sizeof *t->bodies);
	t->joints = arena_alloc(a, joints + 1, sizeof *t->joints);
	t->mimics = arena_alloc(a, joints, sizeof *t->mimics);
	t->links = arena_alloc(a, links, sizeof *t->links);
	t->held = arena_alloc(a, joints, sizeof *t->held);
	t->cut.links = arena_alloc(a, links, sizeof(char *));
	t->cut.joints = arena_alloc(a, joints, sizeof(char *));
	b->visited = arena_alloc(a, links, 1);
	b->sums = arena_alloc(a, joints + 1, sizeof *b->sums);
	b->stack = arena_alloc(a, joints + 1, sizeof *b->stack);
	b->first_child = arena_alloc(a, links, sizeof *b->first_child);
	b->next_sibling = arena_alloc(a, joints, sizeof *b->next_sibling);
	b->body_of_joint = arena_alloc(a, joints, sizeof *b->body_of_joint);
	t->ignored.damping = arena_alloc(a, joints, sizeof(char *));
	t->ignored.friction = arena_alloc(a, joints, sizeof(char *));
	t->ignored.limits = arena_alloc(a, joints, sizeof(char *));
	t->angles = arena_alloc(a, links + joints, sizeof *t->angles);
	return a->failed ? error_memory(b->e) : RNEAGEN_OK;
}

static void list_angle(struct tree *t, const char *what, const char *name, const struct within rpy[3])
{
	double off = adjust_off_rpy(rpy, t->adjust.snap > ADJUST_NEARLY ? t->adjust.snap : ADJUST_NEARLY);

	if (off > 0)
		t->angles[t->angle_count++] = (struct tree_angle){what, name, off};
}

/* Of what is modelled, as the URDF has them. */
static void list_angles(struct builder *b, const struct robot *r)
{
	for (int j = 0; j < r->joint_count; j++)
		if (b->visited[r->joints[j].child] && b->visited[r->joints[j].parent])
			list_angle(b->t, "joint", r->joints[j].name, r->joints[j].rpy);
	for (int i = 0; i < r->link_count; i++)
		if (b->visited[i] && r->links[i].has_inertial)
			list_angle(b->t, "inertial of link", r->links[i].name, r->links[i].com_rpy);
}

static void list_ignored(struct builder *b)
{
	struct tree_ignored *x = &b->t->ignored;
	int damping = !scene_next(&b->t->scene, SCENE_DAMPING, NULL), friction = !scene_next(&b->t->scene, SCENE_FRICTION, NULL);

	for (int i = 0; i < b->r->joint_count; i++) {
		const struct joint *j = &b->r->joints[i];

		if (b->body_of_joint[i] < 0)
			continue;
		if (damping && j->has_dynamics && j->damping.x != 0)
			x->damping[x->damping_count++] = j->name;
		if (friction && j->has_dynamics && j->friction.x != 0)
			x->friction[x->friction_count++] = j->name;
		if (j->has_limits)
			x->limits[x->limit_count++] = j->name;
	}
	x->transmission_count = b->r->transmission_count;
}

/* The robot with its angles snapped, if they are to be. */
static enum rneagen_code adjust_robot(struct builder *b, struct robot *snapped)
{
	if (b->t->adjust.snap == 0)
		return RNEAGEN_OK;
	*snapped = adjust_snap(b->r, b->t->adjust.snap, b->a);
	b->r = snapped;
	return b->a->failed ? error_memory(b->e) : RNEAGEN_OK;
}

enum rneagen_code tree_build(struct tree *t, const struct robot *r, const struct rneagen_options *o, struct arena *a,
	struct rneagen_error *e)
{
	return tree_build_adjusted(t, r, o, NULL, a, e);
}

enum rneagen_code tree_build_adjusted(struct tree *t, const struct robot *r, const struct rneagen_options *o,
	const struct adjust *x, struct arena *a, struct rneagen_error *e)
{
	struct builder b = {.t = t, .r = r, .o = o, .a = a, .e = e};
	struct robot snapped;

	*t = (struct tree){.source = r, .robot = r->name, .floating = o->base == RNEAGEN_FLOATING};
	for (int i = 0; i < 3; i++)
		t->gravity[i] = within_double(o->gravity[i]);
	if (scene_read(&t->scene, o->scene, o->file ? o->file : "<input>", a, e) || scene_expand(&t->scene, r, a, e) ||
		adjust_read(&t->adjust, &t->scene, e) || scene_select(&b.cut, &t->scene, r, o, a, e) ||
		allocate(&b))
		return e->code;
	if (x)
		t->adjust = *x;
	if (adjust_robot(&b, &snapped))
		return e->code;
	t->root = r->links[b.cut.root].name;
	for (int i = 0; i < r->link_count; i++)
		t->links[i].body = -2;
	link_children(&b);
	walk(&b);
	list_cut(&b);
	list_angles(&b, r);
	list_ignored(&b);
	if (scene_select_check(&b.cut, &t->scene, r, b.visited, e))
		return e->code;
	for (int k = 0; k < t->body_count; k++)
		t->bodies[k].inertia = inertia_total(&b.sums[k]);
	t->fixed = inertia_total(&b.fixed);
	if (t->adjust.digits)
		adjust_round(t, t->adjust.digits);
	return rows_number(t, o, a, e) ? e->code : request_resolve(t, b.r, a, e);
}
