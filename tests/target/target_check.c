#include "target/target_check.h"
#include "target/rerun.h"
#include <check.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* What a text may be off: relative, for real robots; in eps of the magnitudes that were summed, for all. */
static const double LIMITS[] = {5e-14, 3e-6};
enum { LIMIT_TERMS = 6, PASS_STATES = 100 };
static const double PAIR_EPS = 0x1p-46; /* of an operation of two-float arithmetic; memory is f64 */

static size_t at(int k, int rows)
{
	return (size_t)k * (size_t)rows;
}

/* Does the text compute with pairs of floats? */
static int is_pair(const struct check *c)
{
	return c->target->options.precision == RNEAGEN_F32X2;
}

static double limit_of(const struct check *c)
{
	return is_pair(c) ? 1e-12 : LIMITS[c->target->f32];
}

static double eps(const struct check *c)
{
	return is_pair(c) ? PAIR_EPS : c->target->f32 ? 0x1p-23 : 0x1p-52;
}

/* How far a torque may be from what eval gives. */
static double bound_of(const struct check *c, size_t i)
{
	return 3 * c->states->bound[i] * (is_pair(c) ? PAIR_EPS / 0x1p-53 : 1);
}

static struct array array_of(const struct check *c, const double *x, int count)
{
	struct array a = array_new(c->target->f32, (size_t)count);

	for (int i = 0; x && i < count; i++)
		array_set(&a, (size_t)i, x[i]);
	return a;
}

static void keep_worst(double *worst, char *of, double error, const char *what)
{
	if (error > *worst) {
		*worst = error;
		memcpy(of, what, sizeof((struct target *)0)->what);
	}
}

/* One state in, one torque out. */
struct slot {
	struct array q, qd, qdd, tau;
};

static struct slot slot_new(const struct check *c, int k)
{
	const struct states *s = c->states;

	return (struct slot){array_of(c, s->q + at(k, s->nq), s->nq), array_of(c, s->qd + at(k, s->nv), s->nv),
		array_of(c, s->qdd + at(k, s->nv), s->nv), array_of(c, NULL, s->nv)};
}

static void slot_free(struct slot *x)
{
	array_free(&x->q);
	array_free(&x->qd);
	array_free(&x->qdd);
	array_free(&x->tau);
}

static void set_slot(struct slot *x, const struct states *s, int k)
{
	for (int i = 0; i < s->nq; i++)
		array_set(&x->q, (size_t)i, s->q[at(k, s->nq) + (size_t)i]);
	for (int i = 0; i < s->nv; i++) {
		array_set(&x->qd, (size_t)i, s->qd[at(k, s->nv) + (size_t)i]);
		array_set(&x->qdd, (size_t)i, s->qdd[at(k, s->nv) + (size_t)i]);
		array_set(&x->tau, (size_t)i, NAN);
	}
}

static void judge(const struct check *c, int k, const double *tau)
{
	const struct states *s = c->states;
	size_t first = at(k, s->nv);
	double error = reference_error(tau, s->tau + first, s->nv);

	ck_assert_msg(!c->real || error <= limit_of(c), "%s: state %d: relative error %g", c->target->what,
		k, error);
	keep_worst(&c->worst->norm, c->worst->norm_of, error, c->target->what);
	for (size_t i = first; i < first + (size_t)s->nv; i++) {
		double off = (double)fabsl((long double)tau[i - first] - s->tau[i]),
		       eval = fabs(tau[i - first] - s->eval[i]);
		double limit = LIMIT_TERMS * eps(c) * s->size[i];

		ck_assert_msg(c->real || off - s->noise[i] <= limit, "%s: state %d: torque %zu is off by %g, limit %g",
			c->target->what, k, i - first, off, limit);
		ck_assert_msg(eval <= bound_of(c, i),
			"%s: state %d: torque %zu is %g from eval's, limit %g", c->target->what, k,
			i - first, eval, bound_of(c, i));
		if (off > s->noise[i])
			c->worst->terms = fmax(c->worst->terms, (off - s->noise[i]) / (eps(c) * s->size[i]));
	}
}

