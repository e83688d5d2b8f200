/* Torques, accelerations and vjp of limbs that share nothing, in parts of the grid: the same bits as of the whole text compiled
   as C, for blocks that have room in shared memory and for others; which texts are in such parts, and which stay whole. */
#include "launched.h"
#include "base/text.h"
#include "plan/grid/hands/hands.h"
#include "support/exhaustive.h"
#include "support/suite.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

_Static_assert((int)HAND_LEVELS <= (int)RNEA_HANDS_LIMIT, "a runtime refuses the table of a text with more kernels of hands");

enum { COUNT = 1300, SEED = 20261124, LARGE_BLOCK = 512 }; /* beyond what the limbs' kernel takes; no multiple of a block */

enum { KERNELS = 5 };

/* A robot of tests/robots, or of "limbs N M": N limbs of M links each on the ground, or of "hands N M": a leg, and a back with
   two arms, each with a hand of N fingers of M links; "fists N M": the first joint of a hand moves them all. */
static const struct subject {
	const char *name, *scene;
	enum rneagen_precision precision;
	enum rneagen_layout layout;
	int floating, parts;
	unsigned hands[KERNELS]; /* of each kernel before the last one */
	int is_long; /* others run nearly the same: where all is asked for */
} APART[] = {
	{"atlas", "", RNEAGEN_F64, RNEAGEN_SOA, 0, 2, {0}, 0},
	{"g1_29dof", "", RNEAGEN_MIXED, RNEAGEN_SOA, 0, 2, {0}, 1},
	{"g1_29dof", "want tau,gravity\nfree gravity\n", RNEAGEN_F64, RNEAGEN_SOA, 0, 2, {0}, 1},
	{"limbs 2 24", "", RNEAGEN_F32, RNEAGEN_SOA, 0, 2, {0}, 1},
	{"g1_29dof", "free gravity:sample\n", RNEAGEN_F64, RNEAGEN_SOA, 0, 2, {0}, 1},
	{"g1_29dof", "want bias\nfree payload.left_ankle_roll_link\n", RNEAGEN_F64, RNEAGEN_SOA, 0, 2, {0}, 1},
	{"limbs 3 16", "", RNEAGEN_F32, RNEAGEN_AOS, 0, 3, {0}, 1},
	{"limbs 3 16", "", RNEAGEN_F64, RNEAGEN_AOS, 0, 3, {0}, 1},
	{"atlas", "want qdd\n", RNEAGEN_F64, RNEAGEN_SOA, 0, 2, {0}, 0},
	{"g1_29dof", "want qdd\nfree gravity:sample\n", RNEAGEN_F32, RNEAGEN_SOA, 0, 2, {0}, 1},
	{"atlas", "want qdd\n", RNEAGEN_F64, RNEAGEN_AOS, 0, 2, {0}, 1},
	{"g1_29dof", "want tau,vjp\n", RNEAGEN_F64, RNEAGEN_SOA, 0, 2, {0}, 0},
	{"g1_29dof", "want tau,vjp\nfree payload.left_ankle_roll_link:sample\n", RNEAGEN_F32, RNEAGEN_SOA, 0, 2, {0}, 1},
	{"hyq", "want tau,vjp\n", RNEAGEN_F64, RNEAGEN_SOA, 1, 1, {0}, 0}, /* the whole, with motion made again */
	{"hyq", "want tau,vjp\nfext lf_foot\nfree gravity\n", RNEAGEN_F64, RNEAGEN_SOA, 1, 1, {0}, 1},
	{"limbs 1 24", "want tau,vjp\n", RNEAGEN_F64, RNEAGEN_SOA, 0, 1, {0}, 1},
	{"atlas", "want tau,gravity\nvjp gravity\n", RNEAGEN_F64, RNEAGEN_SOA, 0, 2, {0}, 1}, /* many zeros */
	{"limbs 2 17", "want tau,bias,gravity\n", RNEAGEN_F64, RNEAGEN_AOS, 0, 2, {0}, 1}, /* whole it would have windows */
	{"hands 5 3", "", RNEAGEN_F64, RNEAGEN_SOA, 0, 2, {2}, 1},
	{"hands 4 4", "", RNEAGEN_F64, RNEAGEN_AOS, 0, 2, {2}, 1},
	{"hands 5 4", "free payload.l2_6:batch\n", RNEAGEN_F64, RNEAGEN_SOA, 0, 2, {2}, 1},
	{"limbs 1 44", "", RNEAGEN_F64, RNEAGEN_SOA, 0, 1, {1, 1}, 0}, /* an arm in three pieces */
	{"hands 5 2", "want tau,vjp\n", RNEAGEN_F64, RNEAGEN_SOA, 0, 2, {2}, 1},
	{"hands 5 3", "want tau,vjp\n", RNEAGEN_F32, RNEAGEN_SOA, 0, 2, {2}, 0},
	{"fists 4 3", "want tau,vjp\n", RNEAGEN_F64, RNEAGEN_SOA, 0, 2, {2}, 1}, /* not the few inputs of a hand are handed on */
	{"limbs 2 40", "want tau,vjp\n", RNEAGEN_F64, RNEAGEN_SOA, 0, 2, {2, 2}, 1}, /* arms in three pieces */
	{"hands 3 3", "want tau,vjp\nfree payload.l2_6:sample\n", RNEAGEN_F64, RNEAGEN_SOA, 0, 2, {2}, 1},
	{"limbs 2 40", "", RNEAGEN_F64, RNEAGEN_AOS, 0, 2, {2, 2}, 1},
	{"chain_75", "", RNEAGEN_F32, RNEAGEN_SOA, 0, 1, {3, 1}, 1},
	{"chain_75", "", RNEAGEN_F64, RNEAGEN_SOA, 0, 1, {3, 1, 1}, 1},
	/* in places of inputs: the vjp in those of q, qd and qdd, tau in that of its weight or its own */
	{"limbs 2 14", "want tau,vjp\n", RNEAGEN_F64, RNEAGEN_AOS, 0, 2, {0}, 1},
	{"limbs 2 8", "want tau,vjp\nfree payload.l1_3:sample\n", RNEAGEN_F64, RNEAGEN_AOS, 0, 1, {0}, 1},
	{"hyq", "want tau,gravity,vjp\nfext lf_foot\nfree gravity\n", RNEAGEN_F64, RNEAGEN_AOS, 1, 1, {0}, 0},
	{"limbs 2 8", "want tau,vjp\nfold qdd=0\n", RNEAGEN_F64, RNEAGEN_AOS, 0, 1, {0}, 1},
	/* qdd and mu found first */
	{"atlas", "vjp qdd\n", RNEAGEN_F64, RNEAGEN_SOA, 0, 2, {2}, 1},
	{"atlas", "vjp qdd\n", RNEAGEN_F32, RNEAGEN_AOS, 0, 1, {1}, 1},
	{"g1_29dof", "vjp qdd\n", RNEAGEN_F64, RNEAGEN_AOS, 0, 2, {2}, 1},
	{"hyq", "vjp qdd\n", RNEAGEN_F64, RNEAGEN_AOS, 1, 1, {1}, 0},
	{"limbs 1 10", "vjp qdd\nfree payload.l0_6:sample\n", RNEAGEN_F64, RNEAGEN_SOA, 0, 1, {1}, 1},
	{"limbs 3 8", "vjp qdd\nfree gravity\n", RNEAGEN_F64, RNEAGEN_AOS, 0, 3, {3}, 1},
	{"hyq", "vjp qdd\nfold tau=0\n", RNEAGEN_F64, RNEAGEN_SOA, 1, 1, {1}, 1},
	{"atlas", "vjp qdd\n", RNEAGEN_F64, RNEAGEN_SOA, 1, 1, {1, 1, 2, 1}, 0}, /* the base's rows first, and its sides, twice */
	{"g1_29dof", "vjp qdd\nfree gravity:batch\n", RNEAGEN_F64, RNEAGEN_SOA, 1, 1, {1, 1, 2, 1}, 1},
	{"atlas", "vjp qdd\n", RNEAGEN_F32, RNEAGEN_SOA, 1, 1, {1, 1, 2}, 1},
	/* forces on what stands, where much waits; those of a limb stand in its rows, and not in the base's, which come next */
	{"atlas", "want qdd\nweld l_foot,r_foot\n", RNEAGEN_F64, RNEAGEN_SOA, 1, 2, {1, 1, 1}, 0},
	{"g1_29dof", "want qdd\nweld left_ankle_roll_link\ncontact right_rubber_hand\n", RNEAGEN_F32, RNEAGEN_SOA, 1, 1, {1}, 1},
	{"hyq", "want qdd\ncontact lf_foot,rf_foot,lh_foot,rh_foot\n", RNEAGEN_F64, RNEAGEN_SOA, 1, 1, {1}, 0},
	{"hyq", "vjp qdd\ncontact lf_foot,rh_foot\n", RNEAGEN_F64, RNEAGEN_SOA, 1, 1, {1, 1}, 1},
	{"hyq", "vjp qdd\ncontact lf_foot,rf_foot,lh_foot,rh_foot\n", RNEAGEN_F32, RNEAGEN_SOA, 1, 1, {1, 1}, 0},
	{"atlas", "vjp qdd\nweld l_foot,r_foot\n", RNEAGEN_F64, RNEAGEN_SOA, 1, 1, {1, 1, 1, 2}, 1},
	{"atlas", "want qdd\ncontact l_hand\n", RNEAGEN_F64, RNEAGEN_SOA, 0, 2, {0}, 1},
	/* qdd, then what its jvp is M^-1 of */
	{"atlas", "jvp qdd\n", RNEAGEN_F64, RNEAGEN_SOA, 0, 2, {2, 2}, 1},
	{"g1_29dof", "jvp qdd\nfree payload.left_ankle_roll_link:sample\n", RNEAGEN_F32, RNEAGEN_SOA, 0, 2, {2, 2}, 1},
	{"hyq", "jvp qdd\nfold tau=0\n", RNEAGEN_F64, RNEAGEN_SOA, 1, 1, {1, 1}, 0},
	{"atlas", "jvp qdd\n", RNEAGEN_F64, RNEAGEN_SOA, 1, 2, {1, 1, 2, 1, 1}, 1},
	{"atlas", "jvp qdd\nfold qd=0\n", RNEAGEN_F32, RNEAGEN_SOA, 1, 1, {1, 1}, 1},
	/* the base's acceleration first */
	{"atlas", "want qdd\n", RNEAGEN_F64, RNEAGEN_SOA, 1, 2, {1, 1}, 0},
	{"atlas", "want qdd\n", RNEAGEN_F64, RNEAGEN_AOS, 1, 2, {1, 1}, 1},
	{"g1_29dof", "want qdd\nfree payload.left_ankle_roll_link:sample\n", RNEAGEN_F64, RNEAGEN_SOA, 1, 2, {1, 1}, 1},
	{"g1_29dof", "want qdd\nfold qd=0\nfree gravity:batch\n", RNEAGEN_F64, RNEAGEN_AOS, 1, 2, {1}, 1},
	/* sides of a base */
	{"atlas", "want tau,vjp\n", RNEAGEN_F64, RNEAGEN_SOA, 1, 1, {1}, 0},
	{"atlas", "want tau,vjp\n", RNEAGEN_F32, RNEAGEN_SOA, 1, 1, {1}, 1},
	{"g1_29dof", "want tau,vjp\nfree payload.left_ankle_roll_link:sample\n", RNEAGEN_F64, RNEAGEN_SOA, 1, 1, {1}, 1},
	{"g1_29dof", "want vjp\nfree gravity:batch\nfext left_ankle_roll_link,pelvis\n", RNEAGEN_F64, RNEAGEN_SOA, 1, 1, {1}, 1},
};

