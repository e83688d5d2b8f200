#include "tree.h"
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

static const char *input_name(const struct rneagen_options *o)
{
	return o->file ? o->file : "<input>";
}

static int is_follower(const struct builder *b, const struct joint *j)
{
	return j->driver >= 0 && b->o->mimic == RNEAGEN_MIMIC_HONOUR;
}

/* q_follower = multiplier q_driver + offset, through followers of followers to a joint that has entries in q. */
static struct tree_mimic mimic_resolve(const struct builder *b, int joint)
{
	struct tree_mimic m = {.name = b->r->joints[joint].name, .multiplier = 1};
	const struct joint *j = &b->r->joints[joint];

	while (is_follower(b, j)) {
		m.offset += m.multiplier * (real)j->offset;
		m.multiplier *= (real)j->multiplier;
		j = &b->r->joints[j->driver];
	}
	m.driver = j->name;
	return m;
}

/* The joint's unit axis: a coordinate axis with a sign where it is one, else z of a turned frame. */
static void body_set_axis(struct body *k, const struct joint *j)
{
	real length = sqrtl((real)j->axis[0] * j->axis[0] + (real)j->axis[1] * j->axis[1] + (real)j->axis[2] * j->axis[2]);
	real n[3];
	int nonzero = 0;

	k->axis = 2;
	k->sign = 1;
	k->frame = ROTATION_IDENTITY;
	if (j->type == JOINT_FLOATING)
		return;
	for (int i = 0; i < 3; i++) {
		n[i] = (real)j->axis[i] / length;
		nonzero += n[i] != 0;
	}
	if (j->type == JOINT_PLANAR) {
		k->frame = rotation_shortest(n);
	} else if (nonzero > 1) {
		k->frame = rotation_to_axis(n);
	} else {
		for (int i = 0; i < 3; i++)
			if (n[i] != 0)
				k->axis = i;
		k->sign = n[k->axis] < 0 ? -1 : 1;
	}
}

/* The constant part of a follower's offset goes into the joint's placement, where it is not rounded with q. */
static void body_add_offset(struct body *k, real offset)
{
	struct placement shift = {.R = ROTATION_IDENTITY};

	if (k->type == JOINT_PRISMATIC)
		shift.p[k->axis] = k->sign * offset;
	else
		shift.R = rotation_about(k->axis, k->sign * offset);
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
	k->type = j->type;
	k->multiplier = 1;
	k->follower = is_follower(b, j);
	body_set_axis(k, j);
	body_set_placement(b, k, urdf);
	if (k->follower) {
		struct tree_mimic m = mimic_resolve(b, joint);

		m.body = index;
		k->multiplier = m.multiplier;
		if (m.offset != 0)
			body_add_offset(k, m.offset);
		b->t->mimics[b->t->mimic_count++] = m;
	}
	b->body_of_joint[joint] = index;
	return index;
}

static void body_add_base(struct builder *b)
{
	struct body *k = &b->t->bodies[b->t->body_count++];

	*k = (struct body){.link = b->t->root, .joint = "", .parent = -1, .type = JOINT_FLOATING, .axis = 2, .sign = 1,
		.X = {.R = ROTATION_IDENTITY}, .frame = ROTATION_IDENTITY, .multiplier = 1};
}

/* A link's inertia goes to the body that carries it; then its joints wait on the stack, first in name order on top. */
static void visit_link(struct builder *b, int link, int body, const struct placement *at)
{
	const struct link *l = &b->r->links[link];

	if (l->has_inertial) {
		struct inertia_sum *s = body >= 0 ? &b->sums[body] : &b->fixed;
		struct placement X = *at;

		if (body >= 0) {
			struct placement back = {.R = rotation_transpose(&b->t->bodies[body].frame)};

			X = placement_mul(&back, at);
		}
		inertia_add(s, &X, l->mass, l->com, l->com_rpy, l->inertia);
	}
	for (int j = b->first_child[link]; j >= 0; j = b->next_sibling[j])
		b->stack[b->depth++] = (struct step){j, body, *at};
}

