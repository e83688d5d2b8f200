#include "data.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- .npy, version 1: 10 bytes, the header's length in the last two, the header, the values ---- */

static int read_header(FILE *f, struct samples *s)
{
	unsigned char head[10];
	char text[1024];
	const char *shape;
	size_t length;

	if (fread(head, 1, sizeof head, f) != sizeof head || memcmp(head, "\x93NUMPY\x01", 7) != 0)
		return 0;
	length = head[8] + 256u * head[9];
	if (length >= sizeof text || fread(text, 1, length, f) != length)
		return 0;
	text[length] = '\0';
	shape = strstr(text, "'shape': (");
	return strstr(text, "'<f8'") && strstr(text, "'fortran_order': False") && shape &&
	       sscanf(shape, "'shape': (%zu, %zu)", &s->count, &s->rows) == 2 && s->count && s->rows;
}

static int read_npy(struct samples *s, const char *folder, const char *name)
{
	char path[1024];
	FILE *f;
	int good;

	snprintf(path, sizeof path, "%s/%s.npy", folder, name);
	if (!(f = fopen(path, "rb"))) {
		fprintf(stderr, "%s: cannot be opened\n", path);
		return 0;
	}
	good = read_header(f, s);
	if (good) {
		s->values = malloc(s->count * s->rows * sizeof *s->values);
		good = s->values && fread(s->values, sizeof *s->values, s->count * s->rows, f) == s->count * s->rows;
	}
	fclose(f);
	if (!good)
		fprintf(stderr, "%s: not a two-dimensional NumPy array of doubles\n", path);
	return good;
}

int reference_read(struct reference *r, const char *folder)
{
	memset(r, 0, sizeof *r);
	if (read_npy(&r->q, folder, "q") && read_npy(&r->qd, folder, "qd") && read_npy(&r->qdd, folder, "qdd") &&
		read_npy(&r->tau, folder, "tau")) {
		if (r->q.count == r->qd.count && r->q.count == r->qdd.count && r->q.count == r->tau.count)
			return 1;
		fprintf(stderr, "%s: the arrays have different numbers of samples\n", folder);
	}
	reference_free(r);
	return 0;
}

void reference_free(struct reference *r)
{
	free(r->q.values);
	free(r->qd.values);
	free(r->qdd.values);
	free(r->tau.values);
	memset(r, 0, sizeof *r);
}

const struct samples *reference_find(const struct reference *r, const char *name)
{
	return strcmp(name, "q") == 0	  ? &r->q
	       : strcmp(name, "qd") == 0  ? &r->qd
	       : strcmp(name, "qdd") == 0 ? &r->qdd
	       : strcmp(name, "tau") == 0 ? &r->tau
					  : NULL;
}

/* ---- tiling ---- */

static size_t size_of(enum rnea_scalar scalar)
{
	return scalar == RNEA_F64 ? sizeof(double) : sizeof(float);
}

/* One period of a row (soa) or of everything (aos): `stride` doubles apart, n of them. */
static void convert(const double *from, size_t stride, void *to, size_t n, enum rnea_scalar scalar)
{
	double *wide = to;
	float *narrow = to;

	for (size_t i = 0; i < n; i++)
		if (scalar == RNEA_F64)
			wide[i] = from[i * stride];
		else
			narrow[i] = (float)from[i * stride];
}

/* Fill `total` bytes with copies of their first `period` bytes. */
static void repeat(char *at, size_t period, size_t total)
{
	for (size_t done = period; done < total; done += period)
		memcpy(at + done, at, done + period <= total ? period : total - done);
}

void samples_tile(const struct samples *s, void *host, size_t count, enum rnea_scalar scalar, enum rnea_layout layout)
{
	size_t n = count < s->count ? count : s->count, size = size_of(scalar);

	if (layout == RNEA_AOS) {
		convert(s->values, 1, host, n * s->rows, scalar);
		repeat(host, n * s->rows * size, count * s->rows * size);
		return;
	}
	for (size_t r = 0; r < s->rows; r++) {
		char *row = (char *)host + r * count * size;

		convert(s->values + r, s->rows, row, n, scalar);
		repeat(row, n * size, count * size);
	}
}

/* ---- comparing ---- */

static double value_at(const void *host, size_t i, enum rnea_scalar scalar)
{
	return scalar == RNEA_F64 ? ((const double *)host)[i] : (double)((const float *)host)[i];
}

/* ||x - s|| of sample k; infinite where x is not finite. */
static double distance(const struct samples *s, const void *host, size_t k, size_t count, enum rnea_scalar scalar,
	enum rnea_layout layout)
{
	const double *right = s->values + k % s->count * s->rows;
	double sum = 0;

	for (size_t r = 0; r < s->rows; r++) {
		double x = value_at(host, layout == RNEA_AOS ? k * s->rows + r : r * count + k, scalar);

		if (!isfinite(x))
			return INFINITY;
		sum += (x - right[r]) * (x - right[r]);
	}
	return sqrt(sum);
}

static double norm_of(const struct samples *s, size_t k)
{
	double sum = 0;

	for (size_t r = 0; r < s->rows; r++)
		sum += s->values[k * s->rows + r] * s->values[k * s->rows + r];
	return sqrt(sum);
}

/* The norms of all samples, and after them a tenth of their rms; malloc. */
static double *norms_of(const struct samples *s)
{
	double *norms = malloc((s->count + 1) * sizeof *norms), sum = 0;

	for (size_t k = 0; k < s->count; k++) {
		norms[k] = norm_of(s, k);
		sum += norms[k] * norms[k];
	}
	norms[s->count] = sqrt(sum / (double)s->count) / 10;
	return norms;
}

static double ratio(double difference, double norm)
{
	return difference == 0 ? 0 : difference / norm; /* a robot whose torques are all zero */
}

struct difference samples_compare(
	const struct samples *s, const void *host, size_t count, enum rnea_scalar scalar, enum rnea_layout layout)
{
	struct difference d = {0};
	double *norms = norms_of(s), sum = 0;

	for (size_t k = 0; k < count; k++) {
		double difference = distance(s, host, k, count, scalar, layout), norm = norms[k % s->count];
		double error = ratio(difference, norm), scaled = ratio(difference, fmax(norm, norms[s->count]));

		sum += error * error;
		d.max = fmax(d.max, error);
		if (scaled > d.scaled) {
			d.scaled = scaled;
			d.worst = k;
		}
	}
	d.rms = sqrt(sum / (double)count);
	free(norms);
	return d;
}