/* The others: a base that moves, few operations, rows that stand apart, slices without room, other outputs, refinement, a
   precision that was not measured, hands in f32, ends of long arms in f32 in aos. */
static const struct subject WHOLE[] = {
	{"atlas", "", RNEAGEN_F64, RNEAGEN_SOA, 1, 1, {0}, 0},
	{"g1_29dof", "", RNEAGEN_F32, RNEAGEN_SOA, 0, 1, {0}, 1},
	{"hands 5 3", "", RNEAGEN_F32, RNEAGEN_AOS, 0, 1, {0}, 0},
	{"limbs 1 62", "", RNEAGEN_F32, RNEAGEN_AOS, 0, 1, {0}, 1},
	{"hyq", "", RNEAGEN_F64, RNEAGEN_SOA, 0, 1, {0}, 0},
	{"limbs 3 7", "", RNEAGEN_F64, RNEAGEN_AOS, 0, 1, {0}, 0},
	{"g1_29dof", "want tau,power\n", RNEAGEN_F64, RNEAGEN_SOA, 0, 1, {0}, 0},
	{"hyq", "want tau,vjp\n", RNEAGEN_F64, RNEAGEN_SOA, 0, 1, {0}, 0},
	{"hands 5 3", "want tau,vjp\n", RNEAGEN_F32, RNEAGEN_AOS, 0, 1, {0}, 1},
	{"atlas", "want tau,vjp\n", RNEAGEN_F32, RNEAGEN_AOS, 0, 1, {0}, 0},
	{"atlas", "want tau,gravity\nvjp gravity\n", RNEAGEN_F64, RNEAGEN_AOS, 0, 1, {0}, 0}, /* no qd, no qdd: no places */
	{"limbs 2 50", "want tau,vjp\n", RNEAGEN_F64, RNEAGEN_AOS, 0, 1, {0}, 1}, /* slices without room */
	{"atlas", "want qdd\n", RNEAGEN_F32, RNEAGEN_AOS, 0, 1, {0}, 0},
	{"g1_29dof", "want qdd\nrefine 1\n", RNEAGEN_F32, RNEAGEN_SOA, 0, 1, {0}, 0},
	{"g1_29dof", "want qdd\n", RNEAGEN_MIXED, RNEAGEN_AOS, 0, 1, {0}, 0},
	{"panda", "vjp qdd\n", RNEAGEN_F64, RNEAGEN_SOA, 0, 1, {0}, 0}, /* it holds little */
	{"hyq", "vjp qdd\n", RNEAGEN_F32, RNEAGEN_AOS, 1, 1, {0}, 1},
	{"atlas", "want qdd\n", RNEAGEN_F32, RNEAGEN_SOA, 1, 1, {0}, 1},
	{"hyq", "want qdd\n", RNEAGEN_F64, RNEAGEN_SOA, 1, 1, {0}, 0},
	{"atlas", "want qdd,power\n", RNEAGEN_F64, RNEAGEN_SOA, 1, 1, {0}, 1},
	{"hyq", "vjp qdd\nfold tau=0\n", RNEAGEN_F64, RNEAGEN_AOS, 1, 1, {0}, 0}, /* mu takes the place of tau */
	{"hyq", "vjp qdd\nfold qd=0\n", RNEAGEN_F64, RNEAGEN_AOS, 1, 1, {0}, 1},
	{"hyq", "vjp qdd\nrefine 1\n", RNEAGEN_F64, RNEAGEN_SOA, 1, 1, {0}, 1},
	{"hyq", "want qdd\nvjp qdd\n", RNEAGEN_F64, RNEAGEN_SOA, 1, 1, {0}, 1},
	{"hyq", "jvp qdd\n", RNEAGEN_F64, RNEAGEN_AOS, 1, 1, {0}, 1},
	{"hyq", "want qdd,contact.lf_foot\ncontact lf_foot,rf_foot,lh_foot,rh_foot\n", RNEAGEN_F64, RNEAGEN_SOA, 1, 1, {0}, 1},
	{"panda", "jvp qdd\n", RNEAGEN_F32, RNEAGEN_SOA, 0, 1, {0}, 1},
	{"hyq", "want qdd\njvp qdd\n", RNEAGEN_F64, RNEAGEN_SOA, 1, 1, {0}, 1},
	{"g1_29dof", "want qdd,qdd_bound\n", RNEAGEN_F64, RNEAGEN_SOA, 0, 1, {0}, 0},
	{"chain_75", "", RNEAGEN_F32, RNEAGEN_AOS, 0, 1, {0}, 1}, /* parts would be staged, and leave rows of their slices unwritten */
};

