/* bench ROBOT.urdf BASE MODEL REPEATS CHECKED: rows of speeds and errors, "function,...", of the texts that this program is
   linked with, beside Pinocchio's functions on MODEL, which Pinocchio wrote. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "bench.h"
#include "torque.h"

enum { SEED = 20 };

static double *rows(int n, int samples)
{
	double *p = calloc((size_t)n * (size_t)samples, sizeof *p);

	if (!p)
		abort();
	return p;
}

static struct arrays arrays_open(int nq, int nv, int samples)
{
	return (struct arrays){rows(nq, samples), rows(nv, samples), rows(nv, samples), rows(nv, samples), rows(nv * nv, samples),
		rows(nv * nv, samples), rows(nv * nv, samples)};
}

static void arrays_close(struct arrays *a)
{
	free(a->q);
	free(a->qd);
	free(a->qdd);
	free(a->tau);
	free(a->dq);
	free(a->dqd);
	free(a->M);
}

static void scatter(const double *from, int n, int s, double *to)
{
	for (int i = 0; i < n; i++)
		to[(size_t)i * STATES + (size_t)s] = from[i];
}

static void draw_states(struct bench *b)
{
	struct rng rng = rng_seed(SEED);

	for (int s = 0; s < STATES; s++) {
		double *q = b->states + (size_t)s * (size_t)(b->nq + 2 * b->nv), *qd = q + b->nq, *qdd = qd + b->nv;

		reference_sample(b->r, &rng, false, q, qd, qdd);
		scatter(q, b->nq, s, b->batch.q);
		scatter(qd, b->nv, s, b->batch.qd);
		scatter(qdd, b->nv, s, b->batch.qdd);
	}
}

static bool bench_open(struct bench *b, const char *urdf, const char *base, const char *model)
{
	const struct reference_options o = {.floating = !strcmp(base, "floating"), .independent = true};
	char message[256];

	b->r = reference_open_file(urdf, &o, message, sizeof message);
	if (!b->r) {
		fprintf(stderr, "bench: %s: %s\n", urdf, message);
		return false;
	}
	b->peer = peer_open(model);
	if (!b->peer)
		return false;
	b->nq = b->r->nq;
	b->nv = b->r->nv;
	if (b->nq != torque_nq || b->nv != torque_nv || b->nq != peer_nq(b->peer) || b->nv != peer_nv(b->peer)) {
		fprintf(stderr, "bench: %s has %d rows of q, the text %d, Pinocchio's model %d: continuous joints are left out\n",
			urdf, b->nq, torque_nq, peer_nq(b->peer));
		return false;
	}
	b->states = rows(b->nq + 2 * b->nv, STATES);
	b->one = arrays_open(b->nq, b->nv, 1);
	b->batch = arrays_open(b->nq, b->nv, STATES);
	draw_states(b);
	return true;
}

static void bench_close(struct bench *b)
{
	reference_close(b->r);
	if (b->peer)
		peer_close(b->peer);
	free(b->states);
	arrays_close(&b->one);
	arrays_close(&b->batch);
}

static void print(const struct bench *b, const struct speed speeds[FUNCTIONS], const struct error errors[FUNCTIONS])
{
	for (int f = 0; f < FUNCTIONS; f++) {
		const struct ratio *x = &speeds[f].one, *y = &speeds[f].batch;

		printf("\"%s\",%s,%.4g,%.4g,%.4g,%.4g,%.4g,%.4g,%.2g,%.2g,%.2g\n", function_names[f],
			f == TAU ? "rnea" : f != MASS ? "computeRNEADerivatives" : b->world ? "crba WORLD" : "crba LOCAL",
			x->median, x->low, x->high, y->median, y->low, y->high, errors[f].one, errors[f].batch, errors[f].peer);
	}
}

int main(int argc, char **argv)
{
	struct bench b = {0};
	struct speed speeds[FUNCTIONS];
	struct error errors[FUNCTIONS] = {0};
	int repeats = argc == 6 ? atoi(argv[4]) : 0, checked = argc == 6 ? atoi(argv[5]) : 0, good;

	if (repeats < 1 || checked < 1 || checked > STATES) {
		fprintf(stderr, "usage: bench ROBOT.urdf fixed|floating MODEL REPEATS CHECKED\n");
		return 2;
	}
	good = bench_open(&b, argv[1], argv[2], argv[3]);
	if (good) {
		error_measure(&b, checked, errors);
		speed_measure(&b, repeats, speeds);
		print(&b, speeds, errors);
	}
	bench_close(&b);
	return good ? 0 : 1;
}
