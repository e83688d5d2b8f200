/* What a tree says of itself. */
#include "tree/tree.h"
#include <string.h>

const struct joint *tree_joint_of(const struct robot *r, const struct tree *t, int i)
{
	int k = robot_joint(r, t->joints[i].name);

	return k < 0 ? NULL : &r->joints[k];
}

/* ---- warnings ---- */

/* Links by these names stand for what a robot stands on (REP 105, Gazebo, Pinocchio). */
static int is_world(const char *name)
{
	static const char *const names[] = {"world", "universe", "map", "odom", "ground"};

	for (size_t i = 0; i < sizeof names / sizeof *names; i++)
		if (!strcmp(name, names[i]))
			return 1;
	return 0;
}

static int has_mass(const struct link *l)
{
	return l->has_inertial && l->mass.x != 0;
}

/* Does a link float with the base, by joints that are fixed or held? */
static int is_of_base(const struct tree *t, int link)
{
	int body = t->links[link].body;

	while (body > 0 && t->bodies[body].type == JOINT_FIXED)
		body = t->bodies[body].parent;
	return body == 0;
}

static int count_joints(const struct robot *r, int link)
{
	int n = 0;

	for (int up; (up = r->links[link].parent_joint) >= 0; n++)
		link = r->joints[up].parent;
	return n;
}

/* The link with mass that is the fewest joints from the root; -1 where none has any. */
static int find_base(const struct tree *t, const struct robot *r)
{
	int best = -1;

	for (int i = 0; i < r->link_count; i++)
		if (t->links[i].body >= 0 && has_mass(&r->links[i]) &&
			(best < 0 || count_joints(r, i) < count_joints(r, best)))
			best = i;
	return best;
}

/* A root without mass may hold the robot's frame, and then floats with the links that are fixed to it; one that is the
   world, or to which none is fixed, is seldom what floats. */
void tree_warn(const struct tree *t, struct robot *r, const char *file, struct arena *a)
{
	int root = robot_link(r, t->root), base = find_base(t, r), is_carried = 0;

	if (!t->floating || base < 0 || has_mass(&r->links[root]))
		return;
	for (int i = 0; i < r->link_count; i++)
		is_carried |= has_mass(&r->links[i]) && is_of_base(t, i);
	if (is_world(t->root) || !is_carried)
		robot_warn(r, a, "%s: --base floating floats link '%s', which has no mass; --root '%s' floats that link instead",
			file, t->root, r->links[base].name);
}

void tree_dump(const struct tree *t, struct text *out)
{
	text_printf(out, "tree \"%s\": root link \"%s\", nb %d, nq %d, nv %d, gravity %.17Lg %.17Lg %.17Lg\n", t->robot,
		t->root, t->body_count, t->nq, t->nv, t->gravity[0].x, t->gravity[1].x, t->gravity[2].x);
	for (int i = 0; i < t->body_count; i++) {
		const struct body *k = &t->bodies[i];
		const struct inertia *I = &k->inertia;

		text_printf(out, "body %d link \"%s\" joint \"%s\" %s parent %d axis %c%c iq %d iv %d", k->number, k->link,
			k->joint, joint_type_name(k->type), k->parent < 0 ? -1 : t->bodies[k->parent].number,
			k->sign < 0 ? '-' : '+', "xyz"[k->axis], k->iq, k->iv);
		if (k->follower)
			text_printf(out, " follower multiplier %.17Lg", k->multiplier.x);
		if (k->turn.x != 0)
			text_printf(out, " turn %.17Lg", k->turn.x);
		text_printf(out, "\n  p %.17Lg %.17Lg %.17Lg\n", k->X.p[0].x, k->X.p[1].x, k->X.p[2].x);
		for (int row = 0; row < 3; row++)
			text_printf(out, "  R %.17Lg %.17Lg %.17Lg\n", k->X.R.m[row][0].x, k->X.R.m[row][1].x,
				k->X.R.m[row][2].x);
		text_printf(out, "  mass %.17Lg h %.17Lg %.17Lg %.17Lg\n", I->mass.x, I->h[0].x, I->h[1].x, I->h[2].x);
		text_printf(out, "  I xx %.17Lg xy %.17Lg xz %.17Lg yy %.17Lg yz %.17Lg zz %.17Lg\n", I->I[0].x, I->I[1].x,
			I->I[2].x, I->I[3].x, I->I[4].x, I->I[5].x);
	}
}