/* Links l<limb>_0, l<limb>_1, ..., the first of which hangs on another link. Joints follow the first of limb `driver`; -1: none
   does. */
static void put_limb(struct text *t, int limb, int links, const char *parent, int driver)
{
	static const char *const axes[] = {"0 0 1", "0 1 0", "1 0 0"};

	for (int link = 0; link < links; link++) {
		text_printf(t, "<link name='l%d_%d'><inertial><origin xyz='0.1 0.02 %g'/><mass value='%d'/><inertia ixx='0.02' iyy='0.03' "
			"izz='0.04' ixy='0.001' ixz='0.002' iyz='0.003'/></inertial></link>\n", limb, link, 0.01 * limb, 1 + link % 3);
		text_printf(t, "<joint name='j%02d_%02d' type='revolute'><parent link='", limb, link);
		if (link)
			text_printf(t, "l%d_%d", limb, link - 1);
		else
			text_put(t, parent);
		text_printf(t, "'/><child link='l%d_%d'/><origin xyz='0.2 0 0.1' rpy='0.3 0 0'/><axis xyz='%s'/><limit lower='-3' upper='3' "
			"effort='9' velocity='3'/>", limb, link, axes[(limb + link) % 3]);
		if (driver >= 0 && (limb != driver || link))
			text_printf(t, "<mimic joint='j%02d_00' multiplier='%g'/>", driver, 0.5 + 0.1 * link);
		text_put(t, "</joint>\n");
	}
}

