#include "scene/outcome.h"
#include <string.h>

static void list_held(struct outcome *x, const struct selection *c, const struct robot *r)
{
	for (int i = 0; i < c->walk_count; i++) {
		int k = c->walk[i];
		const struct joint *j = &r->joints[k];
		const struct selection_joint *s = &c->joints[k];

		if (s->state == SELECTION_HELD)
			x->held[x->held_count++] = (struct outcome_held){j->name, s->why, j->type, s->value, k,
				selection_beyond(j, s)};
	}
}

static int is_modelled(const struct selection *c, const struct joint *j)
{
	return c->reached[j->child] && c->reached[j->parent];
}

static void list_cut(struct outcome_cut *x, const struct selection *c, const struct robot *r)
{
	for (int i = 0; i < r->link_count; i++)
		if (!c->reached[i]) {
			x->links[x->link_count++] = r->links[i].name;
			x->mass += r->links[i].mass.x;
		}
	for (int j = 0; j < r->joint_count; j++)
		if (r->joints[j].type != JOINT_FIXED && !is_modelled(c, &r->joints[j]))
			x->joints[x->joint_count++] = r->joints[j].name;
}

/* Does --free make such a term of a joint an input, alone or with all others? */
static int is_freed(const struct scene *s, const char *term, const struct joint *j)
{
	size_t length = strlen(term);

	for (const struct scene_choice *c = NULL; (c = scene_next(s, SCENE_FREE, c));)
		if (!strcmp(c->name, term) ||
			(!strncmp(c->name, term, length) && c->name[length] == '.' && !strcmp(c->name + length + 1, j->name)))
			return 1;
	return 0;
}

static void list_ignored(struct outcome_ignored *x, const struct scene *s, const struct selection *c, const struct robot *r)
{
	int damping = !scene_next(s, SCENE_DAMPING, NULL), friction = !scene_next(s, SCENE_FRICTION, NULL);

	for (int i = 0; i < r->joint_count; i++) {
		const struct joint *j = &r->joints[i];

		if (!selection_moves(c, r, i))
			continue;
		if (damping && j->has_dynamics && j->damping.x != 0 && !is_freed(s, "damping", j))
			x->damping[x->damping_count++] = j->name;
		if (friction && j->has_dynamics && j->friction.x != 0 && !is_freed(s, "friction", j))
			x->friction[x->friction_count++] = j->name;
		if (j->has_limits)
			x->limits[x->limit_count++] = j->name;
	}
	x->transmission_count = r->transmission_count;
}

static void list_angle(struct outcome *x, double snap, const char *what, const char *name, const struct within rpy[3])
{
	double off = adjust_off_rpy(rpy, snap > ADJUST_NEARLY ? snap : ADJUST_NEARLY);

	if (off > 0)
		x->angles[x->angle_count++] = (struct outcome_angle){what, name, off};
}

static void list_angles(struct outcome *x, double snap, const struct selection *c, const struct robot *r)
{
	for (int j = 0; j < r->joint_count; j++)
		if (is_modelled(c, &r->joints[j]))
			list_angle(x, snap, "joint", r->joints[j].name, r->joints[j].rpy);
	for (int i = 0; i < r->link_count; i++)
		if (c->reached[i] && r->links[i].has_inertial)
			list_angle(x, snap, "inertial of link", r->links[i].name, r->links[i].com_rpy);
}

enum rneagen_code outcome_list(struct outcome *x, const struct scene *s, const struct adjust *adjust, const struct selection *c,
	const struct robot *r, struct arena *a, struct rneagen_error *e)
{
	size_t links = (size_t)r->link_count, joints = (size_t)r->joint_count;

	*x = (struct outcome){.held = arena_alloc(a, joints, sizeof *x->held)};
	x->cut.links = arena_alloc(a, links, sizeof(char *));
	x->cut.joints = arena_alloc(a, joints, sizeof(char *));
	x->ignored.damping = arena_alloc(a, joints, sizeof(char *));
	x->ignored.friction = arena_alloc(a, joints, sizeof(char *));
	x->ignored.limits = arena_alloc(a, joints, sizeof(char *));
	x->angles = arena_alloc(a, links + joints, sizeof *x->angles);
	if (a->failed)
		return error_memory(e);
	list_held(x, c, r);
	list_cut(&x->cut, c, r);
	list_ignored(&x->ignored, s, c, r);
	list_angles(x, adjust->snap, c, r);
	return RNEAGEN_OK;
}

void outcome_warn(const struct outcome *x, struct robot *r, const char *file, struct arena *a)
{
	for (int i = 0; i < x->held_count; i++)
		if (x->held[i].beyond)
			robot_warn(r, a, "%s: joint '%s' is held at %.9Lg, outside of its limits (%s)", file, x->held[i].name,
				x->held[i].value[0].x, x->held[i].why);
}
