/* What a tree says of itself. */
#include "tree.h"

const struct joint *tree_joint_of(const struct robot *r, const struct tree *t, int i)
{
	int k = robot_joint(r, t->joints[i].name);

	return k < 0 ? NULL : &r->joints[k];
}

void tree_warn(const struct tree *t, struct robot *r, const char *file, struct arena *a)
{
	for (int i = 0; i < t->held_count; i++)
		if (t->held[i].beyond)
			robot_warn(r, a, "%s: joint '%s' is held at %.9Lg, outside of its limits (%s)", file, t->held[i].name,
				t->held[i].value[0], t->held[i].why);
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
		if (k->turn != 0)
			text_printf(out, " turn %.17Lg", k->turn);
		text_printf(out, "\n  p %.17Lg %.17Lg %.17Lg\n", k->X.p[0], k->X.p[1], k->X.p[2]);
		for (int row = 0; row < 3; row++)
			text_printf(out, "  R %.17Lg %.17Lg %.17Lg\n", k->X.R.m[row][0], k->X.R.m[row][1], k->X.R.m[row][2]);
		text_printf(out, "  mass %.17Lg h %.17Lg %.17Lg %.17Lg\n", I->mass, I->h[0], I->h[1], I->h[2]);
		text_printf(out, "  I xx %.17Lg xy %.17Lg xz %.17Lg yy %.17Lg yz %.17Lg zz %.17Lg\n", I->I[0], I->I[1],
			I->I[2], I->I[3], I->I[4], I->I[5]);
	}
}
