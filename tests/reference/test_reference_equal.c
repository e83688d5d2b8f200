// Mechanisms written in two ways must agree: planar and floating joints as chains, followers as constrained joints.
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "support/random_robot.h"
#include "reference/test_reference.h"

enum { SEEDS = 20, LINKS = 10, TEXT = 8192 };

#define INERTIAL \
	"<inertial><origin xyz='0.1 -0.2 0.3'/><mass value='2.5'/>" \
	"<inertia ixx='0.2' ixy='0.01' ixz='-0.02' iyy='0.25' iyz='0.03' izz='0.3'/></inertial>"
#define HEAD \
	"<robot name='p'><link name='a'/><link name='b'>" INERTIAL "</link><link name='c'>" INERTIAL "</link>" \
	"<link name='d'>" INERTIAL "</link><joint name='j0' type='continuous'><origin rpy='0.3 0.2 0.1'/>" \
	"<axis xyz='0 1 1'/><parent link='a'/><child link='b'/></joint>" \
	"<joint name='j9' type='continuous'><origin xyz='0.3 0.2 0.1'/>" \
	"<axis xyz='1 1 0'/><parent link='c'/><child link='d'/></joint>"

static const double plane_axes[][3] = {
	{0, 0, 1}, {0, 0, -1}, {0, 0, -3}, {1, 0, 0}, {0.3, -0.5, 0.7}, {1e-7, 2e-7, -1}, {-0.4, 0.2, -0.9}, {0, 1e-12, 5},
};

// e turned as z is turned onto n by the least angle, about k = z x n / |z x n|.
static void turn_with_axis(const double *n, int column, double *out)
{
	double size = sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]), s = hypot(n[0], n[1]) / size, c = n[2] / size;
	double k[3] = {s > 0 ? -n[1] / size / s : 1, s > 0 ? n[0] / size / s : 0, 0}, e[3] = {column == 0, column == 1, 0};
	double side[3] = {k[1] * e[2], -k[0] * e[2], k[0] * e[1] - k[1] * e[0]}, along = k[0] * e[0] + k[1] * e[1];

	for (int i = 0; i < 3; i++)
		out[i] = e[i] * c + side[i] * s + k[i] * along * (1 - c);
}

static struct reference *planar_robot(const double *n)
{
	char text[TEXT];

	snprintf(text, sizeof text, HEAD "<joint name='j1' type='planar'><origin xyz='0.5 0 1' rpy='1 2 3'/>"
	         "<axis xyz='%.17g %.17g %.17g'/><parent link='b'/><child link='c'/></joint></robot>", n[0], n[1], n[2]);
	return open_text(text, NULL);
}

static struct reference *chain_robot(const double *n)
{
	char text[TEXT];
	double x[3], y[3];

	turn_with_axis(n, 0, x);
	turn_with_axis(n, 1, y);
	snprintf(text, sizeof text, HEAD "<link name='e'/><link name='f'/>"
	         "<joint name='j1' type='prismatic'><origin xyz='0.5 0 1' rpy='1 2 3'/>"
	         "<axis xyz='%.17g %.17g %.17g'/><parent link='b'/><child link='e'/></joint>"
	         "<joint name='j2' type='prismatic'><axis xyz='%.17g %.17g %.17g'/><parent link='e'/><child link='f'/>"
	         "</joint><joint name='j3' type='continuous'><axis xyz='%.17g %.17g %.17g'/><parent link='f'/>"
	         "<child link='c'/></joint></robot>", x[0], x[1], x[2], y[0], y[1], y[2], n[0], n[1], n[2]);
	return open_text(text, NULL);
}

START_TEST(test_planar)
{
	struct reference *a = planar_robot(plane_axes[_i]), *b = chain_robot(plane_axes[_i]);
	struct rng rng = rng_seed(7);
	struct state s;
	wide tau[ROWS];

	sample_state(a, &rng, &s);
	ck_assert_int_eq(a->nq, 5);
	ck_assert_int_eq(b->nq, 5);
	reference_rnea(b, s.q, s.qd, s.qdd, tau);
	expect_near(s.tau, tau, 5, 1e-14, "planar");
	reference_close(a);
	reference_close(b);
}
END_TEST

