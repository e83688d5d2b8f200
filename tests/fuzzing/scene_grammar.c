#include "scene_grammar.h"
#include "drawing.h"
#include "support/merged.h"
#include <string.h>

/* ---- which joints and links: what the robot has ---- */

static const char *draw_link(struct drawing *g)
{
	return g->r->links[dice_below(g->d, (size_t)g->r->link_count)].name;
}

static int is_follower(const struct drawing *g, const struct joint *j)
{
	return j->driver >= 0 && g->o.mimic == RNEAGEN_MIMIC_HONOUR;
}

/* A joint that may be held; NULL if the draw finds none. */
static const struct joint *draw_holdable(struct drawing *g)
{
	for (int tries = 0; tries < 4; tries++) {
		const struct joint *j = &g->r->joints[dice_below(g->d, (size_t)g->r->joint_count)];

		if (j->type != JOINT_FIXED && !is_follower(g, j))
			return j;
	}
	return NULL;
}

static void draw_lock(struct drawing *g)
{
	const struct joint *j = draw_holdable(g);
	struct text t = drawing_text(g);

	if (!j || !drawing_is_new(g, "hold", j->name))
		return;
	text_printf(&t, "%s%s", j->name, dice_happen(g->d, 16) ? " = " : "=");
	drawing_numbers(g, &t, joint_nq(j->type), j->type == JOINT_FLOATING);
	drawing_line(g, SCENE_LOCK, text_string(&t));
}

/* Names, of which one that has a comma stands alone. */
static void draw_moving(struct drawing *g)
{
	struct text t = drawing_text(g);

	for (size_t n = 1 + dice_below(g->d, 3); n > 0; n--) {
		const struct joint *j = draw_holdable(g);

		if (!j || (t.length && strchr(j->name, ',')) || !drawing_is_new(g, "hold", j->name))
			break;
		text_printf(&t, "%s%s", t.length ? "," : "", j->name);
		if (strchr(j->name, ','))
			break;
	}
	if (t.length)
		drawing_line(g, SCENE_LOCK_ALL_BUT, text_string(&t));
}

static void draw_structure(struct drawing *g)
{
	if (dice_happen(g->d, 6))
		drawing_line(g, SCENE_ROOT, draw_link(g));
	if (dice_happen(g->d, 4)) {
		drawing_line(g, SCENE_TIP, draw_link(g));
		if (dice_happen(g->d, 2))
			drawing_line(g, SCENE_BESIDE, DICE_WORD(g->d, "lock", "drop"));
	}
	for (size_t n = dice_below(g->d, 4); n > 1; n--)
		draw_lock(g);
	if (dice_happen(g->d, 8))
		draw_moving(g);
}

/* The joints with entries in q in another order, their names with commas between. */
static const char *draw_order(struct drawing *g)
{
	int count = g->tree.joint_count - g->tree.floating, first = (int)dice_below(g->d, (size_t)count);
	struct text t = drawing_text(g);

	if (!dice_happen(g->d, 8))
		return NULL;
	for (int i = 0; i < count; i++)
		text_printf(&t, "%s%s", i ? "," : "", g->tree.joints[g->tree.floating + (first + i) % count].name);
	return count ? text_string(&t) : NULL;
}

/* Joints and links that leave a robot, after a few tries; 0 if they do not. */
static int draw_tree(struct drawing *g)
{
	for (int tries = 0; tries < 4; tries++) {
		struct rneagen_error e = {0};
		struct request k;

		text_init(&g->out, g->a);
		text_init(&g->used, g->a);
		draw_structure(g);
		g->o.scene = text_string(&g->out);
		if (!merged_tree(&g->tree, &k, g->r, &g->o, g->a, &e))
			return 1;
		if (dice_happen(g->d, 8))
			break;
	}
	return 0;
}

const char *scene_draw(struct dice *d, const struct robot *r, const struct rneagen_options *o, const char **order, int *garbled,
	struct arena *a)
{
	struct drawing g = {.d = d, .r = r, .o = *o, .a = a};

	*order = NULL;
	*garbled = 0;
	g.o.order = NULL;
	if (draw_tree(&g)) {
		drawing_task(&g);
		*order = draw_order(&g);
	}
	if (dice_happen(d, 8)) {
		*garbled = 1;
		return a->failed || g.out.failed ? NULL : scene_garble(d, text_string(&g.out), a);
	}
	return a->failed || g.out.failed ? NULL : text_string(&g.out);
}