static void judge_bits(const struct check *c, int k, const double *tau, double *again)
{
	const struct states *s = c->states;
	const double *in[] = {s->q + at(k, s->nq), s->qd + at(k, s->nv), s->qdd + at(k, s->nv), NULL};
	double *out[] = {NULL, NULL, NULL, again};

	rerun(&c->model->dag[ALGORITHM_rnea], c->target, c->fused, in, out);
	for (int i = 0; i < s->nv; i++)
		ck_assert_msg(same_number(tau[i], again[i]), "%s: state %d: torque %d is %a, its DAG gives %a",
			c->target->what, k, i, tau[i], again[i]);
}

void check_rnea(const struct check *c)
{
	int nv = c->states->nv;
	double *tau = calloc(at(2, nv), sizeof *tau);
	struct slot x = slot_new(c, 0);

	for (int k = 0; k < c->states->count; k++) {
		set_slot(&x, c->states, k);
		target_rnea(c->target, &x.q, &x.qd, &x.qdd, &x.tau);
		for (int i = 0; i < nv; i++)
			tau[i] = array_get(&x.tau, (size_t)i);
		judge(c, k, tau);
		if (c->exact)
			judge_bits(c, k, tau, tau + nv);
		target_rnea(c->target, &x.q, &x.qd, &x.qdd, &x.qdd);
		for (int i = 0; i < nv; i++)
			ck_assert_msg(same_number(array_get(&x.qdd, (size_t)i), tau[i]),
				"%s: state %d: torque %d in place is %a, else %a", c->target->what, k, i,
				array_get(&x.qdd, (size_t)i), tau[i]);
	}
	ck_assert_msg(array_intact(&x.tau) && array_intact(&x.qdd), "%s: wrote before tau", c->target->what);
	slot_free(&x);
	free(tau);
	c->worst->count++;
}

/* Element of a batch of `count` samples. */
static size_t element(const struct target *t, int sample, int row, int rows, int count)
{
	return t->options.layout == RNEAGEN_SOA ? at(row, count) + (size_t)sample : at(sample, rows) + (size_t)row;
}

static struct array batch_of(const struct check *c, const double *x, int rows, int count)
{
	struct array a = array_new(c->target->f32, at(rows, count));

	for (int k = 0; k < count; k++)
		for (int r = 0; r < rows; r++)
			array_set(&a, element(c->target, k, r, rows, count),
				x ? x[at(k, rows) + (size_t)r] : (double)NAN);
	return a;
}

static struct slot batch_new(const struct check *c, int count)
{
	const struct states *s = c->states;

	return (struct slot){batch_of(c, s->q, s->nq, count), batch_of(c, s->qd, s->nv, count),
		batch_of(c, s->qdd, s->nv, count), batch_of(c, NULL, s->nv, count)};
}

static void check_batch_of(const struct check *c, int count)
{
	struct slot batch = batch_new(c, count), x = slot_new(c, 0);
	const struct states *s = c->states;

	target_batch(c->target, &batch.q, &batch.qd, &batch.qdd, &batch.tau, (size_t)count);
	for (int k = 0; k < count; k++) {
		set_slot(&x, s, k);
		target_rnea(c->target, &x.q, &x.qd, &x.qdd, &x.tau);
		for (int i = 0; i < s->nv; i++) {
			double one = array_get(&x.tau, (size_t)i),
			       many = array_get(&batch.tau, element(c->target, k, i, s->nv, count));

			ck_assert_msg(c->exact ? same_number(one, many)
					       : fabs(one - many) <= bound_of(c, at(k, s->nv) + (size_t)i),
				"%s: batch of %d, sample %d: torque %d is %a, alone %a", c->target->what, count, k, i,
				many, one);
		}
	}
	ck_assert_msg(array_intact(&batch.tau), "%s: batch of %d: wrote before tau", c->target->what, count);
	slot_free(&batch);
	slot_free(&x);
}

