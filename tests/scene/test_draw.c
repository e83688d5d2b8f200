/* What inputs are drawn from: the range of each where the scene says nothing, what --range changes and what it leaves, bodies
   that can be, and how it is told. Seeds are in the options below. */
#define _DEFAULT_SOURCE /* M_PI */
#include "tell/draw_put.h"
#include "support/scene_model.h"
#include "support/generated.h"
#include "support/suite.h"
#include "support/urdf_text.h"
#include <math.h>
#include <stdio.h>
#include <string.h>

enum { COUNT = 400 };

static const struct draw_options OPTIONS = {.seed = 20261121, .count = COUNT};
static const struct draw_options EACH = {.seed = 20261121, .count = COUNT, .each = 1};

/* A joint of each type, one without limits, one whose limits are none; links with a mass, at their origins and not, and
   without. */
static const char urdf[] = ROBOT("r",
	BALL("world") BALL("arm") LINK("hand", "2", "0.1 0 0", "0 0 0", "0.1", "0.01", "0", "0.2", "0", "0.25")
	BARE("tip") BARE("nail") POINT("ball", "3", "0 0 0") BALL("slab") BALL("ship")
	JOINT("turn", "revolute", "world", "arm", AXIS("0 0 1"))
	"<joint name='free' type='continuous'><parent link='arm'/><child link='hand'/><axis xyz='1 0 0'/></joint>"
	"<joint name='far' type='prismatic'><parent link='hand'/><child link='ball'/><axis xyz='0 1 0'/>"
	"<limit effort='1' velocity='2000' lower='-5000' upper='5000'/><dynamics damping='2'/></joint>"
	JOINT("weld", "fixed", "hand", "tip", ORIGIN("0 0 1", "0 0 0")) JOINT("nailed", "fixed", "hand", "nail", "")
	JOINT("slide", "planar", "arm", "slab", AXIS("0 0 1"))
	JOINT("sail", "floating", "arm", "ship", ""));

static const char everything[] =
	"free gravity,mass.hand,mass.nail,inertia.arm,inertia.tip:sample,payload.ball,offset.turn,inertia.ball:sample\n"
	"fext hand\nwant tau,jvp,vjp\n";

struct fixture {
	struct scene_model m;
	struct drawn x;
};

static void open_drawn(struct fixture *f, const char *scene, const char *more, const struct draw_options *o)
{
	struct rneagen_options options = rneagen_options_default();
	char text[2048];

	snprintf(text, sizeof text, "%s%s", scene, more);
	options.scene = text;
	ck_assert_msg(!scene_open(&f->m, urdf, &options), "%s", f->m.error.message);
	ck_assert(draw_inputs(&f->x, &f->m.tree, &f->m.analysis.request, o, &f->m.arena));
}

static const struct drawn_array *array_of(const struct fixture *f, const char *name)
{
	return draw_array(&f->x, &(struct argument){.name = name});
}

/* Within the range, and all over it. */
static void assert_fills(const struct fixture *f, const char *name, int row, double lower, double upper)
{
	const struct drawn_array *a = array_of(f, name);
	double least = (double)INFINITY, most = -(double)INFINITY, width = upper - lower;

	for (size_t k = 0; k < COUNT; k++) {
		least = fmin(least, a->values[k * (size_t)a->rows + (size_t)row]);
		most = fmax(most, a->values[k * (size_t)a->rows + (size_t)row]);
	}
	ck_assert_msg(least >= lower && most <= upper, "%s[%d]: %g to %g is not in %g to %g", name, row, least,
		most, lower, upper);
	ck_assert_msg(least <= lower + 0.05 * width && most >= upper - 0.05 * width, "%s[%d]: %g to %g, and not all of %g to %g",
		name, row, least, most, lower, upper);
}

/* No body has other ten numbers: the pseudo-inertia [S h; h' m], S = tr(I)/2 - I, is positive semidefinite (Wensing, Kim,
   Slotine, Linear matrix inequalities for physically consistent inertial parameter identification, 2018). By Cholesky. */
static void assert_body(const double *p)
{
	double half = (p[4] + p[7] + p[9]) / 2, A[4][4] = {{half - p[4], -p[5], -p[6], p[1]}, {-p[5], half - p[7], -p[8], p[2]},
		{-p[6], -p[8], half - p[9], p[3]}, {p[1], p[2], p[3], p[0]}};

	for (int j = 3; j >= 0; j--) { /* from the mass on */
		ck_assert_msg(A[j][j] > -1e-15, "m %g, h %g %g %g: pivot %d is %g", p[0], p[1], p[2], p[3], j, A[j][j]);
		for (int i = 0; i < j && A[j][j] > 0; i++)
			for (int k = 0; k < j; k++)
				A[i][k] -= A[i][j] * A[j][k] / A[j][j];
	}
}

