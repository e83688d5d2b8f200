#include "scene/select.h"
#include "tree/tree.h"
#include <math.h>
#include <string.h>

struct cutting {
	struct selection *c;
	const struct scene *s;
	const struct robot *r;
	struct rneagen_error *e;
	char *below;                        /* by link: in the subtree */
	char *chain;                        /* by joint: on a chain to a tip */
	const struct scene_choice **locked; /* by joint */
	char *moving;                       /* by joint: named by lock-all-but */
	int has_tips, has_moving, drop;
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

static enum rneagen_code find_root(struct cutting *k)
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

static void mark_chain(struct cutting *k, int link)
{
	while (link != k->c->root && !k->chain[k->r->links[link].parent_joint]) {
		k->chain[k->r->links[link].parent_joint] = 1;
		link = k->r->joints[k->r->links[link].parent_joint].parent;
	}
}

static enum rneagen_code find_tips(struct cutting *k)
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

static enum rneagen_code check_holdable(const struct cutting *k, const struct scene_choice *c, int joint)
{
	int leader = k->c->joints[joint].leader;

	if (k->r->joints[joint].type == JOINT_FIXED)
		return scene_refuse(k->s, c, k->e, "joint '%s' is fixed", c->name);
	if (leader != joint)
		return scene_refuse(k->s, c, k->e, "joint '%s' follows joint '%s'; name that one", c->name,
			k->r->joints[leader].name);
	return RNEAGEN_OK;
}

static enum rneagen_code read_value(const struct cutting *k, const struct scene_choice *c, int joint)
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

static enum rneagen_code find_locked(struct cutting *k)
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

static enum rneagen_code find_moving(struct cutting *k)
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
static const char *why_held(const struct cutting *k, int leader)
{
	if (k->locked[leader])
		return scene_word(SCENE_LOCK);
	if (!k->below[k->r->joints[leader].parent])
		return scene_word(SCENE_ROOT);
	if (k->has_tips && !k->chain[leader])
		return scene_word(SCENE_BESIDE);
	return k->has_moving && !k->moving[leader] ? scene_word(SCENE_LOCK_ALL_BUT) : NULL;
}

static void decide(const struct cutting *k, int joint)
{
	struct selection_joint *c = &k->c->joints[joint], *leader = &k->c->joints[c->leader];

	if (k->r->joints[joint].type == JOINT_FIXED)
		return;
	if (k->has_tips && k->drop && !k->chain[joint] && !k->locked[joint]) {
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

static enum rneagen_code cut_all(struct cutting *k)
{
	const struct scene_choice *beside = scene_next(k->s, SCENE_BESIDE, NULL);

	k->drop = beside && !strcmp(beside->value, "drop");
	if (find_root(k) || find_tips(k) || find_locked(k) || find_moving(k))
		return k->e->code;
	for (int j = 0; j < k->r->joint_count; j++)
		decide(k, j);
	return RNEAGEN_OK;
}

enum rneagen_code scene_select(struct selection *c, const struct scene *s, const struct robot *r, const struct rneagen_options *o,
	struct arena *a, struct rneagen_error *e)
{
	size_t links = (size_t)r->link_count, joints = (size_t)r->joint_count;
	struct cutting k = {.c = c, .s = s, .r = r, .e = e};

	*c = (struct selection){.joints = arena_alloc(a, joints, sizeof *c->joints)};
	k.below = arena_alloc(a, links, 1);
	k.chain = arena_alloc(a, joints, 1);
	k.locked = arena_alloc(a, joints, sizeof(struct scene_choice *));
	k.moving = arena_alloc(a, joints, 1);
	if (a->failed)
		return error_memory(e);
	for (int j = 0; j < r->joint_count; j++) {
		if (r->joints[j].type == JOINT_FLOATING)
			c->joints[j].value[6] = within_exact(1);
		find_leader(r, j, o->mimic, &c->joints[j]);
	}
	return cut_all(&k);
}

enum rneagen_code scene_select_check(const struct selection *c, const struct scene *s, const struct robot *r, const char *visited,
	struct rneagen_error *e)
{
	for (const struct scene_choice *lock = NULL; (lock = scene_next(s, SCENE_LOCK, lock)) != NULL;) {
		int j = scene_joint(s, lock, r, lock->name, e), counts = 0;

		for (int i = 0; i < r->joint_count; i++)
			counts |= c->joints[i].leader == j && visited[r->joints[i].child] && visited[r->joints[i].parent];
		if (!counts)
			return scene_refuse(s, lock, e, "joint '%s' is cut away; leave it out", lock->name);
	}
	return RNEAGEN_OK;
}

int selection_beyond(const struct joint *j, const struct selection_joint *held)
{
	return j->has_limits && (held->value[0].x < (real)j->lower || held->value[0].x > (real)j->upper);
}