// A random robot's text, and the same hung on six joints: along x, y, z, then about z, y, x.
static char *hang_on_chain(const char *urdf, const char *root)
{
	static const char *const axes[] = {"1 0 0", "0 1 0", "0 0 1", "0 0 1", "0 1 0", "1 0 0"};
	char *text = calloc(1, strlen(urdf) + TEXT), child[16], *end;

	strcpy(text, urdf);
	end = strstr(text, "</robot>");
	for (int i = 0; i < 6; i++) {
		snprintf(child, sizeof child, "chain%d", i + 1);
		end += sprintf(end, "<link name='chain%d'/><joint name='c%d' type='%s'><axis xyz='%s'/>"
		               "<parent link='chain%d'/><child link='%s'/></joint>", i, i,
		               i < 3 ? "prismatic" : "continuous", axes[i], i, i < 5 ? child : root);
	}
	strcpy(end, "</robot>");
	return text;
}

// qz(angles 0) qy(angles 1) qx(angles 2)
static void quaternion(const double *angles, double *q)
{
	double c0 = cos(angles[0] / 2), s0 = sin(angles[0] / 2), c1 = cos(angles[1] / 2), s1 = sin(angles[1] / 2);
	double c2 = cos(angles[2] / 2), s2 = sin(angles[2] / 2);

	q[0] = c0 * c1 * s2 - s0 * s1 * c2;
	q[1] = c0 * s1 * c2 + s0 * c1 * s2;
	q[2] = s0 * c1 * c2 - c0 * s1 * s2;
	q[3] = c0 * c1 * c2 + s0 * s1 * s2;
}

// The floating robot's state from that of the chain: its sixth body is the base. Passes hold a - R^T g.
static void floating_state(struct reference *chain, const struct state *s, struct state *out)
{
	wide v[ROWS][6], a[ROWS][6];
	double *q = out->q + 3;

	reference_passes(chain, s->q, s->qd, s->qdd, v, a, NULL);
	memcpy(out->q, s->q, 3 * sizeof *out->q);
	quaternion(s->q + 3, q);
	double row[3] = {2 * (q[0] * q[2] - q[1] * q[3]), 2 * (q[1] * q[2] + q[0] * q[3]),
	                 1 - 2 * (q[0] * q[0] + q[1] * q[1])};

	for (int i = 0; i < 6; i++) {
		out->qd[i] = (double)v[5][i];
		out->qdd[i] = (double)a[5][i] - (i < 3 ? 9.81 * row[i] : 0);
	}
	memcpy(out->q + 7, s->q + 6, (size_t)(chain->nq - 6) * sizeof *out->q);
	memcpy(out->qd + 6, s->qd + 6, (size_t)(chain->nv - 6) * sizeof *out->qd);
	memcpy(out->qdd + 6, s->qdd + 6, (size_t)(chain->nv - 6) * sizeof *out->qdd);
}

static void compare_bodies(struct reference *chain, const struct state *s, struct reference *base,
                           const struct state *b, const char *what)
{
	wide v[2][ROWS][6], a[2][ROWS][6], f[2][ROWS][6];

	ck_assert_int_eq(chain->nb, base->nb + 5);
	reference_passes(chain, s->q, s->qd, s->qdd, v[0], a[0], f[0]);
	reference_passes(base, b->q, b->qd, b->qdd, v[1], a[1], f[1]);
	for (int i = 0; i < base->nb; i++) {
		expect_near(v[1][i], v[0][i + 5], 6, 1e-13, what);
		expect_near(a[1][i], a[0][i + 5], 6, 1e-13, what);
		expect_near(f[1][i], f[0][i + 5], 6, 1e-13, what);
	}
}

START_TEST(test_floating_as_chain)
{
	uint64_t seed = 7000 + (uint64_t)_i;
	struct random_robot_knobs knobs = random_robot_knobs(seed, LINKS);
	struct reference_options floating = {.floating = true};
	struct rng rng = rng_seed(seed);
	char what[64], *urdf, *hung;
	struct state s, b;

	knobs.odd_names = 0;
	snprintf(what, sizeof what, "floating as chain, seed %llu", (unsigned long long)seed);
	urdf = random_robot(seed, &knobs);
	struct reference *base = open_text(urdf, &floating);

	hung = hang_on_chain(urdf, base->joints[0].link);
	struct reference *chain = open_text(hung, NULL);

	sample_state(chain, &rng, &s);
	floating_state(chain, &s, &b);
	reference_rnea(base, b.q, b.qd, b.qdd, b.tau);
	expect_near(b.tau + 6, s.tau + 6, base->nv - 6, 1e-13, what);
	expect_near(b.tau + 3, s.tau + 5, 1, 1e-13, what);
	compare_bodies(chain, &s, base, &b, what);
	reference_close(base);
	reference_close(chain);
	free(urdf);
	free(hung);
}
END_TEST