/* Limb 0 is the leg, 1 the back, 2 and 3 are the arms. */
static void put_hands(struct text *t, int fingers, int links, int are_fists)
{
	put_limb(t, 0, 6, "ground", -1);
	put_limb(t, 1, 2, "ground", -1);
	for (int arm = 2; arm < 4; arm++) {
		put_limb(t, arm, 7, "l1_1", -1);
		for (int finger = 0; finger < fingers; finger++)
			put_limb(t, 10 * arm + finger, links, arm == 2 ? "l2_6" : "l3_6", are_fists ? 10 * arm : -1);
	}
}

/* A trunk, and two arms at its end. */
static void put_fork(struct text *t, int trunk, int links)
{
	char end[16];

	put_limb(t, 0, trunk, "ground", -1);
	snprintf(end, sizeof end, "l0_%d", trunk - 1);
	put_limb(t, 1, links, end, -1);
	put_limb(t, 2, links, end, -1);
}

static void generate(const struct subject *s, const struct rneagen_options *given, struct target *t)
{
	struct rneagen_options o = *given;
	struct arena a;
	struct text urdf;
	int limbs, links, has_hands, are_fists, is_fork;

	o.precision = s->precision;
	o.layout = s->layout;
	o.scene = *s->scene ? s->scene : NULL;
	are_fists = sscanf(s->name, "fists %d %d", &limbs, &links) == 2;
	has_hands = are_fists || sscanf(s->name, "hands %d %d", &limbs, &links) == 2;
	is_fork = sscanf(s->name, "fork %d %d", &limbs, &links) == 2;
	if (!has_hands && !is_fork && sscanf(s->name, "limbs %d %d", &limbs, &links) != 2) {
		launched_generate(t, s->name, s->scene, s->floating, &o);
		return;
	}
	arena_init(&a, NULL);
	text_init(&urdf, &a);
	text_put(&urdf, "<robot name='limbs'><link name='ground'/>\n");
	if (is_fork)
		put_fork(&urdf, limbs, links);
	else if (has_hands)
		put_hands(&urdf, limbs, links, are_fists);
	else
		for (int limb = 0; limb < limbs; limb++)
			put_limb(&urdf, limb, links, "ground", -1);
	text_put(&urdf, "</robot>\n");
	target_generate(t, text_string(&urdf), urdf.length, &o, s->name);
	arena_free(&a);
}

