#include <stdlib.h>

#include "bench.h"
#include "reference/differences.h"

/* What the reference says about one state, and which elements a text stores, row by row: those of joints on one branch;
   of M the lower triangle. */
struct expected {
	wide *tau, *dq, *dqd, *M, *work;
	bool *stored;
};

static void *allocate(size_t n, size_t size)
{
	void *p = calloc(n, size);

	if (!p)
		abort();
	return p;
}

static int joint_of_row(const struct reference *r, int row)
{
	for (int e = 0; e < r->nj; e++)
		if (row >= r->joints[e].iv && row < r->joints[e].iv + r->joints[e].nv)
			return e;
	abort();
}

static bool carries(const struct reference *r, int above, int below)
{
	while (below > above)
		below = r->joints[below].parent;
	return below == above;
}

static struct expected expected_open(const struct reference *r)
{
	size_t n = (size_t)r->nv, size = n * n;
	struct expected x = {allocate(n, sizeof(wide)), allocate(size, sizeof(wide)), allocate(size, sizeof(wide)),
		allocate(size, sizeof(wide)), allocate(REFERENCE_WORK(r), sizeof(wide)), allocate(size, sizeof(bool))};

	for (int i = 0; i < r->nv; i++)
		for (int j = 0; j < r->nv; j++) {
			int a = joint_of_row(r, i), b = joint_of_row(r, j);

			x.stored[i * r->nv + j] = carries(r, a, b) || carries(r, b, a);
		}
	return x;
}

static void expected_close(struct expected *x)
{
	free(x->tau);
	free(x->dq);
	free(x->dqd);
	free(x->M);
	free(x->work);
	free(x->stored);
}

static double magnitude(wide x)
{
	return (double)wide_abs(x);
}

static void keep_larger(double *most, double x)
{
	if (x > *most || x != x) /* NaN stays */
		*most = x;
}

/* The largest difference of a matrix as a text stores it, an element each `stride`, and where it stores nothing, of 0. */
static double packed_error(const struct bench *b, const struct expected *x, const wide *want, const double *got,
	size_t stride, bool lower)
{
	double size = 0, most = 0;
	size_t at = 0;

	for (int i = 0; i < b->nv; i++)
		for (int j = 0; j < b->nv; j++) {
			int e = i * b->nv + j;
			double value = x->stored[e] && (!lower || j <= i) ? got[at++ * stride] : 0;

			keep_larger(&size, magnitude(want[e]));
			if (!lower || j <= i)
				keep_larger(&most, magnitude(want[e] - (wide)value));
		}
	return most / size;
}

static double vector_error(const struct bench *b, const wide *want, const double *got, size_t stride)
{
	double size = 0, most = 0;

	for (int i = 0; i < b->nv; i++) {
		keep_larger(&size, magnitude(want[i]));
		keep_larger(&most, magnitude(want[i] - (wide)got[(size_t)i * stride]));
	}
	return most / size;
}

static double peer_error(const struct bench *b, enum peer_result result, const wide *want, int columns)
{
	double size = 0, most = 0;

	for (int i = 0; i < b->nv; i++)
		for (int j = 0; j < columns; j++) {
			wide w = want[i * columns + j];

			keep_larger(&size, magnitude(w));
			keep_larger(&most, magnitude(w - (wide)peer_element(b->peer, result, i, j)));
		}
	return most / size;
}

/* Every array that the function makes. */
static void generated_error(const struct bench *b, enum function f, const struct expected *x, const struct arrays *a,
	int s, size_t stride, double *most)
{
	if (f != MASS)
		keep_larger(most, vector_error(b, x->tau, a->tau + s, stride));
	if (f == DERIVATIVES || f == DERIVATIVES_AND_M) {
		keep_larger(most, packed_error(b, x, x->dq, a->dq + s, stride, false));
		keep_larger(most, packed_error(b, x, x->dqd, a->dqd + s, stride, false));
	}
	if (f == MASS || f == DERIVATIVES_AND_M)
		keep_larger(most, packed_error(b, x, x->M, a->M + s, stride, true));
}

static void pinocchio_error(const struct bench *b, enum function f, const struct expected *x, double *most)
{
	if (f != MASS)
		keep_larger(most, peer_error(b, PEER_TAU, x->tau, 1));
	if (f == DERIVATIVES || f == DERIVATIVES_AND_M) {
		keep_larger(most, peer_error(b, PEER_DQ, x->dq, b->nv));
		keep_larger(most, peer_error(b, PEER_DQD, x->dqd, b->nv));
	}
	if (f == MASS || f == DERIVATIVES_AND_M)
		keep_larger(most, peer_error(b, PEER_M, x->M, b->nv));
}

/* One state; the batch is made anew for each function, since they share arrays. */
static void state_error(const struct bench *b, int s, const struct expected *x, struct error errors[FUNCTIONS])
{
	for (int i = 0; i < FUNCTIONS; i++) {
		enum function f = (enum function)i;

		call_one(b, f, s);
		call_batch(b, f);
		call_peer(b, f, s);
		generated_error(b, f, x, &b->one, 0, 1, &errors[f].one);
		generated_error(b, f, x, &b->batch, s, STATES, &errors[f].batch);
		pinocchio_error(b, f, x, &errors[f].peer);
	}
}

void error_measure(const struct bench *b, int count, struct error errors[FUNCTIONS])
{
	struct expected x = expected_open(b->r);

	for (int s = 0; s < count; s++) {
		const double *q = bench_q(b, s), *qd = bench_qd(b, s), *qdd = bench_qdd(b, s);

		reference_differences(b->r, q, qd, qdd, x.dq, x.dqd, x.M, x.work);
		reference_rnea(b->r, q, qd, qdd, x.tau);
		state_error(b, s, &x, errors);
	}
	expected_close(&x);
}
