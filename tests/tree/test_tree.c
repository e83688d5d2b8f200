/* The tree that is computed: which bodies and joints there are, in which order, and what is refused. */
#include "support/read.h"
#include "support/suite.h"
#include "support/merged.h"
#include "support/urdf_text.h"
#include <string.h>

#define R(name, parent, child) JOINT(name, "revolute", parent, child, "")
#define F(name, parent, child) JOINT(name, "fixed", parent, child, "")

/* A fork: hub carries 10, 2, B, a and e-acute in the file's order, with joints behind some of them. */
#define FORK                                                                                                                 \
	ROBOT("fork", BARE("hub") BALL("l2") BALL("la") BALL("l10") BALL("lB") BALL("le") BALL("l2z") BALL("l2f") BALL("l2fx")    \
			      BALL("laz") R("\xc3\xa9", "hub", "le") R("a", "hub", "la") R("B", "hub", "lB") R("2", "hub", "l2")      \
				      R("10", "hub", "l10") R("z", "l2", "l2z") F("f", "l2", "l2f") R("x", "l2f", "l2fx")             \
					      F("0", "la", "laz"))

/* Followers of followers: p = 2 m + 0.5, q = -3 p + 0.25 = -6 m - 1.25; m stands between them. */
#define CHAIN                                                                                                                \
	ROBOT("chain", BALL("base") BALL("lm") BALL("lp") BALL("lq") BALL("lz")                                                   \
			       R("m", "base", "lm") JOINT("p", "prismatic", "lm", "lp", MIMIC("m", "2", "0.5"))                       \
				       JOINT("a", "continuous", "base", "lq", MIMIC("p", "-3", "0.25")) R("z", "lp", "lz"))

/* Every type: planar and floating joints take several rows. */
#define TYPES                                                                                                                \
	ROBOT("types", BALL("base") BALL("la") BALL("lb") BALL("lc") BALL("ld") BALL("le") BALL("lf")                             \
			       JOINT("a", "planar", "base", "la", "") JOINT("b", "floating", "la", "lb", "")                          \
				       JOINT("c", "prismatic", "lb", "lc", "") JOINT("d", "continuous", "base", "ld", "")             \
					       F("e", "base", "le") R("f", "le", "lf"))

/* What is computed, in short: nq and nv, then per body its number, joint, parent's number and first rows of q and qd,
   with ' for a follower; or the beginning of the error's code and message. */