static void check(
	const struct subject *s, const struct target *t, enum rnea_backend backend, unsigned block, const struct launch *y)
{
	struct launch x = launched_run(launched_open(t, backend, block), COUNT, SEED, s->floating);
	double worst = launched_distance(&x, y, s->name);

	ck_assert_uint_eq(x.info->parts, (unsigned)s->parts);
	for (int i = 0; i < KERNELS; i++)
		ck_assert_uint_eq(x.info->functions->hands[i], s->hands[i]);
	printf("%s in %u parts, blocks of %u: within %.1e, seed %d\n", s->name, x.info->parts, block, worst, SEED);
	int grows = strstr(s->scene, "qdd") != NULL; /* by the condition of M */

	ck_assert_double_le(worst, !s->hands[0] ? 0 : s->precision == RNEAGEN_F32 ? (grows ? 1e-3 : 2e-5) : grows ? 1e-10 : 1e-13);
	launched_free(&x);
}

static int finds_first(const struct subject *s)
{
	return s->hands[0] && (strstr(s->scene, "vjp qdd") || strstr(s->scene, "jvp qdd"));
}

/* Forces on what stands. */
static int finds_forces(const struct subject *s)
{
	return s->hands[0] && (strstr(s->scene, "contact ") || strstr(s->scene, "weld "));
}

