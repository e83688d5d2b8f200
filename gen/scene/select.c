#include "scene/select.h"
#include <math.h>
#include <string.h>

struct choosing {
	struct selection *c;
	const struct scene *s;
	const struct robot *r;
	struct rneagen_error *e;
	char *below;                        /* by link: in the subtree */
	char *chain;                        /* by joint: on a chain to a tip */
	const struct scene_choice **locked; /* by joint */
	char *moving;                       /* by joint: named by lock-all-but */
	int has_tips, has_moving, cuts;
};

/* q = multiplier q_leader + offset, through followers of followers to a joint that follows none. */
static void find_leader(const struct robot *r, int joint, enum rneagen_mimic mimic, struct selection_joint *c)
{
	c->leader = joint;
	c->multiplier = within_exact(1);
	for (const struct joint *j = &r->joints[joint]; j->driver >= 0 && mimic == RNEAGEN_MIMIC_HONOUR;
		j = &r->joints[c->leader]) {
		c->offset = within_add(c->offset, within_mul(c->multiplier, j->offset));
		c->multiplier = within_mul(c->multiplier, j->multiplier);
		c->leader = j->driver;
	}
}

/* ---- root and tips ---- */

static enum rneagen_code find_root(struct choosing *k)
{
	const struct scene_choice *root = scene_next(k->s, SCENE_ROOT, NULL);

	k->c->root = root ? scene_link(k->s, root, k->r, root->name, k->e) : k->r->root;
	for (int i = 0; i < k->r->link_count && k->c->root >= 0; i++) {
		int link = i;

		while (link != k->c->root && k->r->links[link].parent_joint >= 0)
			link = k->r->joints[k->r->links[link].parent_joint].parent;
		k->below[i] = link == k->c->root;
	}
	return k->e->code;
}

static void mark_chain(struct choosing *k, int link)
{
	while (link != k->c->root && !k->chain[k->r->links[link].parent_joint]) {
		k->chain[k->r->links[link].parent_joint] = 1;
		link = k->r->joints[k->r->links[link].parent_joint].parent;
	}
}

static enum rneagen_code find_tips(struct choosing *k)
{
	for (const struct scene_choice *tip = NULL; (tip = scene_next(k->s, SCENE_TIP, tip)) != NULL;) {
		int link = scene_link(k->s, tip, k->r, tip->name, k->e);

		if (link < 0)
			return k->e->code;
		if (!k->below[link])
			return scene_refuse(k->s, tip, k->e, "link '%s' is not below the root '%s'", tip->name,
				k->r->links[k->c->root].name);
		mark_chain(k, link);
		k->has_tips = 1;
	}
	for (int j = 0, leader; j < k->r->joint_count; j++) {
		leader = k->c->joints[j].leader;
		if (!k->chain[j] || k->chain[leader] || !k->below[k->r->joints[leader].parent])
			continue;
		mark_chain(k, k->r->joints[leader].child);
		j = -1; /* the new chain may have followers */
	}
	return RNEAGEN_OK;
}

/* ---- which joints are named ---- */

static enum rneagen_code check_holdable(const struct choosing *k, const struct scene_choice *c, int joint)
{
	int leader = k->c->joints[joint].leader;

	if (k->r->joints[joint].type == JOINT_FIXED)
		return scene_refuse(k->s, c, k->e, "joint '%s' is fixed", c->name);
	if (leader != joint)
		return scene_refuse(k->s, c, k->e, "joint '%s' follows joint '%s'; name that one", c->name,
			k->r->joints[leader].name);
	return RNEAGEN_OK;
}

static enum rneagen_code read_value(const struct choosing *k, const struct scene_choice *c, int joint)
{
	enum joint_type type = k->r->joints[joint].type;
	struct within *q = k->c->joints[joint].value;
	double norm;

	if (scene_numbers(k->s, c, q, joint_nq(type), k->e))
		return k->e->code;
	if (type != JOINT_FLOATING)
		return RNEAGEN_OK;
	norm = (double)sqrtl(q[3].x * q[3].x + q[4].x * q[4].x + q[5].x * q[5].x + q[6].x * q[6].x);
	if (fabs(norm - 1) > 1e-6)
		return scene_refuse(k->s, c, k->e, "the quaternion of joint '%s', numbers 4 to 7, is %.9g long, not 1",
			c->name, norm);
	return RNEAGEN_OK;
}