static const struct expected {
	const char *urdf, *order;
	enum rneagen_base base;
	enum rneagen_mimic mimic;
	enum rneagen_code code;
	const char *summary;
} expected[] = {
	{FORK, NULL, 0, 0, RNEAGEN_OK, "7 7: 1 10<-1 0 0, 2 2<-1 1 1, 3 x<2 2 2, 4 z<2 3 3, 5 B<-1 4 4, 6 a<-1 5 5, 7 \xc3\xa9<-1 6 6"},
	{FORK, NULL, RNEAGEN_FLOATING, 0, RNEAGEN_OK,
		"14 13: 0 <-1 0 0, 1 10<0 7 6, 2 2<0 8 7, 3 x<2 9 8, 4 z<2 10 9, 5 B<0 11 10, 6 a<0 12 11, 7 \xc3\xa9<0 13 12"},
	{CHAIN, NULL, 0, 0, RNEAGEN_OK, "2 2: 1 a'<-1 0 0, 2 m<-1 0 0, 3 p'<2 0 0, 4 z<3 1 1"},
	{CHAIN, NULL, 0, RNEAGEN_MIMIC_INDEPENDENT, RNEAGEN_OK, "4 4: 1 a<-1 0 0, 2 m<-1 1 1, 3 p<2 2 2, 4 z<3 3 3"},
	{CHAIN, NULL, RNEAGEN_FLOATING, 0, RNEAGEN_OK, "9 8: 0 <-1 0 0, 1 a'<0 7 6, 2 m<0 7 6, 3 p'<2 7 6, 4 z<3 8 7"},
	{TYPES, NULL, 0, 0, RNEAGEN_OK, "13 12: 1 a<-1 0 0, 2 b<1 3 3, 3 c<2 10 9, 4 d<-1 11 10, 5 f<-1 12 11"},
	{TYPES, NULL, RNEAGEN_FLOATING, 0, RNEAGEN_OK,
		"20 18: 0 <-1 0 0, 1 a<0 7 6, 2 b<1 10 9, 3 c<2 17 15, 4 d<0 18 16, 5 f<0 19 17"},
	/* --order moves rows, not bodies */
	{FORK, "a,z,\xc3\xa9,10,B,x,2", 0, 0, RNEAGEN_OK,
		"7 7: 1 10<-1 3 3, 2 2<-1 6 6, 3 x<2 5 5, 4 z<2 1 1, 5 B<-1 4 4, 6 a<-1 0 0, 7 \xc3\xa9<-1 2 2"},
	{CHAIN, "z,m", 0, 0, RNEAGEN_OK, "2 2: 1 a'<-1 1 1, 2 m<-1 1 1, 3 p'<2 1 1, 4 z<3 0 0"},
	{CHAIN, "p,z,a,m", 0, RNEAGEN_MIMIC_INDEPENDENT, RNEAGEN_OK, "4 4: 1 a<-1 2 2, 2 m<-1 3 3, 3 p<2 0 0, 4 z<3 1 1"},
	{TYPES, "f,b,d,a,c", 0, 0, RNEAGEN_OK, "13 12: 1 a<-1 9 8, 2 b<1 1 1, 3 c<2 12 11, 4 d<-1 8 7, 5 f<-1 0 0"},
	{CHAIN, "z,m", RNEAGEN_FLOATING, 0, RNEAGEN_OK, "9 8: 0 <-1 0 0, 1 a'<0 8 7, 2 m<0 8 7, 3 p'<2 8 7, 4 z<3 7 6"},
	/* an order that does not fit */
	{CHAIN, "z,n", 0, 0, RNEAGEN_USAGE, "here: --order names 'n'"},
	{CHAIN, "z,m,z", 0, 0, RNEAGEN_USAGE, "here: --order names joint 'z' twice"},
	{CHAIN, "m,m", 0, 0, RNEAGEN_USAGE, "here: --order names joint 'm' twice"},
	{CHAIN, "z", 0, 0, RNEAGEN_USAGE, "here: --order leaves out joint 'm'"},
	{CHAIN, "z,m,p", 0, 0, RNEAGEN_USAGE, "here: --order names 'p'"},
	{CHAIN, "", 0, 0, RNEAGEN_USAGE, "here: --order names ''"},
	{CHAIN, "z,m,", 0, 0, RNEAGEN_USAGE, "here: --order names ''"},
	{CHAIN, ",z,m", 0, 0, RNEAGEN_USAGE, "here: --order names ''"},
	{CHAIN, "z, m", 0, 0, RNEAGEN_USAGE, "here: --order names ' m'"},
	{CHAIN, "zz,m", 0, 0, RNEAGEN_USAGE, "here: --order names 'zz'"},
	{CHAIN, "Z,m", 0, 0, RNEAGEN_USAGE, "here: --order names 'Z'"},
	{TYPES, "f,b,d,a,c,e", 0, 0, RNEAGEN_USAGE, "here: --order names 'e'"},
	{TYPES, "f,b,d,a,base", 0, 0, RNEAGEN_USAGE, "here: --order names 'base'"},
	{CHAIN, "z,m,", RNEAGEN_FLOATING, 0, RNEAGEN_USAGE, "here: --order names ''"},
	/* nothing that moves */
	{ROBOT("r", BALL("base")), NULL, 0, 0, RNEAGEN_NO_JOINTS, "here: no movable joints in robot 'r'"},
	{ROBOT("r", BALL("base") BALL("l") F("f", "base", "l")), NULL, 0, 0, RNEAGEN_NO_JOINTS, "here: no movable joints"},
	{ROBOT("r", BALL("base") BALL("l") F("f", "base", "l")), "f", 0, 0, RNEAGEN_NO_JOINTS, "here: no movable joints"},
	{ROBOT("r", BALL("base") BALL("l") F("f", "base", "l")), NULL, RNEAGEN_FLOATING, 0, RNEAGEN_OK, "7 6: 0 <-1 0 0"},
	/* no mass anywhere */
	{ROBOT("r", BARE("base") BARE("l") R("j", "base", "l")), NULL, 0, 0, RNEAGEN_OK, "1 1: 1 j<-1 0 0"},
};

static void summarize(const struct tree *t, struct text *out)
{
	text_printf(out, "%d %d:", t->nq, t->nv);
	for (int i = 0; i < t->body_count; i++) {
		const struct body *k = &t->bodies[i];

		text_printf(out, "%s %d %s%s<%d %d %d", i ? "," : "", k->number, k->joint, k->follower ? "'" : "",
			k->parent < 0 ? -1 : t->bodies[k->parent].number, k->iq, k->iv);
	}
}

static struct rneagen_options options_of(const struct expected *x)
{
	struct rneagen_options o = rneagen_options_default();

	o.order = x->order;
	o.base = x->base;
	o.mimic = x->mimic;
	o.file = "here";
	return o;
}