// A floating joint below a massless root is a floating base, also where the quaternion is not of unit length.
START_TEST(test_floating_joint)
{
	static const char joint[] = "<robot name='p'><link name='r'/><joint name='free' type='floating'><parent link='r'/>"
		"<child link='a'/></joint>";
	struct reference *base = open_text(HEAD "<joint name='j1' type='fixed'><parent link='b'/><child link='c'/></joint>"
	                                   "</robot>", &(struct reference_options){.floating = true});
	char text[TEXT];
	struct rng rng = rng_seed(8);
	struct state s;
	wide tau[ROWS];

	snprintf(text, sizeof text, "%s%s<joint name='j1' type='fixed'><parent link='b'/><child link='c'/></joint></robot>",
	         joint, &HEAD[strlen("<robot name='p'>")]);
	struct reference *inside = open_text(text, NULL);

	reference_sample(base, &rng, false, s.q, s.qd, s.qdd);
	for (int i = 3; i < 7; i++)
		s.q[i] *= _i ? 1.3 : 1;
	reference_rnea(base, s.q, s.qd, s.qdd, s.tau);
	reference_rnea(inside, s.q, s.qd, s.qdd, tau);
	ck_assert_int_eq(inside->nv, base->nv);
	expect_near(tau, s.tau, base->nv, 0, "floating joint");
	reference_close(base);
	reference_close(inside);
}
END_TEST

// With q = P x + offset, tau_x = P^T tau_q.
static void project(struct reference *follow, struct reference *all, const struct state *s, wide *tau)
{
	wide q[ROWS], qd[ROWS], qdd[ROWS], full[ROWS];

	for (int i = 0; i < all->nj; i++) {
		const struct reference_joint *j = &all->joints[i], *f = &follow->joints[i], *d = &follow->joints[f->driver];

		for (int k = 0; k < j->nq; k++)
			q[j->iq + k] = f->multiplier * s->wq[d->iq + k] + f->offset;
		for (int k = 0; k < j->nv; k++) {
			qd[j->iv + k] = f->multiplier * s->wqd[d->iv + k];
			qdd[j->iv + k] = f->multiplier * s->wqdd[d->iv + k];
		}
	}
	reference_rnea_wide(all, q, qd, qdd, full);
	memset(tau, 0, (size_t)follow->nv * sizeof *tau);
	for (int i = 0; i < all->nj; i++) {
		const struct reference_joint *f = &follow->joints[i], *d = &follow->joints[f->driver];

		for (int k = 0; k < all->joints[i].nv; k++)
			tau[d->iv + k] += f->multiplier * full[all->joints[i].iv + k];
	}
}

START_TEST(test_mimic)
{
	uint64_t seed = 8000 + (uint64_t)_i;
	struct random_robot_knobs knobs = random_robot_knobs(seed, LINKS);
	struct rng rng = rng_seed(seed);
	struct state s;
	wide tau[ROWS];
	char *urdf, what[64];

	snprintf(what, sizeof what, "mimic, seed %llu", (unsigned long long)seed);
	knobs.mimic = 0.6;
	urdf = random_robot(seed, &knobs);
	struct reference *follow = open_text(urdf, NULL);
	struct reference *all = open_text(urdf, &(struct reference_options){.independent = true});

	sample_state(follow, &rng, &s);
	project(follow, all, &s, tau);
	expect_near(s.tau, tau, follow->nv, 1e-17, what);
	reference_close(follow);
	reference_close(all);
	free(urdf);
}
END_TEST

TCase *equivalences(void)
{
	TCase *t = tcase_create("equivalences");

	printf("seeds: floating as chain 7000, mimic 8000, %d of each\n", SEEDS);
	tcase_add_loop_test(t, test_planar, 0, (int)(sizeof plane_axes / sizeof *plane_axes));
	tcase_add_loop_test(t, test_floating_as_chain, 0, SEEDS);
	tcase_add_loop_test(t, test_floating_joint, 0, 2);
	tcase_add_loop_test(t, test_mimic, 0, SEEDS);
	return t;
}
