/* Poses, Jacobians, rates, centroidal and operational-space quantities against the independent reference, in quad
   precision: random trees (planar, floating, mimic, prismatic, odd axes, merged links, subtree roots, held joints,
   added frames, base parameters), and robots. Would catch a wrong column, frame, sign, arm, place in memory or link. */
#include "kinematics/kin_case.h"
#include "support/exhaustive.h"
#include "support/random_robot.h"
#include "support/suite.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { FIRST = 8100, TREES = 150, LINKS = 9, SAMPLES = 2, TEXT = 4096 };

/* The URDF's numbers are doubles, and zeros stand for the rounding of such. */
static const double NOISE = 4 * 0x1p-53;

static const enum want_kind OF_LINKS[] = {WANT_POSE, WANT_JACOBIAN, WANT_DJACOBIAN, WANT_OPSPACE_INV};
static const enum want_kind OF_ALL[] = {
	WANT_COM, WANT_VCOM, WANT_COM_JACOBIAN, WANT_MOMENTUM, WANT_MOMENTUM_MATRIX, WANT_DMOMENTUM, WANT_CORIOLIS};
enum { LINK_WORDS = sizeof OF_LINKS / sizeof *OF_LINKS, ALL_WORDS = sizeof OF_ALL / sizeof *OF_ALL };

struct words {
	char text[TEXT];
	size_t length;
	int count;
};

static void add(struct words *w, enum want_kind kind, const char *link)
{
	w->length += (size_t)snprintf(w->text + w->length, sizeof w->text - w->length, "%s%s%s%s", w->count++ ? "," : "want ",
		want_type(kind)->word, link ? "." : "", link ? link : "");
}

static void line(struct words *w, const char *text)
{
	w->length += (size_t)snprintf(w->text + w->length, sizeof w->text - w->length, "%s%s", w->length ? "\n" : "", text);
}

static int moves(const struct reference *r, int entry, const char *held)
{
	for (int i = entry; i >= 0; i = r->joints[i].parent)
		if (r->joints[i].type != REFERENCE_FIXED && !(held && !strcmp(r->joints[r->joints[i].driver].name, held)))
			return 1;
	return 0;
}

/* An entry whose link moves; the scene refuses the others. NULL: there is none. */
static const struct reference_joint *some_entry(struct rng *rng, const struct reference *r, const char *held)
{
	int first = rng_below(rng, r->nj);

	for (int i = 0; i < r->nj; i++)
		if (moves(r, (first + i) % r->nj, held))
			return &r->joints[(first + i) % r->nj];
	return NULL;
}

/* The name of a link, or of its joint where that is fixed. */
static const char *some_frame(struct kin_case *c, struct rng *rng, const struct reference *r, const char *held)
{
	const struct reference_joint *j = some_entry(rng, r, held);
	int added = rng_below(rng, 2 * KIN_FRAMES);

	if (added < c->added_count)
		return c->added[added].name;
	return j->type == REFERENCE_FIXED && *j->name && rng_chance(rng, 0.5) ? j->name : j->link;
}

static void draw_added(struct kin_case *c, struct rng *rng, const struct reference *r, const char *held, struct words *w)
{
	for (c->added_count = 0; c->added_count < 2; c->added_count++) {
		struct kin_added *f = &c->added[c->added_count];
		char text[400];

		snprintf(f->name, sizeof f->name, "added_%d", c->added_count);
		snprintf(f->link, sizeof f->link, "%s", some_entry(rng, r, held)->link);
		for (int k = 0; k < 6; k++)
			f->at[k] = rng_chance(rng, 0.3) ? 0 : rng_uniform(rng, -1, 1);
		snprintf(text, sizeof text, "add-frame %s=%s,%.17g,%.17g,%.17g,%.17g,%.17g,%.17g", f->name, f->link,
			f->at[0], f->at[1], f->at[2], f->at[3], f->at[4], f->at[5]);
		line(w, text);
	}
}