static int has_sides(const struct subject *s)
{
	return s->hands[0] && s->floating && strstr(s->scene, "want") && strstr(s->scene, "vjp");
}

static int finds_base(const struct subject *s)
{
	return s->hands[0] && strstr(s->scene, "want qdd") && !finds_forces(s);
}

/* In two kernels, one for each side: not of a robot with short limbs. */
static int has_felt(const struct subject *s)
{
	return s->floating && s->hands[1] == 1 && strcmp(s->name, "hyq") && (s->hands[2] == 2 || finds_base(s) || finds_forces(s));
}

/* Up to few samples beside several parts that share nothing, to more where the base's acceleration comes first and beside sides
   of a base; of what finds qdd first two kernels, for as many samples. */
static void expect_limbs(const struct subject *s, const char *source)
{
	const char *line = strstr(source, "\"whole_limbs ");
	unsigned most;

	ck_assert_int_eq(line != NULL, strstr(source, "_limbs(") != NULL);
	ck_assert(line || strcmp(s->name, "limbs 2 17"));
	if (!line)
		return;
	ck_assert_int_eq(sscanf(line, "\"whole_limbs %*u %*u %*u %u", &most), 1);
	if (finds_first(s) && !finds_forces(s)) {
		unsigned start;

		ck_assert_ptr_nonnull(line = strstr(source, "\"start_limbs "));
		ck_assert_int_eq(sscanf(line, "\"start_limbs %*u %*u %*u %u", &start), 1);
		ck_assert_uint_eq(start, most);
	} else if (finds_forces(s))
		ck_assert(most >= 128 && most <= (strstr(source, "\"start_limbs ") ? 8192 : 4096));
	else if (finds_base(s) || has_sides(s))
		ck_assert_uint_ge(most, s->layout == RNEAGEN_SOA ? 8192 : s->precision == RNEAGEN_F32 ? 1024 : 4096);
	else if (s->parts > 1 && !s->hands[0])
		ck_assert_uint_eq(most, 256);
}

/* The launch function runs the kernels of hands in their order, each with its blocks along y, and the own one after them. */
static void expect_launches(const struct subject *s, const char *source)
{
	const char *at = source;
	char launch[96];

	for (int level = 0; level < KERNELS && s->hands[level]; level++) {
		snprintf(launch, sizeof launch,
			level ? "_hands%d_kernel, dim3((unsigned)blocks, %u)" : "_hands%.0d_kernel, dim3((unsigned)blocks, %u)",
			level, s->hands[level]);
		at = strstr(at, launch);
		ck_assert_msg(at != NULL, "%s: %s", s->name, launch);
	}
	snprintf(launch, sizeof launch, "_%s_kernel, dim3((unsigned)blocks, %d)", strstr(s->scene, "qdd") ? "fd" : "rnea", s->parts);
	ck_assert(!s->hands[0] || strstr(at, launch));
	ck_assert_ptr_nonnull(strstr(source, finds_first(s) && strstr(source, "_start_limbs(") ? "\"rneagen-info 11\\n\""
					     : s->hands[1] ? "\"rneagen-info 7\\n\""
					     : s->hands[0] ? "\"rneagen-info 5\\n\""
							   : "\"rneagen-info 3\\n\""));
}

