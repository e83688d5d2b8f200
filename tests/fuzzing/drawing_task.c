#include "drawing.h"
#include <stdio.h>
#include <string.h>

/* A link that moves; NULL if the draw finds none. */
static const char *draw_carried(struct drawing *g)
{
	for (int tries = 0; tries < 6; tries++) {
		size_t i = dice_below(g->d, (size_t)g->r->link_count);

		if (g->tree.links[i].body >= 0)
			return g->r->links[i].name;
	}
	return NULL;
}

static const struct body *draw_body(struct drawing *g, int own_row)
{
	for (int tries = 0; tries < 6; tries++) {
		const struct body *k = &g->tree.bodies[dice_below(g->d, (size_t)g->tree.body_count)];

		if (*k->joint && k->type != JOINT_FIXED && (!own_row || (!k->follower && joint_nq(k->type) == 1)))
			return k;
	}
	return NULL;
}

/* One row, or all, of q, qd, and qdd or tau; or gravity. */
static void draw_fold(struct drawing *g)
{
	const char *word = DICE_WORD(g->d, g->is_forward ? "tau" : "qdd", "qd", "q", "gravity");
	const struct body *k = dice_happen(g->d, 2) ? draw_body(g, 1) : NULL;
	struct text t = drawing_text(g);
	int is_gravity = !strcmp(word, "gravity"), count = is_gravity ? 3 : 1;

	if (!drawing_is_new(g, "fold", word) || (!k && !strcmp(word, "q") && tree_has_type(&g->tree, JOINT_FLOATING)))
		return;
	if (!is_gravity && k)
		text_printf(&t, "%s.%s=", word, k->joint);
	else
		text_printf(&t, "%s=", word);
	drawing_numbers(g, &t, count, 0);
	g->folds_q |= !strcmp(word, "q");
	g->folds_qd |= !strcmp(word, "qd");
	drawing_line(g, SCENE_FOLD, text_string(&t));
}

static int ends_like_rate(const char *name)
{
	size_t n = strlen(name);

	return (n >= 7 && !strcmp(name + n - 7, ":sample")) || (n >= 6 && !strcmp(name + n - 6, ":batch"));
}

/* A constant, and maybe the derivative by it. */
static void draw_free(struct drawing *g)
{
	const char *word = DICE_WORD(g->d, "payload", "mass", "inertia", "offset", "gravity", "armature", "damping", "friction");
	const char *name = NULL;
	const struct body *k = draw_body(g, 1);
	int is_own = *word == 'a' || *word == 'd' || *word == 'f', has_name = !is_own || dice_happen(g->d, 2);
	struct text t = drawing_text(g), d = drawing_text(g), by = drawing_text(g);

	has_name = has_name && strcmp(word, "gravity") != 0;
	if (has_name)
		name = !is_own && strcmp(word, "offset") != 0 ? draw_carried(g) : k ? k->joint : NULL;
	if ((has_name && !name) || (is_own && !k) || !drawing_is_new(g, *word == 'm' || *word == 'i' ? "own" : word, name ? name : ""))
		return;
	text_printf(&t, "%s%s%s", word, name ? "." : "", name ? name : "");
	text_printf(&d, "%s_d%s", g->is_forward ? "dqdd" : "dtau", text_string(&t));
	text_put(&by, text_string(&t));
	if (dice_happen(g->d, 2) || (name && ends_like_rate(name)))
		text_put(&t, DICE_WORD(g->d, ":sample", ":batch"));
	drawing_line(g, SCENE_FREE, text_string(&t));
	if (dice_happen(g->d, 3))
		drawing_line(g, SCENE_WANT, text_string(&d));
	else if (drawing_is_new(g, "", "matrix")) {
		drawing_line(g, SCENE_VJP, g->is_forward ? "qdd" : "tau");
		drawing_line(g, SCENE_BY, text_string(&by));
	}
}

/* What is asked of qdd in place of M, jvp, vjp, dtau_dq and dtau_dqd. */
static void draw_forward(struct drawing *g, size_t matrix)
{
	static const char *const words[] = {"Minv", "qdd", "qdd", "dqdd_dq", "dqdd_dqd"};
	static const enum scene_key keys[] = {SCENE_WANT, SCENE_JVP, SCENE_VJP, SCENE_WANT, SCENE_WANT};

	drawing_line(g, keys[matrix], words[matrix]);
	if (dice_happen(g->d, 2) && drawing_is_new(g, "", "dynamics"))
		drawing_line(g, SCENE_DYNAMICS, g->tree.mimic_count ? "factor" : DICE_WORD(g->d, "articulated", "factor", "auto"));
	if (dice_happen(g->d, 3) && drawing_is_new(g, "", "refine"))
		drawing_line(g, SCENE_REFINE, DICE_WORD(g->d, "1", "2:same", "0", "1:f64"));
}

