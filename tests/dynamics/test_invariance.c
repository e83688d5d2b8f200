/* What must change nothing, or only what it says: links split by fixed joints, the order of rows, followers written out.
   On random trees, seeds printed. */
#include "support/plain.h"
#include "support/suite.h"
#include "support/torque.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { ROBOTS = 120, LINKS = 16 };

/* Of doubles in the constants, and of the zeros taken for it, by the magnitudes that were summed. */
#define NOISE 1e-14L

static struct model model;
static struct pose pose;
static struct rneagen_options options;
static char *urdf;

static void set_up(uint64_t seed, int flags, enum rneagen_mimic mimic, const char *scene)
{
	struct rng rng = rng_seed(seed + 2000);
	char what[64];

	options = rneagen_options_default();
	options.base = seed % 3 ? RNEAGEN_FIXED : RNEAGEN_FLOATING;
	options.mimic = mimic;
	options.scene = scene ? scene : "params urdf\n";
	options.gravity[0] = 1.5;
	urdf = torque_robot(seed, LINKS, flags);
	snprintf(what, sizeof what, "random robot, seed %llu", (unsigned long long)seed);
	model_open(&model, urdf, strlen(urdf), &options, what);
	pose_random(&pose, model.reference, &rng);
}

static void tear_down(void)
{
	model_close(&model);
	free(urdf);
}

static void check_near(real got, real want, real tolerance, uint64_t seed, int row, const char *what)
{
	ck_assert_msg(fabsl(got - want) <= tolerance, "%s: seed %llu, row %d: %.20Lg, not %.20Lg (tolerance %Lg)", what,
		(unsigned long long)seed, row, got, want, tolerance);
}

/* ---- fixed joints ---- */

/* The inertial of link `from` as one of link `to`, whose frame is that of a fixed joint in `from`. */
static void move_inertial(struct link *to, struct link *from, const struct joint *j)
{
	struct rotation R = rotation_rpy(j->rpy), T = rotation_transpose(&R), C = rotation_rpy(from->com_rpy), A;
	real c[3];

	A = rotation_mul(&T, &C);
	for (int i = 0; i < 3; i++)
		c[i] = from->com[i].x - j->xyz[i].x;
	turned(&T, c, c);
	to->has_inertial = 1;
	to->mass = from->mass;
	for (int i = 0; i < 3; i++) {
		to->com[i] = within_exact((real)(double)c[i]);
		for (int k = i; k < 3; k++) {
			real sum = 0;

			for (int n = 0; n < 9; n++)
				sum += A.m[i][n / 3].x * A.m[k][n % 3].x * from->inertia[inertia_index(n / 3, n % 3)].x;
			to->inertia[inertia_index(i, k)] = within_exact((real)(double)sum);
		}
	}
	from->has_inertial = 0;
}

/* Every inertial moves to a link of its own behind a fixed joint, by a random placement. */
static struct robot split(const struct robot *r, struct arena *a, struct rng *rng)
{
	struct robot s = *r;

	s.links = arena_alloc(a, 2 * (size_t)r->link_count, sizeof *s.links);
	s.joints = arena_alloc(a, (size_t)(r->joint_count + r->link_count), sizeof *s.joints);
	memcpy(s.links, r->links, (size_t)r->link_count * sizeof *s.links);
	if (r->joint_count)
		memcpy(s.joints, r->joints, (size_t)r->joint_count * sizeof *s.joints);
	for (int i = 0; i < r->link_count; i++) {
		struct joint *j = &s.joints[s.joint_count];

		if (!r->links[i].has_inertial)
			continue;
		*j = (struct joint){.name = "fixed", .type = JOINT_FIXED, .parent = i, .child = s.link_count, .driver = -1};
		for (int k = 0; k < 3; k++) {
			j->xyz[k] = within_exact((real)rng_uniform(rng, -0.3, 0.3));
			j->rpy[k] = within_exact((real)(rng_chance(rng, 0.5) ? rng_uniform(rng, -3, 3)
				: 1.5707963267948966 * rng_below(rng, 3)));
		}
		s.links[s.link_count] = (struct link){.name = "part", .parent_joint = s.joint_count};
		move_inertial(&s.links[s.link_count++], &s.links[i], j);
		s.joint_count++;
	}
	return s;
}

START_TEST(split_links)
{
	for (uint64_t seed = 1; seed <= ROBOTS; seed++) {
		struct rng rng = rng_seed(seed);
		struct torque whole, parts;
		struct robot s;
		struct tree t;
		struct dag d;

		set_up(seed, 0, RNEAGEN_MIMIC_HONOUR, NULL);
		s = split(&model.robot, &model.arena, &rng);
		ck_assert(torque_dag(&d, &t, &s, &options, &model.arena));
		ck_assert_int_eq(t.body_count, model.tree.body_count);
		torque_of(&model.dag[ALGORITHM_rnea], &pose, &whole);
		torque_of(&d, &pose, &parts);
		for (int i = 0; i < pose.nv; i++)
			check_near(parts.tau[i], whole.tau[i], NOISE * (real)fmax(whole.size[i], parts.size[i]),
				seed, i, "split");
		tear_down();
	}
}
END_TEST

/* ---- rows and followers ---- */

/* A random permutation of the names of all joints with entries in q; the base stays. */
static char *shuffled_order(const struct tree *t, struct arena *a, struct rng *rng)
{
	int count = t->joint_count - t->floating, order[ROWS];
	struct text s;

	text_init(&s, a);
	for (int i = 0; i < count; i++) {
		int j = rng_below(rng, i + 1);

		order[i] = order[j];
		order[j] = i;
	}
	for (int i = 0; i < count; i++)
		text_printf(&s, "%s%s", i ? "," : "", t->joints[t->floating + order[i]].name);
	return s.s;
}