static void draw_wants(struct kin_case *c, struct rng *rng, const struct reference *r, const char *held, struct words *w)
{
	static const char *const frames[] = {"frame link", "frame world", "frame world-aligned"};
	struct words wants = {.count = 0};

	for (int i = 0; i < 3; i++) {
		const char *link = some_frame(c, rng, r, held);

		const int is_new = !strstr(wants.text, link);

		for (int k = 0; k < LINK_WORDS && is_new; k++)
			if (rng_chance(rng, 0.5))
				add(&wants, OF_LINKS[k], link);
	}
	for (int k = 0; k < ALL_WORDS; k++)
		if (rng_chance(rng, 0.5))
			add(&wants, OF_ALL[k], NULL);
	if (!wants.count)
		add(&wants, WANT_POSE, some_entry(rng, r, held)->link);
	line(w, wants.text);
	if (strstr(wants.text, "opspace") && rng_chance(rng, 0.7))
		line(w, rng_chance(rng, 0.5) ? "dynamics articulated" : "dynamics factor");
	line(w, frames[rng_below(rng, 3)]);
	if (rng_chance(rng, 0.3))
		line(w, "pose quaternion");
	if (rng_chance(rng, 0.3))
		line(w, "dense");
	if (rng_chance(rng, 0.3))
		line(w, "params base");
}

/* A joint that is held, at no right angle. */
static const char *draw_held(struct rng *rng, const struct reference *r, struct words *w)
{
	char text[200];

	for (int j = 1; j < r->nj && rng_chance(rng, 0.6); j++)
		if (r->joints[j].nv == 1) {
			snprintf(text, sizeof text, "lock %s=0.3125", r->joints[j].name);
			line(w, text);
			return r->joints[j].name;
		}
	return NULL;
}

/* The robot below two links of another, beside a branch that is cut off. */
static char *hang(const char *urdf, const char *root)
{
	char *text = calloc(1, strlen(urdf) + TEXT), *end;

	strcpy(text, urdf);
	end = strstr(text, "</robot>");
	sprintf(end, "<link name='over_0'/><link name='over_1'><inertial><mass value='3'/>"
		"<inertia ixx='1' ixy='0' ixz='0' iyy='1' iyz='0' izz='1'/></inertial></link><link name='over_2'/>"
		"<joint name='up_1' type='continuous'><origin xyz='0.1 0.2 0.3' rpy='1 2 3'/><axis xyz='1 1 0'/><parent link='over_0'/>"
		"<child link='over_1'/></joint><joint name='up_2' type='continuous'><origin xyz='0.4 -0.2 0.3' rpy='0.1 0 2'/>"
		"<parent link='over_1'/><child link='%s'/></joint><joint name='up_3' type='continuous'><parent link='over_1'/>"
		"<child link='over_2'/></joint></robot>", root);
	return text;
}

/* Of a part below a root where `is_part`. Returns 0 where nothing moves, which the generator refuses. */
static int draw_scene(
	struct kin_case *c, struct rng *rng, const struct reference *r, int is_part, const char **held, struct words *w)
{
	char root[200];

	*held = draw_held(rng, r, w);
	if (!some_entry(rng, r, *held))
		return 0;
	draw_added(c, rng, r, *held, w);
	draw_wants(c, rng, r, *held, w);
	snprintf(root, sizeof root, "root %s", r->joints[0].link);
	if (is_part)
		line(w, root);
	line(w, "");
	return 1;
}

/* All joints at zero, floating ones along their parents' axes. */
static void stand_at_zero(struct kin_case *c)
{
	for (int j = 0; j < c->reference->nj; j++) {
		const struct reference_joint *x = &c->reference->joints[j];

		for (int k = 0; k < x->nq; k++)
			c->q[x->iq + k] = x->nq == 7 && k == 6;
	}
	kin_settle(c);
}

