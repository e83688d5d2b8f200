/* Sums of inertias: the parallel axis theorem against masses added one by one, and what is taken for zero. */
#include "support/plain.h"
#include "support/rng.h"
#include "support/suite.h"
#include <math.h>

enum { LINKS = 3, POINTS = 6, ROBOTS = 300 };

struct point {
	double mass, at[3]; /* in the link's frame */
};

/* A link of point masses as a URDF states it: mass, centre, and inertia about the centre in axes turned by rpy. */
struct cloud {
	struct point points[POINTS];
	double mass, com[3], rpy[3], inertia[6];
	struct placement X;
};

static void cloud_inertia(struct cloud *c, const real com[3])
{
	struct rotation R = exact_rpy(c->rpy), T = rotation_transpose(&R);
	real I[6] = {0};

	for (int n = 0; n < POINTS; n++) {
		real r[3];

		for (int i = 0; i < 3; i++)
			r[i] = (real)c->points[n].at[i] - com[i];
		turned(&T, r, r);
		for (int i = 0; i < 3; i++)
			for (int j = i; j < 3; j++)
				I[inertia_index(i, j)] += (real)c->points[n].mass *
					((i == j ? r[0] * r[0] + r[1] * r[1] + r[2] * r[2] : 0) - r[i] * r[j]);
	}
	for (int i = 0; i < 6; i++)
		c->inertia[i] = (double)I[i];
}

static struct cloud cloud_new(struct rng *rng)
{
	double rpy[3] = {rng_uniform(rng, -4, 4), rng_uniform(rng, -4, 4), rng_uniform(rng, -4, 4)};
	struct cloud c = {.X = {.R = exact_rpy(rpy)}};
	real mass = 0, com[3] = {0};

	for (int i = 0; i < 3; i++) {
		c.X.p[i] = within_exact((real)rng_uniform(rng, -1, 1));
		c.rpy[i] = rng_chance(rng, 0.5) ? 0 : rng_uniform(rng, -4, 4);
	}
	for (int n = 0; n < POINTS; n++) {
		c.points[n].mass = rng_uniform(rng, 0.1, 2);
		mass += c.points[n].mass;
		for (int i = 0; i < 3; i++) {
			c.points[n].at[i] = rng_uniform(rng, -0.5, 0.5);
			com[i] += (real)c.points[n].mass * c.points[n].at[i];
		}
	}
	for (int i = 0; i < 3; i++)
		c.com[i] = (double)(com[i] /= mass);
	c.mass = (double)mass;
	cloud_inertia(&c, com);
	return c;
}

/* What inertia_add takes, as exact numbers. */
static void add(struct inertia_sum *s, const struct placement *X, double mass, const double com[3], const double rpy[3],
	const double inertia[6])
{
	struct within c[3], angles[3], I[6];

	exact_doubles(c, com, 3);
	exact_doubles(angles, rpy, 3);
	exact_doubles(I, inertia, 6);
	inertia_add(s, X, within_exact((real)mass), c, angles, I);
}

struct plain_inertia {
	real mass, h[3], I[6];
};

static struct plain_inertia total(const struct inertia_sum *s)
{
	struct inertia t = inertia_total(s);
	struct plain_inertia p = {.mass = t.mass.x};

	plain(p.h, t.h, 3);
	plain(p.I, t.I, 6);
	return p;
}

static void brute_force(struct plain_inertia *t, const struct cloud *c)
{
	for (int n = 0; n < POINTS; n++) {
		const struct point *p = &c->points[n];
		real m = p->mass, r[3] = {p->at[0], p->at[1], p->at[2]};

		turned(&c->X.R, r, r);
		for (int i = 0; i < 3; i++)
			r[i] += c->X.p[i].x;
		t->mass += m;
		for (int i = 0; i < 3; i++) {
			t->h[i] += m * r[i];
			for (int j = i; j < 3; j++)
				t->I[inertia_index(i, j)] +=
					m * ((i == j ? r[0] * r[0] + r[1] * r[1] + r[2] * r[2] : 0) - r[i] * r[j]);
		}
	}
}

START_TEST(point_masses)
{
	for (uint64_t seed = 1; seed <= ROBOTS; seed++) {
		struct rng rng = rng_seed(seed);
		struct inertia_sum sum = {0};
		struct plain_inertia want = {0}, got;

		for (int n = 0; n < LINKS; n++) {
			struct cloud c = cloud_new(&rng);

			add(&sum, &c.X, c.mass, c.com, c.rpy, c.inertia);
			brute_force(&want, &c);
		}
		got = total(&sum);
		ck_assert(fabsl(got.mass - want.mass) < 1e-14L);
		for (int i = 0; i < 3; i++)
			ck_assert_msg(fabsl(got.h[i] - want.h[i]) < 1e-14L, "seed %d: h[%d]", (int)seed, i);
		for (int i = 0; i < 6; i++)
			ck_assert_msg(fabsl(got.I[i] - want.I[i]) < 4e-14L, "seed %d: I[%d]: %Lg, not %Lg",
				(int)seed, i, got.I[i], want.I[i]);
	}
}
END_TEST