START_TEST(shape)
{
	const struct expected *x = &expected[_i];
	struct rneagen_options o = options_of(x);
	struct read from;
	struct tree t;
	struct request k;
	struct text s;

	read_memory(&from, x->urdf, strlen(x->urdf), "here");
	ck_assert_msg(!from.error.code, "%s", from.error.message);
	text_init(&s, &from.arena);
	ck_assert_msg(merged_tree(&t, &k, &from.robot, &o, &from.arena, &from.error) == x->code, "row %d: %s", _i,
		from.error.message);
	if (x->code) {
		ck_assert_msg(!strncmp(from.error.message, x->summary, strlen(x->summary)), "row %d: %s", _i, from.error.message);
	} else {
		summarize(&t, &s);
		ck_assert_str_eq(text_string(&s), x->summary);
	}
	read_free(&from);
}
END_TEST

/* The table of joints is in order of iq, tells the rows of each, and names the body that has them. */
START_TEST(joints_agree_with_bodies)
{
	const struct expected *x = &expected[_i];
	struct rneagen_options o = options_of(x);
	struct read from;
	struct tree t;
	struct request k;
	int nq = 0, nv = 0;

	if (x->code)
		return;
	read_memory(&from, x->urdf, strlen(x->urdf), "here");
	ck_assert(!merged_tree(&t, &k, &from.robot, &o, &from.arena, &from.error));
	for (int i = 0; i < t.joint_count; i++) {
		const struct tree_joint *j = &t.joints[i];
		const struct body *b = &t.bodies[j->body];

		ck_assert_int_eq(j->iq, nq);
		ck_assert_int_eq(j->iv, nv);
		ck_assert_int_eq(b->iq, nq);
		ck_assert_int_eq(b->iv, nv);
		ck_assert_str_eq(j->name, b->joint);
		ck_assert_int_eq(j->type, b->type);
		ck_assert_int_eq(j->nq, joint_nq(b->type));
		ck_assert_int_eq(j->nv, joint_nv(b->type));
		ck_assert(!b->follower && b->multiplier.x == 1);
		nq += j->nq;
		nv += j->nv;
	}
	ck_assert_int_eq(nq, t.nq);
	ck_assert_int_eq(nv, t.nv);
	ck_assert_int_eq(t.joint_count + t.mimic_count, t.body_count);
	read_free(&from);
}
END_TEST

START_TEST(rows_of_types)
{
	static const int rows[][3] = {{JOINT_FIXED, 0, 0}, {JOINT_REVOLUTE, 1, 1}, {JOINT_CONTINUOUS, 1, 1},
		{JOINT_PRISMATIC, 1, 1}, {JOINT_PLANAR, 3, 3}, {JOINT_FLOATING, 7, 6}};

	for (int i = 0; i < 6; i++) {
		ck_assert_int_eq(joint_nq((enum joint_type)rows[i][0]), rows[i][1]);
		ck_assert_int_eq(joint_nv((enum joint_type)rows[i][0]), rows[i][2]);
	}
}
END_TEST

START_TEST(mimic_chains_are_resolved)
{
	struct rneagen_options o = rneagen_options_default();
	struct read from;
	struct tree t;
	struct request k;

	read_memory(&from, CHAIN, strlen(CHAIN), "here");
	ck_assert(!merged_tree(&t, &k, &from.robot, &o, &from.arena, &from.error));
	ck_assert_int_eq(t.mimic_count, 2);
	ck_assert_str_eq(t.mimics[0].name, "a");
	ck_assert_str_eq(t.mimics[0].driver, "m");
	ck_assert(t.mimics[0].multiplier.x == -6 && t.mimics[0].offset.x == -1.25L);
	ck_assert(t.bodies[t.mimics[0].body].multiplier.x == -6);
	ck_assert_str_eq(t.mimics[1].name, "p");
	ck_assert_str_eq(t.mimics[1].driver, "m");
	ck_assert(t.mimics[1].multiplier.x == 2 && t.mimics[1].offset.x == 0.5L);
	o.mimic = RNEAGEN_MIMIC_INDEPENDENT;
	ck_assert(!merged_tree(&t, &k, &from.robot, &o, &from.arena, &from.error));
	ck_assert_int_eq(t.mimic_count, 0);
	for (int i = 0; i < t.body_count; i++)
		ck_assert(t.bodies[i].multiplier.x == 1 && !t.bodies[i].follower);
	read_free(&from);
}
END_TEST

int main(void)
{
	Suite *suite = suite_create("tree");
	TCase *c = tcase_create("shape");

	tcase_add_loop_test(c, shape, 0, sizeof expected / sizeof *expected);
	tcase_add_loop_test(c, joints_agree_with_bodies, 0, sizeof expected / sizeof *expected);
	tcase_add_test(c, rows_of_types);
	tcase_add_test(c, mimic_chains_are_resolved);
	suite_add_tcase(suite, c);
	return suite_run(suite);
}