static enum rneagen_code find_locked(struct choosing *k)
{
	for (const struct scene_choice *c = NULL; (c = scene_next(k->s, SCENE_LOCK, c)) != NULL;) {
		int j = scene_joint(k->s, c, k->r, c->name, k->e);

		if (j < 0 || check_holdable(k, c, j))
			return k->e->code;
		if (k->locked[j])
			return scene_refuse(k->s, c, k->e, "joint '%s' is also locked %s; lock it once", c->name,
				scene_place(k->locked[j]).s);
		k->locked[j] = c;
		if (read_value(k, c, j))
			return k->e->code;
	}
	return RNEAGEN_OK;
}

static enum rneagen_code find_moving(struct choosing *k)
{
	for (const struct scene_choice *c = NULL; (c = scene_next(k->s, SCENE_LOCK_ALL_BUT, c)) != NULL;) {
		int j = scene_joint(k->s, c, k->r, c->name, k->e);

		if (j < 0 || check_holdable(k, c, j))
			return k->e->code;
		if (k->locked[j])
			return scene_refuse(k->s, c, k->e, "joint '%s' is locked %s; leave one of the two out", c->name,
				scene_place(k->locked[j]).s);
		if (!k->below[k->r->joints[j].parent])
			return scene_refuse(k->s, c, k->e, "joint '%s' is not below the root '%s'", c->name,
				k->r->links[k->c->root].name);
		if (k->has_tips && !k->chain[j])
			return scene_refuse(k->s, c, k->e, "joint '%s' is not on a chain to a tip", c->name);
		k->moving[j] = 1;
		k->has_moving = 1;
	}
	return RNEAGEN_OK;
}

/* ---- what becomes of each ---- */

/* Why a joint that others may follow is held; NULL if it moves. */
static const char *why_held(const struct choosing *k, int leader)
{
	if (k->locked[leader])
		return scene_word(SCENE_LOCK);
	if (!k->below[k->r->joints[leader].parent])
		return scene_word(SCENE_ROOT);
	if (k->has_tips && !k->chain[leader])
		return scene_word(SCENE_BESIDE);
	return k->has_moving && !k->moving[leader] ? scene_word(SCENE_LOCK_ALL_BUT) : NULL;
}

static void decide(const struct choosing *k, int joint)
{
	struct selection_joint *c = &k->c->joints[joint], *leader = &k->c->joints[c->leader];

	if (k->r->joints[joint].type == JOINT_FIXED)
		return;
	if (k->has_tips && k->cuts && !k->chain[joint] && !k->locked[c->leader]) {
		c->state = SELECTION_GONE;
		return;
	}
	c->why = why_held(k, c->leader);
	if (!c->why)
		return;
	c->state = SELECTION_HELD;
	if (c == leader)
		return;
	c->why = "mimic";
	c->value[0] = within_add(within_mul(c->multiplier, leader->value[0]), c->offset);
}

/* The name in "mass.hand"; NULL where the word is another. */
static const char *name_after(const char *word, const char *kind)
{
	size_t length = strlen(kind);

	return !strncmp(word, kind, length) && word[length] == '.' && word[length + 1] ? word + length + 1 : NULL;
}

static int frees_link(const struct scene *s, const char *link)
{
	for (const struct scene_choice *c = NULL; (c = scene_next(s, SCENE_FREE, c));) {
		const char *mass = name_after(c->name, "mass"), *inertia = name_after(c->name, "inertia");

		if ((mass && !strcmp(mass, link)) || (inertia && !strcmp(inertia, link)))
			return 1;
	}
	return 0;
}

/* ---- what is modelled ---- */

/* The joints below each link, linked so that pushing them one by one leaves the first name on top of the stack. */
struct children {
	int *first, *next; /* by link, by joint; -1: none */
};

static void find_children(struct children *x, const struct robot *r)
{
	for (int i = 0; i < r->link_count; i++)
		x->first[i] = -1;
	for (int j = 0; j < r->joint_count; j++) {
		int parent = r->joints[j].parent;

		x->next[j] = x->first[parent];
		x->first[parent] = j;
	}
}