/* What the head of the text says of one of its kernels. */
static const char *says(const struct subject *s)
{
	if (finds_forces(s))
		return finds_first(s) ? "forces on what stands, and those of the weights" : "forces on what stands";
	if (finds_first(s))
		return strstr(s->scene, "jvp") ? "M^-1 of that" : "the rest, where both are found";
	if (finds_base(s))
		return "limbs, where those are found";
	if (s->parts > 1 || s->hands[0])
		return "limbs that share nothing with the others";
	return "the whole, where some of the motion is made again";
}

/* The text and its table say so; small batches have the kernel of the whole. */
static void expect_text(const struct subject *s, const char *source)
{
	char line[64];

	snprintf(line, sizeof line, "dim3((unsigned)blocks, %d)", s->parts);
	ck_assert_ptr_nonnull(strstr(source, line));
	snprintf(line, sizeof line, "gridDim.y != %d)", s->parts);
	ck_assert_ptr_nonnull(strstr(source, line));
	ck_assert_msg(strstr(source, says(s)) != NULL, "%s: says nothing of '%s'", s->name, says(s));
	ck_assert_int_eq(strstr(source, " = RNEA_READ_ANEW(") != NULL, strstr(s->scene, "vjp") != NULL && s->precision == RNEAGEN_F64 &&
		(strcmp(s->name, "atlas") || finds_first(s) || has_sides(s)));
	ck_assert_int_eq(strstr(source, " In rows of the output each but the last leaves what it makes:") != NULL,
		finds_first(s) || finds_forces(s) || (finds_base(s) && has_felt(s)));
	ck_assert_int_eq(strstr(source, "_hands_kernel: what the base feels of links ") != NULL, has_felt(s));
	ck_assert_int_eq(strstr(source, " * left in rows that ") != NULL, has_sides(s));
	ck_assert_int_eq(strstr(source, "_fd_kernel reads it from there and makes those ") != NULL, finds_base(s) && !has_felt(s));
	expect_launches(s, source);
	expect_limbs(s, source);
}

START_TEST(test_values)
{
	const struct subject *s = &APART[_i];
	struct rneagen_options o = rneagen_options_default(), plain = o;
	struct target parts, whole;
	struct launch one;

	if (s->is_long && !exhaustive())
		return;
	plain.parts = 1;
	plain.limbs = RNEAGEN_LIMBS_NONE;
	generate(s, &o, &parts);
	expect_text(s, parts.text.source);
	generate(s, &plain, &whole);
	one = launched_run(launched_open(&whole, RNEA_BACKEND_HOST, 0), COUNT, SEED, s->floating);
	if (finds_first(s)) /* by limbs, where there are some for so many samples */
		check(s, &parts, RNEA_BACKEND_CUDA, 0, &one);
	rneagen_result_free(&parts.text);
	o.limbs = RNEAGEN_LIMBS_NONE; /* some would take so few samples, and what no launch takes need not be compiled */
	generate(s, &o, &parts);
	check(s, &parts, RNEA_BACKEND_CUDA, _i % 2 ? LARGE_BLOCK : 0, &one);
	if (exhaustive() && s->layout == RNEAGEN_AOS && strstr(s->scene, "vjp"))
		check(s, &parts, RNEA_BACKEND_CUDA, _i % 2 ? 0 : LARGE_BLOCK, &one);
	if (_i % (exhaustive() ? 2 : 4) == 1)
		check(s, &parts, RNEA_BACKEND_HOST, 0, &one);
	launched_free(&one);
	rneagen_result_free(&parts.text);
	rneagen_result_free(&whole.text);
}
END_TEST

static void check_whole(const struct subject *s, const struct rneagen_options *o)
{
	struct target t;

	generate(s, o, &t);
	ck_assert_msg(!strstr(t.text.source, "_part0_body"), "%s %s", s->name, s->scene);
	ck_assert_ptr_null(strstr(t.text.source, "\"whole_limbs "));
	rneagen_result_free(&t.text);
}

START_TEST(test_whole)
{
	struct rneagen_options o = rneagen_options_default();

	if (!WHOLE[_i].is_long || exhaustive())
		check_whole(&WHOLE[_i], &o);
}
END_TEST