/* All ten numbers of a body vary by themselves: none is 0, and none the same part of the mass, in all samples. */
static void assert_bodies(const struct fixture *f, const char *name, double lower, double upper)
{
	const struct drawn_array *a = array_of(f, name);

	assert_fills(f, name, 0, lower, upper);
	for (size_t k = 0; k < COUNT; k++)
		assert_body(a->values + 10 * k);
	for (size_t i = 1; i < 10; i++)
		ck_assert(fabs(a->values[i] / a->values[0] - a->values[10 + i] / a->values[10]) > 1e-9);
}

/* What the manual page says. */
START_TEST(defaults)
{
	struct fixture f;
	const struct drawn_array *q;

	open_drawn(&f, everything, "", &EACH);
	/* rows of q: turn 0, free 1, far 2, sail 3 to 9, slide 10 to 12; of qd: sail 3 to 8, slide 9 to 11 */
	ck_assert_str_eq(f.m.tree.joints[3].name, "sail");
	assert_fills(&f, "q", 0, -1, 1);
	assert_fills(&f, "q", 1, -M_PI, M_PI);
	for (int i = 2; i < 6; i++)
		assert_fills(&f, "q", i, -1, 1);
	q = array_of(&f, "q");
	for (const double *u = q->values + 6; u < q->values + COUNT * 13; u += 13)
		ck_assert_double_eq_tol(u[0] * u[0] + u[1] * u[1] + u[2] * u[2] + u[3] * u[3], 1, 1e-15);
	assert_fills(&f, "q", 10, -1, 1);
	assert_fills(&f, "q", 12, -M_PI, M_PI);
	assert_fills(&f, "qd", 0, -1, 1);
	for (int i = 1; i < 4; i++)
		assert_fills(&f, "qd", i, -3, 3);
	assert_fills(&f, "qd", 11, -3, 3);
	assert_fills(&f, "qdd", 4, -10, 10);
	assert_fills(&f, "gravity", 0, -9.81, 9.81);
	assert_fills(&f, "mass_hand", 0, 1.8, 2.2);
	assert_fills(&f, "mass_nail", 0, 0, 1);
	assert_fills(&f, "offset_turn", 0, -0.1, 0.1);
	assert_fills(&f, "fext_hand", 5, -10, 10);
	assert_fills(&f, "jvp_v", 35, -1, 1);
	assert_fills(&f, "vjp_v", 0, -1, 1);
	assert_bodies(&f, "payload_ball", 0, 1);
	assert_bodies(&f, "inertia_arm", 0.9, 1.1);
	assert_bodies(&f, "inertia_tip", 0, 1);
	assert_bodies(&f, "inertia_ball", 2.7, 3.3); /* which has its mass at its origin */
	scene_close(&f.m);
}
END_TEST

/* Where there is no gravity it is drawn all the same. */
START_TEST(no_gravity)
{
	struct fixture f;

	open_drawn(&f, "fold gravity=0,0,0\nfree gravity\n", "", &EACH);
	assert_fills(&f, "gravity", 2, -9.81, 9.81);
	scene_close(&f.m);
}
END_TEST

/* What joints bear: each row about what the scene or the URDF says of its joint; where they say nothing, in a range of its
   kind's own. */
START_TEST(own_terms)
{
	struct fixture f;

	open_drawn(&f, "armature far=20\nfree armature,damping,friction.free\n", "range damping[1]=3,4\nrange friction.free=7,8\n",
		&EACH);
	assert_fills(&f, "armature", 0, 0, 0.1);
	assert_fills(&f, "armature", 2, 18, 22);
	assert_fills(&f, "damping", 0, 0, 1);
	assert_fills(&f, "damping", 1, 3, 4);
	assert_fills(&f, "damping", 2, 1.8, 2.2);
	assert_fills(&f, "friction_free", 0, 7, 8);
	scene_close(&f.m);
}
END_TEST