/* There the first of w, x, y and z that is not zero is positive, by whatever parameters: texts of one robot then have one sign.
   It would catch a sign that comes of the frames on the way. */
static void check_signs(struct kin_case *c)
{
	static const int order[] = {6, 3, 4, 5};
	const struct request *k = &c->analysis.request;

	stand_at_zero(c);
	kin_evaluate(c);
	for (int i = 0; i < k->want_count; i++) {
		struct kin_matrix m = kin_found(c, &k->wants[i], c->out);
		int first = 0;

		if (k->wants[i].kind == WANT_POSE && m.lines == 7) {
			while (first < 3 && wide_abs(m.x[order[first]]) < WIDE_C(1e-6))
				first++;
			ck_assert_msg(m.x[order[first]] > 0, "%s: %s has another sign", c->what, k->wants[i].word);
		}
		kin_matrix_free(&m);
	}
}

static int compare(struct kin_case *c, const char *urdf, const char *part, const struct rneagen_options *o,
	const char *held, uint64_t seed)
{
	int compared = 0;

	if (!kin_open(c, urdf, part, o, seed))
		return 0;
	if (held)
		kin_hold(c, held, 0.3125);
	for (int k = 0; k < SAMPLES; k++) {
		kin_draw(c);
		kin_evaluate(c);
		compared += kin_compare(c, NOISE);
	}
	check_signs(c);
	kin_close(c);
	return compared;
}

static int try_tree(uint64_t seed, struct words *w, double *worst)
{
	struct kin_case *c = calloc(1, sizeof *c);
	struct random_robot_knobs knobs = random_robot_knobs(seed, LINKS);
	struct rneagen_options o = rneagen_options_default();
	struct rng rng = rng_seed(seed + 1);
	const struct reference_options ro = {.floating = seed % 3 == 0, .independent = seed % 5 == 2};
	char message[256], *urdf, *hung;
	const char *held;
	int is_part = seed % 4 == 1, compared = 0;

	knobs.odd_names = 0;
	urdf = random_robot(seed, &knobs);
	struct reference *r = reference_open(urdf, strlen(urdf), &ro, message, sizeof message);

	ck_assert_msg(r != NULL, "seed %llu: %s", (unsigned long long)seed, message);
	hung = hang(urdf, r->joints[0].link);
	snprintf(c->what, sizeof c->what, "seed %llu", (unsigned long long)seed);
	o.base = ro.floating ? RNEAGEN_FLOATING : RNEAGEN_FIXED;
	o.mimic = ro.independent ? RNEAGEN_MIMIC_INDEPENDENT : RNEAGEN_MIMIC_HONOUR;
	if (draw_scene(c, &rng, r, is_part, &held, w)) {
		o.scene = w->text;
		compared = compare(c, is_part ? hung : urdf, urdf, &o, held, seed);
	}
	*worst = c->worst > *worst ? c->worst : *worst;
	reference_close(r);
	free(urdf);
	free(hung);
	free(c);
	return compared;
}

START_TEST(trees)
{
	const int count = exhaustive() ? 6 * TREES : TREES;
	double worst = 0;
	int compared = 0;

	for (int i = 0; i < count; i++) {
		struct words *w = calloc(1, sizeof *w);

		compared += try_tree(FIRST + (uint64_t)i, w, &worst);
		free(w);
	}
	printf("trees of seeds %d to %d: %d arrays, off by %.2g of the tolerance at most\n", FIRST, FIRST + count - 1,
		compared, worst);
	ck_assert_int_gt(compared, 4 * count);
}
END_TEST

int main(void)
{
	Suite *suite = suite_create("kinematics");
	TCase *t = tcase_create("kinematics");

	setvbuf(stdout, NULL, _IOLBF, 0);
	tcase_set_timeout(t, 300);
	tcase_add_test(t, trees);
	suite_add_tcase(suite, t);
	return suite_run(suite);
}
