/* The two halves of the algorithm: the way out against the reference's passes, and both together against the whole. */
#include "support/exhaustive.h"
#include "support/random_robot.h"
#include "support/model.h"
#include "support/suite.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { LINKS = 20, ROWS = 1024 };
#define ROBOTS (exhaustive() ? 150ull : 40ull) /* random trees */

#define LIMIT_TERMS 4 /* eps of the magnitudes that were summed */
#define FLOOR 0.01

/* One state, what fpass makes of it in double and what the reference does, [nb][6] each; torques both ways. */
struct passes {
	double q[ROWS], qd[ROWS], qdd[ROWS], v[ROWS], a[ROWS], f[ROWS], halves[ROWS], whole[ROWS];
	double size[3 * ROWS], whole_size[ROWS];
	wide reference[3][ROWS / 6][6];
};

static struct passes p;

static void run_passes(const struct model *m)
{
	const double *in[] = {p.q, p.qd, p.qdd, NULL, NULL, NULL}, *back[] = {p.q, p.f, NULL};

	ck_assert(m->tree.body_count * 6 <= ROWS && m->tree.nq <= ROWS);
	ck_assert(eval_f64(&m->dag[ALGORITHM_fpass], in, (double *[]){NULL, NULL, NULL, p.v, p.a, p.f},
		&(struct eval_terms){.size = p.size}));
	ck_assert(eval_f64(&m->dag[ALGORITHM_bpass], back, (double *[]){NULL, NULL, p.halves}, NULL));
	ck_assert(eval_f64(&m->dag[ALGORITHM_rnea], in, (double *[]){NULL, NULL, NULL, p.whole},
		&(struct eval_terms){.size = p.whole_size}));
}

/* By the magnitudes summed for all three components: one can be a zero that stands for the noise of the file's numbers.
   All three can; hence FLOOR. */
static double check_out(const struct model *m, const char *what)
{
	static const char *const names[] = {"v", "a", "f"};
	const double *got[] = {p.v, p.a, p.f};
	const struct dag *d = &m->dag[ALGORITHM_fpass];
	double worst = 0;

	ck_assert_uint_eq(d->output_count, 18 * (size_t)m->tree.body_count);
	for (size_t i = 0; i < d->output_count; i += 3) {
		int which = d->outputs[i].argument - 3, row = d->outputs[i].row;
		double size = FLOOR + p.size[i] + p.size[i + 1] + p.size[i + 2];

		for (int k = 0; k < 3; k++) {
			wide want = p.reference[which][(row + k) / 6][(row + k) % 6];
			double off = (double)fabsl((wide)got[which][row + k] - want) / 0x1p-52;

			ck_assert_int_eq(d->outputs[i + (size_t)k].row, row + k);
			ck_assert_msg(off <= LIMIT_TERMS * size, "%s: %s[%d]: %.17g, not %.17Lg", what, names[which], row + k,
				got[which][row + k], (long double)want);
			worst = fmax(worst, off / size);
		}
	}
	return worst;
}

static double check_together(const struct model *m, const char *what)
{
	double size[ROWS] = {0}, worst = 0;

	for (size_t i = 0; i < m->dag[ALGORITHM_rnea].output_count; i++)
		size[m->dag[ALGORITHM_rnea].outputs[i].row] = p.whole_size[i];
	for (int i = 0; i < m->tree.nv; i++) {
		double off = fabs(p.whole[i] - p.halves[i]) / 0x1p-52;

		ck_assert_msg(off <= LIMIT_TERMS * size[i], "%s: tau[%d]: %.17g whole, %.17g in halves", what, i,
			p.whole[i], p.halves[i]);
		worst = size[i] > 0 && off / size[i] > worst ? off / size[i] : worst;
	}
	return worst;
}

struct worst {
	double out, together;
	int count;
};

static void check_robot(const char *text, size_t length, const struct rneagen_options *o, const char *what, uint64_t seed,
	struct worst *w)
{
	struct rng rng = rng_seed(seed);
	struct model m;

	model_open(&m, text, length, o, what);
	reference_sample(m.reference, &rng, false, p.q, p.qd, p.qdd);
	reference_passes(m.reference, p.q, p.qd, p.qdd, p.reference[0], p.reference[1], p.reference[2]);
	run_passes(&m);
	w->out = fmax(w->out, check_out(&m, what));
	w->together = fmax(w->together, check_together(&m, what));
	w->count++;
	model_close(&m);
}

START_TEST(random_trees)
{
	struct worst w = {0};

	for (uint64_t seed = 1; seed <= ROBOTS; seed++) {
		struct random_robot_knobs knobs = random_robot_knobs(seed, LINKS);
		struct rneagen_options o = rneagen_options_default();
		char *text = random_robot(seed, &knobs), what[64];

		o.base = seed % 3 ? RNEAGEN_FIXED : RNEAGEN_FLOATING;
		o.mimic = seed % 5 ? RNEAGEN_MIMIC_HONOUR : RNEAGEN_MIMIC_INDEPENDENT;
		o.gravity[1] = seed % 2 ? 0 : -2;
		snprintf(what, sizeof what, "random robot, seed %llu", (unsigned long long)seed);
		check_robot(text, strlen(text), &o, what, seed, &w);
		free(text);
	}
	printf("%d random trees, seeds 1 to %llu: fpass within %.2f eps of the magnitudes summed, fpass and bpass within %.2f of rnea\n",
		w.count, ROBOTS, w.out, w.together);
}
END_TEST

static void own_robot(const char *path, const char *name, void *context)
{
	struct rneagen_options o = rneagen_options_default();
	size_t length;
	char *text = read_file(path, &length);

	for (int i = 0; i < 2; i++) {
		o.base = i ? RNEAGEN_FLOATING : RNEAGEN_FIXED;
		check_robot(text, length, &o, name, 1 + (uint64_t)i, context);
	}
	free(text);
}

START_TEST(own_robots)
{
	struct worst w = {0};

	for_each_urdf(TEST_DIR "/robots", own_robot, &w);
	ck_assert_int_ge(w.count, 2 * 28);
	printf("%d models of own robots: fpass within %.2f eps of the magnitudes summed, fpass and bpass within %.2f of rnea\n",
		w.count, w.out, w.together);
}
END_TEST

int main(void)
{
	Suite *suite = suite_create("passes");
	TCase *c = tcase_create("passes");

	setvbuf(stdout, NULL, _IOLBF, 0);
	tcase_set_timeout(c, 120);
	tcase_add_test(c, random_trees);
	tcase_add_test(c, own_robots);
	suite_add_tcase(suite, c);
	return suite_run(suite);
}