START_TEST(index_is_symmetric)
{
	static const char names[6][2] = {"xx", "xy", "xz", "yy", "yz", "zz"};

	for (int i = 0; i < 3; i++)
		for (int j = i; j < 3; j++) {
			int e = inertia_index(i, j);

			ck_assert_int_eq(e, inertia_index(j, i));
			ck_assert(names[e][0] == "xyz"[i] && names[e][1] == "xyz"[j]);
		}
}
END_TEST

/* ---- zero ---- */

static real sum_of(const double *terms, int count)
{
	struct sum s = {0};

	for (int i = 0; i < count; i++)
		sum_add(&s, within_exact((real)terms[i]));
	return sum_total(s).x;
}

/* Terms, and whether they leave nothing but the rounding of their doubles. */
static const struct terms {
	double terms[4];
	int zero;
} terms[] = {
	{{0}, 1}, {{1, -1}, 1}, {{0.1, 0.2, -0.3}, 1}, {{1e-31}, 0}, {{1e-31, 2e-31}, 0}, {{1e-31, -1e-31}, 1}, {{1e-300}, 0},
	{{4.9e-324}, 0}, {{1e31, -1e31}, 1}, {{1, -1, 1e-31}, 1}, {{1e-31, 1e-31, -2.0001e-31}, 0}, {{1, 0x1p-51, -1}, 1},
	{{1, 0x1p-49, -1}, 0}, {{0.1, 0.2, -0.3000000000001}, 0}, {{1, 0x1p-60}, 0}, {{-3, 1, 1, 1}, 1},
};

START_TEST(zero_is_relative)
{
	const struct terms *t = &terms[_i];
	real sum = sum_of(t->terms, 4);

	ck_assert_msg((sum == 0) == t->zero, "row %d: %Lg", _i, sum);
}
END_TEST

START_TEST(tiny_inertias_survive)
{
	static const double turned[3] = {1.5707963267948966, 0, 0}, straight[3] = {0, 0, 0};
	static const double tiny[6] = {1e-31, 2e-32, 3e-32, 4e-31, -5e-32, 6e-31};
	const struct placement X = {.R = ROTATION_IDENTITY};
	struct inertia_sum sum = {0};
	struct plain_inertia t;

	add(&sum, &X, 1e-25, (double[3]){1e-10, 0, 0}, straight, tiny);
	t = total(&sum);
	ck_assert(t.mass == 1e-25 && fabsl(t.h[0] - 1e-35L) < 1e-50L && t.h[1] == 0 && t.h[2] == 0);
	for (int i = 0; i < 6; i++)
		ck_assert(fabsl(t.I[i] - tiny[i]) < 1e-44L);
	/* y and z change places under a quarter turn about x: xx -> xx, xy -> -xz ... */
	sum = (struct inertia_sum){0};
	add(&sum, &X, 0, straight, turned, tiny);
	t = total(&sum);
	ck_assert(t.I[0] == tiny[0] && t.I[1] == -tiny[2] && t.I[2] == tiny[1]);
	ck_assert(t.I[3] == tiny[5] && t.I[4] == -tiny[4] && t.I[5] == tiny[3]);
}
END_TEST

/* Beside a large inertia a small one is kept as far as long double holds it, unless it came from cancelling. */
START_TEST(cancelled_moments_are_zero)
{
	static const double none[6] = {0}, straight[3] = {0, 0, 0};
	const struct placement X = {.R = ROTATION_IDENTITY},
			       far = {.R = ROTATION_IDENTITY, .p = {within_exact(0.1L), within_exact(0.2L)}};
	struct inertia_sum sum = {0};
	struct plain_inertia t;

	add(&sum, &X, 3, (double[3]){0.1, 0.2, 0.3}, straight, none);
	add(&sum, &X, 1, (double[3]){-0.3, -0.6, 0.3}, straight, none);
	t = total(&sum);
	ck_assert(t.h[0] == 0 && t.h[1] == 0 && fabsl(t.h[2] - 1.2L) < 1e-15L);
	sum = (struct inertia_sum){0};
	add(&sum, &far, 2, (double[3]){-0.1, -0.2, 0}, straight, none);
	t = total(&sum);
	ck_assert(t.mass == 2);
	for (int i = 0; i < 3; i++)
		ck_assert(t.h[i] == 0);
	for (int i = 0; i < 6; i++)
		ck_assert(t.I[i] == 0);
}
END_TEST

int main(void)
{
	Suite *suite = suite_create("inertia");
	TCase *c = tcase_create("inertia");

	tcase_add_test(c, point_masses);
	tcase_add_test(c, index_is_symmetric);
	tcase_add_loop_test(c, zero_is_relative, 0, sizeof terms / sizeof *terms);
	tcase_add_test(c, tiny_inertias_survive);
	tcase_add_test(c, cancelled_moments_are_zero);
	suite_add_tcase(suite, c);
	return suite_run(suite);
}