void check_batch(const struct check *c)
{
	static const int counts[] = {0, 1, 7};

	for (size_t i = 0; i < sizeof counts / sizeof *counts; i++)
		check_batch_of(c, counts[i]);
	check_batch_of(c, c->states->count);
}

/* ||x - ref|| / ||ref|| */
static double distance(const struct array *x, const wide *ref)
{
	long double off = 0, size = 0;

	for (size_t i = 0; i < x->count; i++) {
		long double d = (long double)array_get(x, i) - (long double)ref[i];

		off += d * d;
		size += (long double)(ref[i] * ref[i]);
	}
	return off == 0 ? 0 : (double)sqrtl(off / size);
}

static void judge_back(const struct check *c, int k, const struct slot *x)
{
	const struct states *s = c->states;
	double error = distance(&x->tau, s->tau + at(k, s->nv));

	ck_assert_msg(!c->real || error <= limit_of(c), "%s: state %d: bpass(fpass): relative error %g",
		c->target->what, k, error);
	keep_worst(&c->worst->back, c->worst->back_of, error, c->target->what);
	for (size_t i = 0; i < (size_t)s->nv && !c->real; i++) {
		double off = (double)fabsl((long double)array_get(&x->tau, i) - (long double)s->tau[at(k, s->nv) + i]);
		double magnitude = s->noise[at(k, s->nv) + i] / (4 * 0x1p-53);

		ck_assert_msg(off <= LIMIT_TERMS * eps(c) * magnitude,
			"%s: state %d: bpass(fpass): torque %zu is off by %g", c->target->what, k, i, off);
	}
}

void check_passes(const struct check *c)
{
	static const char *const names[] = {"v", "a", "f"};
	const struct states *s = c->states;
	int rows = 6 * c->model->tree.body_count;
	wide(*ref)[6] = calloc(at(3, rows), sizeof(wide));
	struct array out[3] = {array_of(c, NULL, rows), array_of(c, NULL, rows), array_of(c, NULL, rows)};
	struct slot x = slot_new(c, 0);

	for (int k = 0; k < PASS_STATES; k++) {
		set_slot(&x, s, k);
		reference_passes(c->model->reference, s->q + at(k, s->nq), s->qd + at(k, s->nv), s->qdd + at(k, s->nv),
			ref, ref + rows / 6, ref + rows / 3);
		target_fpass(c->target, &x.q, &x.qd, &x.qdd, out);
		for (int i = 0; i < 3; i++) {
			double error = distance(&out[i], &ref[i * rows / 6][0]);

			ck_assert_msg(error <= limit_of(c), "%s: state %d: fpass: %s has relative error %g",
				c->target->what, k, names[i], error);
			ck_assert_msg(array_intact(&out[i]), "%s: fpass wrote before %s", c->target->what, names[i]);
			keep_worst(&c->worst->passes, c->worst->passes_of, error, c->target->what);
		}
		target_bpass(c->target, &x.q, &out[2], &x.tau);
		judge_back(c, k, &x);
	}
	ck_assert_msg(array_intact(&x.tau), "%s: bpass wrote before tau", c->target->what);
	for (int i = 0; i < 3; i++)
		array_free(&out[i]);
	slot_free(&x);
	free(ref);
}

void worst_merge(struct worst *into, const struct worst *from)
{
	keep_worst(&into->norm, into->norm_of, from->norm, from->norm_of);
	keep_worst(&into->passes, into->passes_of, from->passes, from->passes_of);
	keep_worst(&into->back, into->back_of, from->back, from->back_of);
	into->terms = fmax(into->terms, from->terms);
	into->count += from->count;
}

void worst_report(const struct worst *w, const char *what)
{
	printf("%d texts for %s: tau %.2e (%s), %.2f eps of the magnitudes summed; fpass %.2e (%s); bpass of it %.2e "
	       "(%s)\n",
		w->count, what, w->norm, w->norm_of, w->terms, w->passes, w->passes_of, w->back, w->back_of);
}
