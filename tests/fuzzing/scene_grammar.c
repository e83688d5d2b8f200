#include "scene_grammar.h"
#include "scene/scene.h"
#include "support/merged.h"
#include <stdio.h>
#include <string.h>

/* One scene while it is drawn: `tree` is what the lines about joints and links leave, for those about its task. */
struct drawing {
	struct dice *d;
	const struct robot *r;
	struct rneagen_options o;
	struct arena *a;
	struct text out;
	struct tree tree;
	struct text used; /* names that were drawn for something that takes each once, one on a line */
	int folds_q, folds_qd;
	int is_forward; /* qdd is wanted, and tau an input */
	enum scene_key product; /* jvp or vjp, where there is one; 0: not yet */
};

/* ---- words and values ---- */

static const char *draw_number(struct dice *d)
{
	if (dice_happen(d, 64))
		return DICE_WORD(d, "1e300", "-1e300", "1e-300", "5e-324", "1e999", "nan", "0x10", "1,5", "+-1", "1e");
	return DICE_WORD(d, "0", "0.5", "-1.25", "1.5708", "3.14159265358979", "1e-3", "2", "1e-9", "0.1", "-0", "+.5", "100");
}

/* Values with commas between; for a floating joint the last four are a quaternion of length 1. */
static void put_numbers(struct drawing *g, struct text *t, int count, int has_quaternion)
{
	for (int i = 0; i < count; i++) {
		static const char *const quaternions[2][4] = {{"0", "0", "0", "1"}, {"0.6", "0", "-0.8", "0"}};
		const char *number = has_quaternion && i >= 3 ? quaternions[count % 2][i - 3] : draw_number(g->d);

		text_printf(t, "%s%s", i ? "," : "", number);
	}
}

static int is_used(const struct drawing *g, const char *name)
{
	const char *used = text_string(&g->used);
	size_t n = strlen(name);

	for (const char *s = used; (s = strstr(s, name)) != NULL; s++)
		if ((s == used || s[-1] == '\1') && s[n] == '\1')
			return 1;
	return 0;
}

/* Has this been drawn before, in a line that must not say it twice? Now it has. */
static int is_new(struct drawing *g, const char *kind, const char *name)
{
	struct text t;

	text_init(&t, g->a);
	text_printf(&t, "%s %s", kind, name);
	if (is_used(g, text_string(&t)) && !dice_happen(g->d, 64))
		return 0;
	text_put(&g->used, text_string(&t));
	text_putc(&g->used, '\1');
	return 1;
}

/* ---- lines ---- */

static int needs_quotes(const char *value)
{
	size_t n = strlen(value);

	return n && (*value == '"' || strchr(value, '#') || strpbrk(value, "\n\r\t") || *value == ' ' || value[n - 1] == ' ');
}

/* A line of the scene as a file has it, or as the command writes its own. */
static void put_line(struct drawing *g, enum scene_key key, const char *value)
{
	int is_option = dice_happen(g->d, 8);
	struct text *t = &g->out;

	text_printf(t, "%s%s", is_option ? "--" : "", scene_word(key));
	if (value && (is_option || needs_quotes(value) || dice_happen(g->d, 16))) {
		text_put(t, " \"");
		for (const char *s = value; *s; s++)
			text_printf(t, *s == '"' || *s == '\\' ? "\\%c" : *s == '\n' ? "\\n" : "%c", *s);
		text_putc(t, '"');
	} else if (value) {
		text_printf(t, "%s%s", dice_happen(g->d, 16) ? "\t " : " ", value);
	}
	if (dice_happen(g->d, 16))
		text_put(t, DICE_WORD(g->d, " # a comment", "\r", "  ", "\n\n# a line\n"));
	text_putc(t, '\n');
}

static struct text new_text(struct drawing *g)
{
	struct text t;

	text_init(&t, g->a);
	return t;
}

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
	struct text t = new_text(g);

	if (!j || !is_new(g, "hold", j->name))
		return;
	text_printf(&t, "%s%s", j->name, dice_happen(g->d, 16) ? " = " : "=");
	put_numbers(g, &t, joint_nq(j->type), j->type == JOINT_FLOATING);
	put_line(g, SCENE_LOCK, text_string(&t));
}

/* Names, of which one that has a comma stands alone. */
static void draw_moving(struct drawing *g)
{
	struct text t = new_text(g);

	for (size_t n = 1 + dice_below(g->d, 3); n > 0; n--) {
		const struct joint *j = draw_holdable(g);

		if (!j || (t.length && strchr(j->name, ',')) || !is_new(g, "hold", j->name))
			break;
		text_printf(&t, "%s%s", t.length ? "," : "", j->name);
		if (strchr(j->name, ','))
			break;
	}
	if (t.length)
		put_line(g, SCENE_LOCK_ALL_BUT, text_string(&t));
}