static const struct tree_joint *joint_named(const struct tree *t, const char *name)
{
	for (int i = 0; i < t->joint_count; i++)
		if (!strcmp(t->joints[i].name, name))
			return &t->joints[i];
	ck_abort_msg("no joint %s", name);
	return NULL;
}

/* The state of one tree for another that has all of its joints. */
static void move_pose(struct pose *to, const struct tree *t, const struct tree *of)
{
	for (int i = 0; i < of->joint_count; i++) {
		const struct tree_joint *a = &of->joints[i], *b = joint_named(t, a->name);

		memcpy(to->q + b->iq, pose.q + a->iq, (size_t)a->nq * sizeof *to->q);
		memcpy(to->qd + b->iv, pose.qd + a->iv, (size_t)a->nv * sizeof *to->qd);
		memcpy(to->qdd + b->iv, pose.qdd + a->iv, (size_t)a->nv * sizeof *to->qdd);
	}
}

/* Another order of rows: the same bits in other places, also by base parameters, which are searched for: would catch a search
   whose states go by rows. */
START_TEST(order_of_rows)
{
	int tried = 0, robots = _i ? ROBOTS / 8 : ROBOTS;

	for (uint64_t seed = 1; seed <= (uint64_t)robots; seed++) {
		struct rng rng = rng_seed(seed);
		struct torque before, after;
		struct pose p = {0};
		struct tree t;
		struct dag d;

		set_up(seed, NO_ODD_NAMES, RNEAGEN_MIMIC_HONOUR, _i ? "params base\n" : NULL);
		options.order = shuffled_order(&model.tree, &model.arena, &rng);
		tried += options.order && strchr(options.order, ',');
		ck_assert(torque_dag(&d, &t, &model.robot, &options, &model.arena));
		move_pose(&p, &t, &model.tree);
		torque_of(&model.dag[ALGORITHM_rnea], &pose, &before);
		torque_of(&d, &p, &after);
		for (int i = 0; i < t.joint_count; i++)
			for (int k = 0; k < t.joints[i].nv; k++) {
				real was = before.tau[joint_named(&model.tree, t.joints[i].name)->iv + k];

				check_near(after.tau[t.joints[i].iv + k], was, 0, seed, t.joints[i].iv + k, "order");
			}
		tear_down();
	}
	ck_assert_int_gt(tried, robots / 2);
}
END_TEST

/* The torques of a joint and of all its followers, by their multipliers, and the magnitudes summed. */
static real gathered(const struct tree *t, const struct tree_joint *own, int row, const struct torque *all, real *size)
{
	int iv = joint_named(t, own->name)->iv + row;
	real sum = all->tau[iv];

	*size = (real)all->size[iv];
	for (int i = 0; i < model.tree.mimic_count; i++) {
		const struct tree_mimic *m = &model.tree.mimics[i];

		if (strcmp(m->driver, own->name))
			continue;
		iv = joint_named(t, m->name)->iv;
		sum += m->multiplier.x * all->tau[iv];
		*size += fabsl(m->multiplier.x) * (real)all->size[iv];
	}
	return sum;
}

/* q_independent = G q + offset */
static void move_followers(struct pose *to, const struct tree *t)
{
	for (int i = 0; i < model.tree.mimic_count; i++) {
		const struct tree_mimic *m = &model.tree.mimics[i];
		const struct tree_joint *from = joint_named(&model.tree, m->driver), *follower = joint_named(t, m->name);

		to->q[follower->iq] = m->multiplier.x * pose.q[from->iq] + m->offset.x;
		to->qd[follower->iv] = m->multiplier.x * pose.qd[from->iv];
		to->qdd[follower->iv] = m->multiplier.x * pose.qdd[from->iv];
	}
}

/* tau = G^T tau_independent (G q + offset, G qd, G qdd) */
START_TEST(followers_written_out)
{
	int followers = 0;

	for (uint64_t seed = 1; seed <= ROBOTS; seed++) {
		struct torque honoured, all;
		struct pose p = {0};
		struct tree t;
		struct dag d;

		set_up(seed, ALWAYS_MIMIC, RNEAGEN_MIMIC_HONOUR, NULL);
		options.mimic = RNEAGEN_MIMIC_INDEPENDENT;
		ck_assert(torque_dag(&d, &t, &model.robot, &options, &model.arena));
		move_pose(&p, &t, &model.tree);
		move_followers(&p, &t);
		torque_of(&model.dag[ALGORITHM_rnea], &pose, &honoured);
		torque_of(&d, &p, &all);
		for (int i = 0; i < model.tree.joint_count; i++) {
			const struct tree_joint *own = &model.tree.joints[i];

			for (int k = 0; k < own->nv; k++) {
				real size, sum = gathered(&t, own, k, &all, &size);

				check_near(honoured.tau[own->iv + k], sum, NOISE * size, seed, own->iv + k, "followers");
			}
		}
		followers += model.tree.mimic_count;
		tear_down();
	}
	ck_assert_int_gt(followers, ROBOTS);
	printf("random trees, seeds 1 to %d: %d followers written out\n", ROBOTS, followers);
}
END_TEST

int main(void)
{
	Suite *suite = suite_create("invariance");
	TCase *c = tcase_create("trees");

	setvbuf(stdout, NULL, _IOLBF, 0);
	tcase_set_timeout(c, 120);
	tcase_add_test(c, split_links);
	tcase_add_loop_test(c, order_of_rows, 0, 2);
	tcase_add_test(c, followers_written_out);
	suite_add_tcase(suite, c);
	return suite_run(suite);
}