/* A row has the narrowest range, whichever line comes first; quaternions have none. */
START_TEST(said)
{
	struct fixture f;

	open_drawn(&f, everything,
		"range q.slide[2]=2,3\nrange q.slide=-5,-4\nrange q=10,11\nrange q[0]=0,0.5\nrange qd.sail=7,8\nrange qdd=-1,2\n"
				   "range gravity=0,1\nrange gravity[2]=-9,-8\nrange payload.ball=4,5\nrange inertia.arm=7,9\nrange mass.hand=0,1\n"
				   "range offset.turn=1,2\nrange fext.hand[0]=0,500\nrange vjp_v=2,3\nrange jvp_v[35]=-7,-6\n",
				&EACH);
	assert_fills(&f, "q", 0, 0, 0.5);
	assert_fills(&f, "q", 1, 10, 11);
	assert_fills(&f, "q", 5, 10, 11);
	assert_fills(&f, "q", 6, -1, 1);
	assert_fills(&f, "q", 10, -5, -4);
	assert_fills(&f, "q", 11, -5, -4);
	assert_fills(&f, "q", 12, 2, 3);
	assert_fills(&f, "qd", 2, -3, 3);
	assert_fills(&f, "qd", 3, 7, 8);
	assert_fills(&f, "qd", 8, 7, 8);
	assert_fills(&f, "qd", 9, -3, 3);
	assert_fills(&f, "qdd", 9, -1, 2);
	assert_fills(&f, "gravity", 1, 0, 1);
	assert_fills(&f, "gravity", 2, -9, -8);
	assert_bodies(&f, "payload_ball", 4, 5);
	assert_bodies(&f, "inertia_arm", 7, 9);
	assert_fills(&f, "mass_hand", 0, 0, 1);
	assert_fills(&f, "offset_turn", 0, 1, 2);
	assert_fills(&f, "fext_hand", 0, 0, 500);
	assert_fills(&f, "fext_hand", 1, -10, 10);
	assert_fills(&f, "vjp_v", 11, 2, 3);
	assert_fills(&f, "jvp_v", 35, -7, -6);
	assert_fills(&f, "jvp_v", 34, -1, 1);
	scene_close(&f.m);
}
END_TEST

/* A name that looks like a row is the name. */
START_TEST(names_with_brackets)
{
	static const char text[] = ROBOT("r",
		BALL("world") BALL("a[1]") JOINT("j[0]", "revolute", "world", "a[1]", AXIS("0 0 1")));
	struct rneagen_options o = rneagen_options_default();
	struct fixture f;

	o.scene = "fext a[1]\nrange q.j[0]=0.5,1\nrange qd.j[0][0]=2,3\nrange fext.a[1]=1,2\nrange fext.a[1][5]=4,5";
	ck_assert_msg(!scene_open(&f.m, text, &o), "%s", f.m.error.message);
	ck_assert(draw_inputs(&f.x, &f.m.tree, &f.m.analysis.request, &EACH, &f.m.arena));
	assert_fills(&f, "q", 0, 0.5, 1);
	assert_fills(&f, "qd", 0, 2, 3);
	assert_fills(&f, "fext_a_1_", 4, 1, 2);
	assert_fills(&f, "fext_a_1_", 5, 4, 5);
	scene_close(&f.m);
}
END_TEST

static int is_same(const struct fixture *a, const struct fixture *b, const char *name)
{
	const struct drawn_array *x = array_of(a, name), *y = array_of(b, name);

	return !memcmp(x->values, y->values, COUNT * (size_t)x->rows * sizeof *x->values);
}

/* The range of an input changes no other; another seed changes all. */
START_TEST(apart)
{
	static const char *const others[] = {"q", "qdd", "gravity", "mass_hand", "inertia_arm", "fext_hand", "vjp_v"};
	struct draw_options other = EACH;
	struct fixture f, g, h;

	other.seed++;
	open_drawn(&f, everything, "", &EACH);
	open_drawn(&g, everything, "range payload.ball=2,7\nrange qd=0,0\nrange offset.turn=0,1\n", &EACH);
	open_drawn(&h, everything, "", &other);
	for (size_t i = 0; i < sizeof others / sizeof *others; i++) {
		ck_assert_msg(is_same(&f, &g, others[i]), "%s", others[i]);
		ck_assert_msg(!is_same(&f, &h, others[i]), "%s", others[i]);
	}
	ck_assert(!is_same(&f, &g, "payload_ball") && !is_same(&f, &g, "qd") && !is_same(&f, &g, "offset_turn"));
	scene_close(&f.m);
	scene_close(&g.m);
	scene_close(&h.m);
}
END_TEST

/* One for the batch, or, asked for, one for each sample; every input that a DAG reads is drawn. */
START_TEST(batches)
{
	struct fixture f, g;

	open_drawn(&f, everything, "", &OPTIONS);
	open_drawn(&g, everything, "", &EACH);
	for (int i = 0; i < f.m.dag.argument_count; i++) {
		const struct argument *a = &f.m.dag.arguments[i];

		ck_assert_int_eq(draw_array(&f.x, a) == NULL, a->is_output);
		if (a->is_output)
			continue;
		ck_assert_int_eq(draw_array(&f.x, a)->rows, a->rows);
		ck_assert((draw_rows(&f.x, a, 0) == draw_rows(&f.x, a, 1)) == a->per_batch);
		ck_assert(memcmp(draw_rows(&g.x, a, 0), draw_rows(&g.x, a, 1), (size_t)a->rows * sizeof(double)));
	}
	scene_close(&f.m);
	scene_close(&g.m);
}
END_TEST