/* How places are told, and a frame on a link. */
static void draw_form(struct drawing *g)
{
	const char *link = draw_carried(g);
	struct text t = drawing_text(g);

	if (drawing_is_new(g, "", "pose"))
		drawing_line(g, SCENE_POSE, DICE_WORD(g->d, "quaternion", "rows"));
	if (drawing_is_new(g, "", "frame of Jacobians"))
		drawing_line(g, SCENE_FRAME, DICE_WORD(g->d, "world", "world-aligned", "link"));
	if (!link || !drawing_is_new(g, "", "added frame"))
		return;
	text_printf(&t, "added frame=%s,", link);
	drawing_numbers(g, &t, 6, 0);
	drawing_line(g, SCENE_ADD_FRAME, text_string(&t));
	drawing_line(g, SCENE_WANT, DICE_WORD(g->d, "pose.added frame", "jacobian.added frame"));
}

/* As an output, or in a product, which takes long like a matrix. What is given may leave nothing that varies. */
static enum scene_key draw_use(struct drawing *g)
{
	if (g->folds_q || g->folds_qd || !dice_happen(g->d, g->product ? 2 : 6))
		return SCENE_WANT;
	if (!g->product && drawing_is_new(g, "", "matrix")) {
		g->product = dice_happen(g->d, 2) ? SCENE_JVP : SCENE_VJP;
		if (g->product == SCENE_VJP && dice_happen(g->d, 3))
			drawing_line(g, SCENE_JVP, "vjp"); /* second derivatives */
	}
	return g->product ? g->product : SCENE_WANT;
}

static void draw_want(struct drawing *g)
{
	static const char *const words[] = {"tau", "gravity", "bias", "power", "kinetic", "potential", "regressor",
		"com", "vcom", "com_jacobian", "momentum", "momentum_matrix", "dmomentum", "coriolis", "M", "jvp",
		"vjp", "dtau_dq", "dtau_dqd", "wrench", "twist", "accel", "pose", "jacobian", "djacobian",
		"opspace_inv"};
	enum { MATRICES = 14, WRENCH = 19 };
	size_t kind = dice_below(g->d, sizeof words / sizeof *words);
	const struct body *k = draw_body(g, 0);
	const char *name = kind == WRENCH ? (k ? k->joint : NULL) : draw_carried(g);
	struct text t = drawing_text(g);

	if (kind >= MATRICES && kind < WRENCH && !drawing_is_new(g, "", "matrix")) /* one of them, for they take long */
		return;
	if ((!strcmp(words[kind], "dtau_dq") && g->folds_q) || (!strcmp(words[kind], "dtau_dqd") && g->folds_qd))
		return;
	if (g->is_forward && kind >= MATRICES && kind < WRENCH) {
		draw_forward(g, kind - MATRICES);
		return;
	}
	text_put(&t, g->is_forward && kind == 0 ? "qdd" : words[kind]);
	if (kind >= WRENCH && !name)
		return;
	if (kind >= WRENCH)
		text_printf(&t, ".%s", name);
	if (drawing_is_new(g, "want", text_string(&t)))
		drawing_line(g, draw_use(g), text_string(&t));
	if (kind > WRENCH)
		draw_form(g);
}

static void draw_own_terms(struct drawing *g)
{
	const struct body *k = draw_body(g, 1);
	struct text t = drawing_text(g);

	switch (dice_below(g->d, 3)) {
	case 0:
		if (!k || !drawing_is_new(g, "armature", k->joint))
			return;
		text_printf(&t, "%s=%s", k->joint, dice_happen(g->d, 32) ? "-1" : DICE_WORD(g->d, "0.1", "0", "1e-5"));
		drawing_line(g, SCENE_ARMATURE, text_string(&t));
		return;
	case 1:
		if (drawing_is_new(g, "", "damping"))
			drawing_line(g, SCENE_DAMPING, NULL);
		return;
	default:
		if (!g->o.bounded && drawing_is_new(g, "", "friction"))
			drawing_line(g, SCENE_FRICTION, DICE_WORD(g->d, NULL, "0.1", "1e-3"));
	}
}

