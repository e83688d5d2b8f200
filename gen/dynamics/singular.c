#include "dynamics/singular.h"
#include "dag/eval.h"
#include "draw/draw.h"
#include "dynamics/want.h"
#include <math.h>

/* A number of D is zero where M is singular; computed, some 1e-19 of the element of M that it is what is left of, and more where
   those before it left little of theirs. Of robots that can move it is no less than the ratio of a joint's own inertia to that of
   all that it carries. */
static const real NOTHING_LEFT = 1e-13L;

enum { SAMPLES = 3 };

static const struct draw_options DRAWN = {.seed = 1, .count = SAMPLES, .each = 1};

/* A quaternion drawn in doubles has no norm of one: by 1e-16, which numbers of D that are zero would show. */
static void normalise(const struct tree *t, real *q)
{
	for (int i = 0; i < t->joint_count; i++) {
		real *k, norm;

		if (t->joints[i].type != JOINT_FLOATING)
			continue;
		k = q + t->joints[i].iq + 3;
		norm = sqrtl(k[0] * k[0] + k[1] * k[1] + k[2] * k[2] + k[3] * k[3]);
		for (int c = 0; c < 4; c++)
			k[c] /= norm;
	}
}

/* Evaluate the pivots in one sample. */
static int evaluate(const struct dag *d, const struct tree *t, const struct drawn *x, size_t sample, real *pivots,
	struct arena *a)
{
	const real *in[DAG_ARGUMENTS] = {NULL};
	real *out[DAG_ARGUMENTS] = {NULL};

	for (int i = 0; i < d->argument_count; i++) {
		const double *rows = d->arguments[i].is_output ? NULL : draw_rows(x, &d->arguments[i], sample);
		real *copy = arena_alloc(a, (size_t)d->arguments[i].rows, sizeof *copy);

		if (!copy)
			return 0;
		for (int r = 0; rows && r < d->arguments[i].rows; r++)
			copy[r] = (real)rows[r];
		if (rows && d->arguments[i].role == ROLE_JOINT_POSITION)
			normalise(t, copy);
		in[i] = rows ? copy : NULL;
		out[i] = rows ? NULL : i == dag_find_argument(d, "pivots") ? pivots : copy;
	}
	return eval_real(d, in, out, NULL);
}

static int nth_opspace(const struct request *k, int n)
{
	int i = 0;

	while (k->wants[i].kind != WANT_OPSPACE || n-- > 0)
		i++;
	return i;
}

/* What the pivot of this number makes of d->singular. */
static struct singular singular_of(int pivot, const struct tree *t, const struct request *k)
{
	int beyond = pivot - t->nv;

	if (beyond < 0)
		return (struct singular){SINGULAR_ROW, pivot};
	if (beyond < k->contact_rows)
		return contacts_singular(k, beyond);
	return (struct singular){SINGULAR_WANT, nth_opspace(k, (beyond - k->contact_rows) / 6)};
}

/* Does this row leave nothing, nor any number at all? Of M in all samples: a joint may move little. Of what links feel in one of
   them: in states that are drawn all that can be moved is, but so ill is what most are left of that others may show more. */
static int is_nothing(const real *pivots, int count, int row, int nv)
{
	int samples = 0;

	for (int s = 0; s < SAMPLES; s++) {
		const real *p = pivots + 2 * (s * count + row);

		samples += !(fabsl(p[0]) > NOTHING_LEFT * fabsl(p[1]));
	}
	return row < nv ? samples == SAMPLES : samples > 0;
}

/* Rows are eliminated one after the other. The first that leaves nothing spoils the others, which are then no small numbers. */
static void judge(struct dag *d, const struct dag *trial, const struct tree *t, const struct request *k, struct arena *a)
{
	int count = forward_pivot_count(t, k);
	struct drawn x;
	real *pivots = arena_alloc(a, SAMPLES * 2 * (size_t)count, sizeof *pivots);

	if (!pivots || !draw_inputs(&x, t, k, &DRAWN, a)) {
		d->failed = 1;
		return;
	}
	for (int s = 0; s < SAMPLES && !d->failed; s++)
		d->failed = !evaluate(trial, t, &x, (size_t)s, pivots + s * 2 * count, a);
	for (int i = 0; i < count && !d->failed; i++)
		if (is_nothing(pivots, count, i, t->nv)) {
			d->failed = 1;
			d->singular = singular_of(i, t, k);
		}
}

int singular_find(struct dag *d, const struct tree *t, const struct request *k)
{
	struct arena spare;
	struct dag trial;

	arena_init(&spare, &d->arena->allocator);
	dag_init(&trial, &spare);
	want_build_in(&trial, t, k, (struct ways){.derivatives = DERIVATIVES_RECURSION,
		.dynamics = articulated_is_shorter(t) ? DYNAMICS_ARTICULATED : DYNAMICS_FACTOR, .pivots_alone = 1});
	d->failed |= trial.failed;
	d->singular = trial.singular;
	if (!d->failed)
		judge(d, &trial, t, k, &spare);
	d->arena->failed |= spare.failed;
	arena_free(&spare);
	return d->failed;
}