static void draw_structure(struct drawing *g)
{
	if (dice_happen(g->d, 6))
		put_line(g, SCENE_ROOT, draw_link(g));
	if (dice_happen(g->d, 4)) {
		put_line(g, SCENE_TIP, draw_link(g));
		if (dice_happen(g->d, 2))
			put_line(g, SCENE_BESIDE, DICE_WORD(g->d, "lock", "drop"));
	}
	for (size_t n = dice_below(g->d, 4); n > 1; n--)
		draw_lock(g);
	if (dice_happen(g->d, 8))
		draw_moving(g);
}

/* ---- the task: what the tree has ---- */

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

static int has_floating(const struct tree *t)
{
	for (int i = 0; i < t->body_count; i++)
		if (t->bodies[i].type == JOINT_FLOATING)
			return 1;
	return 0;
}

/* One row, or all, of q, qd, and qdd or tau; or gravity. */
static void draw_fold(struct drawing *g)
{
	const char *word = DICE_WORD(g->d, g->is_forward ? "tau" : "qdd", "qd", "q", "gravity");
	const struct body *k = dice_happen(g->d, 2) ? draw_body(g, 1) : NULL;
	struct text t = new_text(g);
	int is_gravity = !strcmp(word, "gravity"), count = is_gravity ? 3 : 1;

	if (!is_new(g, "fold", word) || (!k && !strcmp(word, "q") && has_floating(&g->tree)))
		return;
	if (!is_gravity && k)
		text_printf(&t, "%s.%s=", word, k->joint);
	else
		text_printf(&t, "%s=", word);
	put_numbers(g, &t, count, 0);
	g->folds_q |= !strcmp(word, "q");
	g->folds_qd |= !strcmp(word, "qd");
	put_line(g, SCENE_FOLD, text_string(&t));
}

static int ends_like_rate(const char *name)
{
	size_t n = strlen(name);

	return (n >= 7 && !strcmp(name + n - 7, ":sample")) || (n >= 6 && !strcmp(name + n - 6, ":batch"));
}

/* A constant, and maybe the derivative by it. */
static void draw_free(struct drawing *g)
{
	const char *word = DICE_WORD(g->d, "payload", "mass", "inertia", "offset", "gravity"), *name = NULL;
	const struct body *k = draw_body(g, 1);
	struct text t = new_text(g), d = new_text(g), by = new_text(g);

	if (!strcmp(word, "offset"))
		name = k ? k->joint : NULL;
	else if (strcmp(word, "gravity") != 0)
		name = draw_carried(g);
	if ((!name && strcmp(word, "gravity") != 0) || !is_new(g, *word == 'm' || *word == 'i' ? "own" : word, name ? name : ""))
		return;
	text_printf(&t, "%s%s%s", word, name ? "." : "", name ? name : "");
	text_printf(&d, "%s_d%s", g->is_forward ? "dqdd" : "dtau", text_string(&t));
	text_put(&by, text_string(&t));
	if (dice_happen(g->d, 2) || (name && ends_like_rate(name)))
		text_put(&t, DICE_WORD(g->d, ":sample", ":batch"));
	put_line(g, SCENE_FREE, text_string(&t));
	if (dice_happen(g->d, 3))
		put_line(g, SCENE_WANT, text_string(&d));
	else if (is_new(g, "", "matrix")) {
		put_line(g, SCENE_VJP, g->is_forward ? "qdd" : "tau");
		put_line(g, SCENE_BY, text_string(&by));
	}
}

/* What is asked of qdd in place of M, jvp, vjp, dtau_dq and dtau_dqd. */
static void draw_forward(struct drawing *g, size_t matrix)
{
	static const char *const words[] = {"Minv", "qdd", "qdd", "dqdd_dq", "dqdd_dqd"};
	static const enum scene_key keys[] = {SCENE_WANT, SCENE_JVP, SCENE_VJP, SCENE_WANT, SCENE_WANT};

	put_line(g, keys[matrix], words[matrix]);
	if (dice_happen(g->d, 2) && is_new(g, "", "dynamics"))
		put_line(g, SCENE_DYNAMICS, g->tree.mimic_count ? "factor" : DICE_WORD(g->d, "articulated", "factor", "auto"));
	if (dice_happen(g->d, 3) && is_new(g, "", "refine"))
		put_line(g, SCENE_REFINE, DICE_WORD(g->d, "1", "2:same", "0", "1:f64"));
}