static enum rneagen_code walk(struct selection *c, const struct robot *r, struct arena *a, struct rneagen_error *e)
{
	size_t links = (size_t)r->link_count, joints = (size_t)r->joint_count;
	struct children below = {arena_alloc(a, links, sizeof(int)), arena_alloc(a, joints, sizeof(int))};
	int *stack = arena_alloc(a, joints, sizeof *stack), depth = 0;

	c->walk = arena_alloc(a, joints, sizeof *c->walk);
	c->reached = arena_alloc(a, links, 1);
	if (a->failed)
		return error_memory(e);
	find_children(&below, r);
	for (int link = c->root;; link = r->joints[c->walk[c->walk_count - 1]].child) {
		c->reached[link] = 1;
		for (int j = below.first[link]; j >= 0; j = below.next[j])
			if (c->joints[j].state != SELECTION_GONE)
				stack[depth++] = j;
		if (!depth)
			return RNEAGEN_OK;
		c->walk[c->walk_count++] = stack[--depth];
	}
}

static enum rneagen_code check_locks(
	const struct selection *c, const struct scene *s, const struct robot *r, struct rneagen_error *e)
{
	for (const struct scene_choice *lock = NULL; (lock = scene_next(s, SCENE_LOCK, lock)) != NULL;) {
		int j = scene_joint(s, lock, r, lock->name, e), counts = 0;

		for (int i = 0; i < c->walk_count; i++)
			counts |= c->joints[c->walk[i]].leader == j;
		if (!counts)
			return scene_refuse(s, lock, e, "joint '%s' is cut away; leave it out", lock->name);
	}
	return RNEAGEN_OK;
}

/* ---- all of it ---- */

static enum rneagen_code select_joints(struct choosing *k, enum rneagen_mimic mimic, struct arena *a)
{
	const struct scene_choice *beside = scene_next(k->s, SCENE_BESIDE, NULL);
	size_t links = (size_t)k->r->link_count, joints = (size_t)k->r->joint_count;

	k->below = arena_alloc(a, links, 1);
	k->chain = arena_alloc(a, joints, 1);
	k->locked = arena_alloc(a, joints, sizeof(struct scene_choice *));
	k->moving = arena_alloc(a, joints, 1);
	if (a->failed)
		return error_memory(k->e);
	for (int j = 0; j < k->r->joint_count; j++) {
		if (k->r->joints[j].type == JOINT_FLOATING)
			k->c->joints[j].value[6] = within_exact(1);
		find_leader(k->r, j, mimic, &k->c->joints[j]);
	}
	k->cuts = beside && !strcmp(beside->value, "drop");
	if (find_root(k) || find_tips(k) || find_locked(k) || find_moving(k))
		return k->e->code;
	for (int j = 0; j < k->r->joint_count; j++)
		decide(k, j);
	return RNEAGEN_OK;
}

enum rneagen_code scene_select(struct selection *c, const struct scene *s, const struct robot *r, enum rneagen_mimic mimic,
	struct arena *a, struct rneagen_error *e)
{
	struct choosing k = {.c = c, .s = s, .r = r, .e = e};

	*c = (struct selection){.joints = arena_alloc(a, (size_t)r->joint_count, sizeof *c->joints),
		.freed = arena_alloc(a, (size_t)r->link_count, 1)};
	if (a->failed)
		return error_memory(e);
	if (select_joints(&k, mimic, a) || walk(c, r, a, e))
		return e->code;
	for (int i = 0; i < r->link_count; i++)
		c->freed[i] = (char)frees_link(s, r->links[i].name);
	return check_locks(c, s, r, e);
}

int selection_moves(const struct selection *c, const struct robot *r, int joint)
{
	return r->joints[joint].type != JOINT_FIXED && c->joints[joint].state == SELECTION_MOVES &&
		c->reached[r->joints[joint].parent];
}

int selection_beyond(const struct joint *j, const struct selection_joint *held)
{
	return j->has_limits && (held->value[0].x < (real)j->lower || held->value[0].x > (real)j->upper);
}