/* What is made again has the same bits. */
START_TEST(test_strict_again)
{
	const struct subject s = {"hyq", "want tau,vjp\n", RNEAGEN_F64, RNEAGEN_SOA, 1, 1, {0}, 0};
	struct rneagen_options o = rneagen_options_default(), plain;
	struct target parts, whole;
	struct launch x, y;

	o.strict = 1;
	plain = o;
	plain.parts = 1;
	generate(&s, &o, &parts);
	generate(&s, &plain, &whole);
	ck_assert_ptr_nonnull(strstr(parts.text.source, " = RNEA_READ_ANEW("));
	ck_assert_ptr_null(strstr(whole.text.source, "RNEA_READ_ANEW("));
	x = launched_run(launched_open(&parts, RNEA_BACKEND_CUDA, 0), COUNT, SEED, s.floating);
	y = launched_run(launched_open(&whole, RNEA_BACKEND_HOST, 0), COUNT, SEED, s.floating);
	ck_assert_uint_eq(x.info->parts, (unsigned)s.parts);
	ck_assert_double_eq(launched_distance(&x, &y, s.name), 0);
	launched_free(&x);
	launched_free(&y);
	rneagen_result_free(&parts.text);
	rneagen_result_free(&whole.text);
}
END_TEST

/* Transposed matrices with so few zeros that tables of what is kept take more room than the zeros: these are written like the
   rest. It would catch slices without room for a sample. */
START_TEST(test_few_zeros)
{
	const struct subject s = {"fork 28 6", "want M\ndense\n", RNEAGEN_F64, RNEAGEN_AOS, 0, 0, {0}, 0};
	struct rneagen_options o = rneagen_options_default();
	struct target t, c;
	struct launch x, y;

	generate(&s, &o, &t);
	ck_assert_ptr_nonnull(strstr(t.text.source, "\"transpose 4 "));
	o.target = RNEAGEN_TARGET_C;
	generate(&s, &o, &c);
	x = launched_run(launched_open(&t, RNEA_BACKEND_CUDA, 0), COUNT, SEED, 0);
	y = launched_run(launched_open(&c, RNEA_BACKEND_HOST, 0), COUNT, SEED, 0);
	ck_assert_double_lt(launched_distance(&x, &y, s.name), 1e-12);
	launched_free(&x);
	launched_free(&y);
	rneagen_result_free(&t.text);
	rneagen_result_free(&c.text);
}
END_TEST

/* Two kernels would have other bits, and parts that share the products of what all samples have. */
START_TEST(test_strict)
{
	const struct subject s = {"hands 5 3", "", RNEAGEN_F64, RNEAGEN_AOS, 0, 2, {0}, 0},
		shared = {"limbs 4 8", "want qdd\nfree gravity\n", RNEAGEN_F64, RNEAGEN_SOA, 0, 1, {0}, 0};
	struct rneagen_options o = rneagen_options_default();
	struct target t;

	o.strict = 1;
	check_whole(&shared, &o);
	generate(&s, &o, &t);
	ck_assert_ptr_null(strstr(t.text.source, "_hands_kernel"));
	rneagen_result_free(&t.text);
}
END_TEST

/* By --parts 1, by --segments, and without kernels. */
START_TEST(test_asked)
{
	struct rneagen_options whole = rneagen_options_default(), segments = whole, c = whole;

	whole.parts = 1;
	segments.segments = 1000;
	c.target = RNEAGEN_TARGET_C;
	check_whole(&APART[0], &whole);
	check_whole(&APART[0], &segments);
	check_whole(&APART[0], &c);
}
END_TEST

int main(void)
{
	Suite *s = suite_create("apart");

	launched_pretend();
	suite_add(s, "values", test_values, sizeof APART / sizeof *APART, 300);
	suite_add(s, "whole", test_whole, sizeof WHOLE / sizeof *WHOLE, 60);
	suite_add(s, "strict", test_strict, 1, 60);
	suite_add(s, "again", test_strict_again, 1, 120);
	suite_add(s, "few zeros", test_few_zeros, 1, 120);
	suite_add(s, "asked", test_asked, 1, 60);
	return suite_run(s);
}