/* How places are told, and a frame on a link. */
static void draw_form(struct drawing *g)
{
	const char *link = draw_carried(g);
	struct text t = new_text(g);

	if (is_new(g, "", "pose"))
		put_line(g, SCENE_POSE, DICE_WORD(g->d, "quaternion", "rows"));
	if (is_new(g, "", "frame of Jacobians"))
		put_line(g, SCENE_FRAME, DICE_WORD(g->d, "world", "world-aligned", "link"));
	if (!link || !is_new(g, "", "added frame"))
		return;
	text_printf(&t, "added frame=%s,", link);
	put_numbers(g, &t, 6, 0);
	put_line(g, SCENE_ADD_FRAME, text_string(&t));
	put_line(g, SCENE_WANT, DICE_WORD(g->d, "pose.added frame", "jacobian.added frame"));
}

/* As an output, or in a product, which takes long like a matrix. What is given may leave nothing that varies. */
static enum scene_key draw_use(struct drawing *g)
{
	if (g->folds_q || g->folds_qd || !dice_happen(g->d, g->product ? 2 : 6))
		return SCENE_WANT;
	if (!g->product && is_new(g, "", "matrix"))
		g->product = dice_happen(g->d, 2) ? SCENE_JVP : SCENE_VJP;
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
	struct text t = new_text(g);

	if (kind >= MATRICES && kind < WRENCH && !is_new(g, "", "matrix")) /* one of them, for they take long */
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
	if (is_new(g, "want", text_string(&t)))
		put_line(g, draw_use(g), text_string(&t));
	if (kind > WRENCH)
		draw_form(g);
}

static void draw_own_terms(struct drawing *g)
{
	const struct body *k = draw_body(g, 1);
	struct text t = new_text(g);

	switch (dice_below(g->d, 3)) {
	case 0:
		if (!k || !is_new(g, "armature", k->joint))
			return;
		text_printf(&t, "%s=%s", k->joint, dice_happen(g->d, 32) ? "-1" : DICE_WORD(g->d, "0.1", "0", "1e-5"));
		put_line(g, SCENE_ARMATURE, text_string(&t));
		return;
	case 1:
		if (is_new(g, "", "damping"))
			put_line(g, SCENE_DAMPING, NULL);
		return;
	default:
		if (!g->o.bounded && is_new(g, "", "friction"))
			put_line(g, SCENE_FRICTION, DICE_WORD(g->d, NULL, "0.1", "1e-3"));
	}
}

static void draw_push(struct drawing *g)
{
	const char *link = draw_carried(g);

	if (link && is_new(g, "fext", link))
		put_line(g, SCENE_FEXT, link);
	if (dice_happen(g->d, 3) && is_new(g, "", "frame"))
		put_line(g, SCENE_FEXT_FRAME, DICE_WORD(g->d, "link", "world"));
}

/* Of what no other line folds. */
static void draw_range(struct drawing *g)
{
	const char *word = DICE_WORD(g->d, g->is_forward ? "tau" : "qdd", "qd", "q");
	const struct body *k = *word == 'q' && !word[1] ? draw_body(g, 1) : NULL;
	struct text t = new_text(g);

	if (!is_new(g, "fold", word) || (!k && !word[1]))
		return;
	text_printf(&t, k ? "%s.%s=" : "%s=", word, k ? k->joint : "");
	text_put(&t, dice_happen(g->d, 32) ? "1,-1" : DICE_WORD(g->d, "-1,1", "0,0", "-0.5,3e2"));
	put_line(g, SCENE_RANGE, text_string(&t));
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
	else if (is_new(g, "", scene_word(choices[i].key)))
		put_line(g, choices[i].key, dice_happen(g->d, 64) ? "18" : choices[i].words[dice_below(g->d, 4)]);
}

static void draw_task(struct drawing *g)
{
	g->is_forward = dice_happen(g->d, 3);
	if (g->is_forward) {
		is_new(g, "want", "qdd");
		put_line(g, SCENE_WANT, "qdd");
	}
	for (size_t n = dice_below(g->d, 5); n > 0; n--) {
		static void (*const draws[])(struct drawing *) = {draw_want, draw_fold, draw_free, draw_want,
			draw_push, draw_own_terms, draw_constants, draw_want};

		draws[dice_below(g->d, sizeof draws / sizeof *draws)](g);
	}
	if (dice_happen(g->d, 6))
		put_line(g, SCENE_PARAMS, DICE_WORD(g->d, "base", "auto", "urdf"));
}

/* The joints with entries in q in another order, their names with commas between. */
static const char *draw_order(struct drawing *g)
{
	int count = g->tree.joint_count - g->tree.floating, first = (int)dice_below(g->d, (size_t)count);
	struct text t = new_text(g);

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
		draw_task(&g);
		*order = draw_order(&g);
	}
	if (dice_happen(d, 8)) {
		*garbled = 1;
		return a->failed || g.out.failed ? NULL : scene_garble(d, text_string(&g.out), a);
	}
	return a->failed || g.out.failed ? NULL : text_string(&g.out);
}