/* ---- told ---- */

static void expect(const char *text, const char *part)
{
	ck_assert_msg(strstr(text, part) != NULL, "no '%s' in\n%.6000s", part, text);
}

START_TEST(told)
{
	struct fixture f;
	struct text t;

	open_drawn(&f, everything, "fold qd.sail=0\nfold qdd=0\nrange q.sail=-2,2\nrange gravity[1]=0.25,0.5\n", &EACH);
	text_init(&t, &f.m.arena);
	draw_put(&f.m.analysis, "\n  ", &t);
	ck_assert_str_eq(text_string(&t),
		"q[0] -1..1, q[1] -3.14159..3.14159, q[2] -1..1, q[3..5] -2..2, q[6..9] a rotation, q[10..11] -1..1,\n"
		"  q[12] -3.14159..3.14159, qd[0] -1..1, qd[1..2] -3..3, qd[9..11] -3..3, gravity[0] -9.81..9.81,\n"
		"  gravity[1] 0.25..0.5, gravity[2] -9.81..9.81, mass_hand 1.8..2.2, mass_nail 0..1, inertia_arm a body of 0.9..1.1 kg,\n"
		"  inertia_tip a body of 0..1 kg, payload_ball a body of 0..1 kg, offset_turn -0.1..0.1,\n"
		"  inertia_ball a body of 2.7..3.3 kg, fext_hand -10..10, jvp_v -1..1, vjp_v -1..1");
	text_init(&t, &f.m.arena);
	draw_put_json(&f.m.analysis, " ", &t);
	expect(text_string(&t), "{\"name\": \"q\", \"first\": 3, \"count\": 3, \"kind\": \"number\", \"lower\": -2, \"upper\": 2} "
				"{\"name\": \"q\", \"first\": 6, \"count\": 4, \"kind\": \"rotation\"} ");
	expect(text_string(&t),
		"{\"name\": \"payload_ball\", \"first\": 0, \"count\": 10, \"kind\": \"body\", \"lower\": 0, \"upper\": 1} ");
	scene_close(&f.m);
}
END_TEST

static struct rneagen_result make(const char *scene)
{
	struct rneagen_options o = rneagen_options_default();

	o.scene = scene;
	o.tell = RNEAGEN_TELL_ALL;
	return generated(urdf, &o);
}

/* A text knows of no range but where it states what a changed constant changes, and then in its head alone. */
START_TEST(texts)
{
	struct rneagen_result plain = make(NULL), ranged = make("range q.turn=0,1\nrange qdd=-3,3");
	struct rneagen_result rounded = make("round-constants 5"),
		both = make("round-constants 5\nrange q.turn=0,1\nrange qdd=-3,3");
	const char *functions = strstr(rounded.source, "\n */"), *others = strstr(both.source, "\n */");

	ck_assert(!strcmp(plain.source, ranged.source));
	expect(ranged.info, "\nscene\n  --range q.turn=0,1\n  --range qdd=-3,3\n");
	ck_assert_ptr_null(strstr(ranged.info, "full model"));
	expect(rounded.source, "\n * Drawn are q[0] -1..1, ");
	expect(both.source, " --range q.turn=0,1 ");
	expect(both.source, " q[0] 0..1, ");
	expect(both.source, " qdd -3..3\n");
	expect(both.info, "\n  drawn are q[0] 0..1, ");
	expect(both.info_json, "\"sampled\": {\"states\": 100, \"inputs\": [\n    {\"name\": \"q\", \"first\": 0, ");
	/* behind the head they are the same */
	ck_assert(functions && others && !strcmp(functions, others));
	rneagen_result_free(&plain);
	rneagen_result_free(&ranged);
	rneagen_result_free(&rounded);
	rneagen_result_free(&both);
}
END_TEST

int main(void)
{
	Suite *suite = suite_create("draw");
	TCase *c = tcase_create("draw");

	tcase_add_test(c, defaults);
	tcase_add_test(c, no_gravity);
	tcase_add_test(c, own_terms);
	tcase_add_test(c, said);
	tcase_add_test(c, names_with_brackets);
	tcase_add_test(c, apart);
	tcase_add_test(c, batches);
	tcase_add_test(c, told);
	tcase_add_test(c, texts);
	suite_add_tcase(suite, c);
	return suite_run(suite);
}
