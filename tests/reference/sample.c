#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "reference/reference.h"
#include "reference/read.h"

static const double pi = 3.141592653589793;

static double within_limits(const struct reference_joint *j, struct rng *rng)
{
	double cap = j->type == REFERENCE_PRISMATIC ? 1 : pi;
	double low = fmax(j->lower, -cap), high = fmin(j->upper, cap);

	if (j->type == REFERENCE_CONTINUOUS || !(j->lower < j->upper) || !(low < high))
		return rng_uniform(rng, -cap, cap);
	return rng_uniform(rng, low, high);
}

// Uniform on the sphere: a point of the ball, scaled to length 1.
static void unit_quaternion(struct rng *rng, double *q)
{
	double sum;

	do {
		sum = 0;
		for (int i = 0; i < 4; i++) {
			q[i] = rng_uniform(rng, -1, 1);
			sum += q[i] * q[i];
		}
	} while (sum > 1 || sum < 0.01);
	for (int i = 0; i < 4; i++)
		q[i] /= sqrt(sum);
}

static void sample_joint(const struct reference_joint *j, struct rng *rng, double *q)
{
	int positions = j->type == REFERENCE_FLOATING ? 3 : j->type == REFERENCE_PLANAR ? 2 : 0;

	for (int k = 0; k < positions; k++)
		q[k] = rng_uniform(rng, -1, 1);
	if (j->type == REFERENCE_FLOATING)
		unit_quaternion(rng, q + 3);
	else if (j->type == REFERENCE_PLANAR)
		q[2] = rng_uniform(rng, -pi, pi);
	else
		q[0] = within_limits(j, rng);
}

static void round_to_float(double *x, int n)
{
	for (int i = 0; i < n; i++)
		x[i] = (double)(float)x[i];
}

void reference_sample(const struct reference *r, struct rng *rng, bool f32, double *q, double *qd, double *qdd)
{
	for (int i = 0; i < r->nj; i++)
		if (r->joints[i].nq)
			sample_joint(&r->joints[i], rng, q + r->joints[i].iq);
	for (int i = 0; i < r->nv; i++) {
		qd[i] = rng_uniform(rng, -2, 2);
		qdd[i] = rng_uniform(rng, -5, 5);
	}
	if (f32) {
		round_to_float(q, r->nq);
		round_to_float(qd, r->nv);
		round_to_float(qdd, r->nv);
	}
}

double reference_error(const double *tau, const wide *ref, int n)
{
	wide difference = 0, size = 0;

	for (int i = 0; i < n; i++) {
		difference += ((wide)tau[i] - ref[i]) * ((wide)tau[i] - ref[i]);
		size += ref[i] * ref[i];
	}
	if (size > 0)
		return (double)wide_sqrt(difference / size);
	return difference > 0 ? (double)INFINITY : (double)difference;
}

static char *read_all(FILE *file, size_t *length)
{
	char *text = NULL;
	size_t room = 0, n;

	*length = 0;
	do {
		room += 1 << 16;
		text = raw_memory(text, room, 1);
		n = fread(text + *length, 1, room - *length, file);
		*length += n;
	} while (n);
	return text;
}

struct reference *reference_open_file(const char *path, const struct reference_options *o, char *message, size_t size)
{
	FILE *file = fopen(path, "rb");
	struct reference *r;
	size_t length;
	char *text;

	if (!file) {
		snprintf(message, size, "%s: cannot be opened", path);
		return NULL;
	}
	text = read_all(file, &length);
	fclose(file);
	r = reference_open(text, length, o, message, size);
	free(text);
	return r;
}