static void walk(struct builder *b)
{
	struct placement identity = {.R = ROTATION_IDENTITY};

	if (b->t->floating)
		body_add_base(b);
	visit_link(b, b->r->root, b->t->floating ? 0 : -1, &identity);
	while (b->depth) {
		struct step s = b->stack[--b->depth];
		const struct joint *j = &b->r->joints[s.joint];
		struct placement origin = joint_placement(j), at = placement_mul(&s.parent, &origin);

		if (j->type == JOINT_FIXED)
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

/* The joint with this name and entries in q among `count` of them; -1 if there is none. */
static int find_joint(const struct tree_joint *joints, int count, const char *name, size_t length)
{
	for (int i = 0; i < count; i++)
		if (strlen(joints[i].name) == length && !memcmp(joints[i].name, name, length))
			return i;
	return -1;
}

/* Reorder as the option says; every joint (the base of --base floating apart) must be named once. */
static enum rneagen_code apply_order(struct builder *b)
{
	struct tree *t = b->t;
	int first = t->floating, count = 0, total = t->joint_count - first;
	struct tree_joint *chosen = arena_alloc(b->a, (size_t)t->joint_count, sizeof *chosen);

	if (!chosen)
		return error_memory(b->e);
	for (const char *s = b->o->order; s; s = strchr(s, ',') ? strchr(s, ',') + 1 : NULL) {
		size_t length = strcspn(s, ",");
		int i = find_joint(t->joints + first, total, s, length);

		if (i < 0)
			return error_set(b->e, RNEAGEN_USAGE, "%s: --order names '%.*s', which is no joint with entries in q",
				input_name(b->o), (int)(length < 255 ? length : 255), s);
		if (find_joint(chosen, count, s, length) >= 0)
			return error_set(b->e, RNEAGEN_USAGE, "%s: --order names joint '%.*s' twice", input_name(b->o),
				(int)length, s);
		chosen[count++] = t->joints[first + i];
	}
	for (int i = 0; i < total; i++)
		if (find_joint(chosen, count, t->joints[first + i].name, strlen(t->joints[first + i].name)) < 0)
			return error_set(b->e, RNEAGEN_USAGE, "%s: --order leaves out joint '%s'; name all %d joints",
				input_name(b->o), t->joints[first + i].name, total);
	memcpy(t->joints + first, chosen, (size_t)total * sizeof *chosen);
	return RNEAGEN_OK;
}

static enum rneagen_code number_joints(struct builder *b)
{
	struct tree *t = b->t;

	for (int k = 0; k < t->body_count; k++)
		if (!t->bodies[k].follower)
			t->joints[t->joint_count++] = (struct tree_joint){
				.name = t->bodies[k].joint, .type = t->bodies[k].type, .body = k};
	if (!t->joint_count)
		return error_set(b->e, RNEAGEN_NO_JOINTS, "%s: no movable joints in robot '%s'", input_name(b->o), t->robot);
	if (b->o->order && apply_order(b))
		return b->e->code;
	for (int i = 0; i < t->joint_count; i++) {
		struct tree_joint *j = &t->joints[i];

		j->iq = t->nq;
		j->iv = t->nv;
		t->nq += j->nq = joint_nq(j->type);
		t->nv += j->nv = joint_nv(j->type);
		t->bodies[j->body].iq = j->iq;
		t->bodies[j->body].iv = j->iv;
	}
	for (int i = 0; i < t->mimic_count; i++) {
		struct tree_mimic *m = &t->mimics[i];
		int driver = find_joint(t->joints, t->joint_count, m->driver, strlen(m->driver));

		t->bodies[m->body].iq = t->joints[driver].iq;
		t->bodies[m->body].iv = t->joints[driver].iv;
	}
	return RNEAGEN_OK;
}

/* Choices that are read and not yet made. */
static enum rneagen_code scene_supported(const struct scene *s, struct rneagen_error *e)
{
	static const char made[SCENE_KEY_COUNT] = {[SCENE_FEXT_FRAME] = 1, [SCENE_BESIDE] = 1};

	for (int i = 0; i < s->line_count; i++)
		if (!made[s->lines[i].key])
			return scene_refuse(s, &s->lines[i], e, "not supported yet");
	return RNEAGEN_OK;
}

enum rneagen_code tree_build(struct tree *t, const struct robot *r, const struct rneagen_options *o, struct arena *a,
	struct rneagen_error *e)
{
	size_t links = (size_t)r->link_count, joints = (size_t)r->joint_count;
	struct builder b = {.t = t, .r = r, .o = o, .a = a, .e = e};

	*t = (struct tree){.robot = r->name, .root = r->links[r->root].name, .floating = o->base == RNEAGEN_FLOATING};
	for (int i = 0; i < 3; i++)
		t->gravity[i] = o->gravity[i];
	if (scene_read(&t->scene, o->scene, input_name(o), a, e) || scene_expand(&t->scene, r, a, e) ||
		scene_supported(&t->scene, e))
		return e->code;
	t->bodies = arena_alloc(a, joints + 1, sizeof *t->bodies);
	t->joints = arena_alloc(a, joints + 1, sizeof *t->joints);
	t->mimics = arena_alloc(a, joints, sizeof *t->mimics);
	b.sums = arena_alloc(a, joints + 1, sizeof *b.sums);
	b.stack = arena_alloc(a, joints + 1, sizeof *b.stack);
	b.first_child = arena_alloc(a, links, sizeof *b.first_child);
	b.next_sibling = arena_alloc(a, joints, sizeof *b.next_sibling);
	b.body_of_joint = arena_alloc(a, joints, sizeof *b.body_of_joint);
	if (a->failed)
		return error_memory(e);
	link_children(&b);
	walk(&b);
	for (int k = 0; k < t->body_count; k++)
		t->bodies[k].inertia = inertia_total(&b.sums[k]);
	t->fixed = inertia_total(&b.fixed);
	return number_joints(&b);
}

void tree_dump(const struct tree *t, struct text *out)
{
	text_printf(out, "tree \"%s\": root link \"%s\", nb %d, nq %d, nv %d, gravity %.17Lg %.17Lg %.17Lg\n", t->robot,
		t->root, t->body_count, t->nq, t->nv, t->gravity[0], t->gravity[1], t->gravity[2]);
	for (int i = 0; i < t->body_count; i++) {
		const struct body *k = &t->bodies[i];
		const struct inertia *I = &k->inertia;

		text_printf(out, "body %d link \"%s\" joint \"%s\" %s parent %d axis %c%c iq %d iv %d", k->number, k->link,
			k->joint, joint_type_name(k->type), k->parent < 0 ? -1 : t->bodies[k->parent].number,
			k->sign < 0 ? '-' : '+', "xyz"[k->axis], k->iq, k->iv);
		if (k->follower)
			text_printf(out, " follower multiplier %.17Lg", k->multiplier);
		text_printf(out, "\n  p %.17Lg %.17Lg %.17Lg\n", k->X.p[0], k->X.p[1], k->X.p[2]);
		for (int row = 0; row < 3; row++)
			text_printf(out, "  R %.17Lg %.17Lg %.17Lg\n", k->X.R.m[row][0], k->X.R.m[row][1], k->X.R.m[row][2]);
		text_printf(out, "  mass %.17Lg h %.17Lg %.17Lg %.17Lg\n", I->mass, I->h[0], I->h[1], I->h[2]);
		text_printf(out, "  I xx %.17Lg xy %.17Lg xz %.17Lg yy %.17Lg yz %.17Lg zz %.17Lg\n", I->I[0], I->I[1],
			I->I[2], I->I[3], I->I[4], I->I[5]);
	}
}