static void draw_push(struct drawing *g)
{
	const char *link = draw_carried(g);

	if (link && drawing_is_new(g, "fext", link))
		drawing_line(g, SCENE_FEXT, link);
	if (dice_happen(g->d, 3) && drawing_is_new(g, "", "frame"))
		drawing_line(g, SCENE_FEXT_FRAME, DICE_WORD(g->d, "link", "world"));
}

/* Rows of qd on a link's chain, followers' not counted. */
static int chain_rows(const struct drawing *g, const char *link)
{
	int rows = 0, i = 0;

	while (strcmp(g->r->links[i].name, link))
		i++;
	for (int k = g->tree.links[i].body; k >= 0; k = g->tree.bodies[k].parent)
		rows += g->tree.bodies[k].follower ? 0 : joint_nv(g->tree.bodies[k].type);
	return rows;
}

/* A link that stands. Its chain may turn about alike axes, and it is refused. */
static void draw_contact(struct drawing *g)
{
	const char *link = draw_carried(g);
	int rows = link && g->is_forward ? chain_rows(g, link) : 0, is_weld = rows >= 6 && dice_happen(g->d, 2);
	struct text force = drawing_text(g), freed = drawing_text(g);

	if (rows < 3 || !drawing_is_new(g, "", "contact"))
		return;
	text_printf(&force, "%s.%s", is_weld ? "weld" : "contact", link);
	text_printf(&freed, "accel.%s", link);
	drawing_line(g, is_weld ? SCENE_WELD : SCENE_CONTACT, link);
	if (dice_happen(g->d, 2))
		drawing_line(g, draw_use(g), text_string(&force));
	if (dice_happen(g->d, 4))
		drawing_line(g, SCENE_FREE, text_string(&freed));
}

/* Of what no other line folds. */
static void draw_range(struct drawing *g)
{
	const char *word = DICE_WORD(g->d, g->is_forward ? "tau" : "qdd", "qd", "q");
	const struct body *k = *word == 'q' && !word[1] ? draw_body(g, 1) : NULL;
	struct text t = drawing_text(g);

	if (!drawing_is_new(g, "fold", word) || (!k && !word[1]))
		return;
	text_printf(&t, k ? "%s.%s=" : "%s=", word, k ? k->joint : "");
	text_put(&t, dice_happen(g->d, 32) ? "1,-1" : DICE_WORD(g->d, "-1,1", "0,0", "-0.5,3e2"));
	drawing_line(g, SCENE_RANGE, text_string(&t));
}

static void draw_constants(struct drawing *g)
{
	static const struct {
		enum scene_key key;
		const char *words[4];
	} choices[] = {{SCENE_SNAP_ANGLE, {"1e-3", "0.1", "0", "1e-9"}}, {SCENE_ROUND_CONSTANTS, {"4", "1", "17", "9"}},
		{SCENE_DROP_BELOW, {"1e-3", "0", "1e-12", "0.9"}},
		{SCENE_DERIVATIVES, {"forward", "recursion", "forward", "recursion"}}, {SCENE_DENSE, {NULL}}};
	size_t count = sizeof choices / sizeof *choices, i = dice_below(g->d, count + 1);

	if (i == count)
		draw_range(g);
	else if (drawing_is_new(g, "", scene_word(choices[i].key)))
		drawing_line(g, choices[i].key, dice_happen(g->d, 64) ? "18" : choices[i].words[dice_below(g->d, 4)]);
}

void drawing_task(struct drawing *g)
{
	g->is_forward = dice_happen(g->d, 3);
	if (g->is_forward) {
		drawing_is_new(g, "want", "qdd");
		drawing_line(g, SCENE_WANT, "qdd");
	}
	for (size_t n = dice_below(g->d, 5); n > 0; n--) {
		static void (*const draws[])(struct drawing *) = {draw_want, draw_fold, draw_free, draw_want,
			draw_push, draw_own_terms, draw_constants, draw_want, draw_contact};

		draws[dice_below(g->d, sizeof draws / sizeof *draws)](g);
	}
	if (dice_happen(g->d, 6))
		drawing_line(g, SCENE_PARAMS, DICE_WORD(g->d, "base", "auto", "urdf"));
}
