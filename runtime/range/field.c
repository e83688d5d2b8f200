#include "range/field.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

typedef double lanes __attribute__((vector_size(FIELD_VECTOR * sizeof(double))));

/* ---- evaluating ---- */

static void run_narrow(const struct field_step *s, double *v)
{
	double a = v[s->arg[0]], b = v[s->arg[1]], c = v[s->arg[2]];

	switch (s->op) {
	case OP_NEG:
		v[s->to] = -a;
		break;
	case OP_ADD:
		v[s->to] = a + b;
		break;
	case OP_SUB:
		v[s->to] = a - b;
		break;
	case OP_MUL:
		v[s->to] = a * b;
		break;
	case OP_FMA:
		v[s->to] = a * b + c;
		break;
	default:
		v[s->to] = a;
	}
}

#define EACH_LANE(value)                                                                                               \
	for (size_t i = 0; i < n; i++)                                                                                 \
		to[i] = value;                                                                                         \
	break

FIELD_CLONES static void run(const struct field *f, double *narrow, lanes *wide)
{
	size_t n = f->lane_count / FIELD_VECTOR;

	for (const struct field_step *s = f->steps; s < f->steps + f->step_count; s++) {
		lanes *to = wide + s->to * n;
		const lanes *a = wide + s->arg[0] * n, *b = wide + s->arg[1] * n, *c = wide + s->arg[2] * n;

		if (!s->is_wide) {
			run_narrow(s, narrow);
			continue;
		}
		switch (s->op) {
		case OP_NEG:
			EACH_LANE(-a[i]);
		case OP_ADD:
			EACH_LANE(a[i] + b[i]);
		case OP_SUB:
			EACH_LANE(a[i] - b[i]);
		case OP_MUL:
			EACH_LANE(a[i] * b[i]);
		case OP_FMA:
			EACH_LANE(a[i] * b[i] + c[i]);
		default:
			EACH_LANE(narrow[s->arg[0]] + (lanes){0});
		}
	}
}

void field_place(const struct field_dim *dim, double q, double x[2])
{
	x[0] = dim->is_angle ? (double)sinl((real)q) : q;
	x[1] = dim->is_angle ? (double)cosl((real)q) : 0;
}

static double *narrow_of(const struct field *f, double *work)
{
	return work + f->wide_count * f->lane_count;
}

static void load(const struct field *f, const struct field_point *q, double *narrow)
{
	for (int i = 0; i < f->dim_count; i++) {
		const struct field_dim *k = &f->dims[i];

		if (!k->is_angle) {
			narrow[f->slots[k->value]] = q->x[i][0];
			continue;
		}
		if (k->sine)
			narrow[f->slots[k->sine]] = q->x[i][0];
		if (k->cosine)
			narrow[f->slots[k->cosine]] = q->x[i][1];
	}
}

/* From the values at x = 0, each drive alone, each rate alone (and backwards), each pair of rates. */
static void to_coefficients(const struct field *f, const double *v, double *c)
{
	int n = f->rate_count, m = f->drive_count;
	const double *forth = v + 1 + m, *back = f->is_odd ? forth + n : forth, *pair = back + n;

	c[0] = v[0];
	for (int i = 0; i < m; i++)
		c[1 + i] = v[1 + i] - v[0];
	for (int j = 0; j < n; j++) {
		c[1 + m + j] = 0.5 * (forth[j] - back[j]);
		c[field_pair(f, j, j)] = 0.5 * (forth[j] + back[j]) - v[0];
		for (int k = j + 1; k < n; k++)
			c[field_pair(f, j, k)] = *pair++ - forth[j] - forth[k] + v[0];
	}
}

void field_evaluate(const struct field *f, const struct field_point *q, double *work, double *coefficients)
{
	double *narrow = narrow_of(f, work);

	load(f, q, narrow);
	run(f, narrow, (lanes *)(void *)work);
	for (int i = 0; i < f->output_count; i++)
		to_coefficients(f, work + f->result[i] * f->lane_count, coefficients + (size_t)i * f->coefficient_count);
}

/* ---- what never changes ---- */

static void put_drive(const struct field *f, int i, double *lane)
{
	for (size_t k = 0; k < f->lane_count; k++)
		lane[k] = 0;
	lane[1 + i] = f->drives[i].scale;
}

static void put_rate(const struct field *f, int j, double *lane)
{
	double x = f->rates[j].scale, *forth = lane + 1 + f->drive_count, *pair;

	for (size_t k = 0; k < f->lane_count; k++)
		lane[k] = 0;
	forth[j] = x;
	if (f->is_odd)
		forth[f->rate_count + j] = -x;
	pair = forth + (f->is_odd ? 2 : 1) * f->rate_count;
	for (int a = 0; a < f->rate_count; a++)
		for (int b = a + 1; b < f->rate_count; b++, pair++)
			if (a == j || b == j)
				*pair = x;
}

static void put_constants(const struct field *f, double *narrow)
{
	for (size_t i = 0; i < f->d->count; i++)
		if (f->d->nodes[i].op == OP_CONST && f->slots[i] != UINT32_MAX)
			narrow[f->slots[i]] = (double)f->d->nodes[i].value;
}

double *field_work(const struct field *f)
{
	size_t count = f->wide_count * f->lane_count + f->narrow_count;
	size_t unit = FIELD_VECTOR * sizeof(double), size = (count * sizeof(double) / unit + 1) * unit;
	double *work = aligned_alloc(unit, size);

	if (!work)
		return NULL;
	memset(work, 0, size);
	put_constants(f, narrow_of(f, work));
	for (int i = 0; i < f->drive_count; i++)
		put_drive(f, i, work + f->slots[f->drives[i].node] * f->lane_count);
	for (int j = 0; j < f->rate_count; j++)
		put_rate(f, j, work + f->slots[f->rates[j].node] * f->lane_count);
	return work;
}

/* ---- at one state ---- */

double *field_scalars(const struct field *f)
{
	double *v = calloc(f->wide_count + f->narrow_count + 1, sizeof *v);

	if (v)
		put_constants(f, v + f->wide_count);
	return v;
}

void field_values(const struct field *f, const struct field_point *q, const double *x, double *v, double *values)
{
	double *narrow = v + f->wide_count;

	load(f, q, narrow);
	for (int i = 0; i < f->drive_count; i++)
		v[f->slots[f->drives[i].node]] = x[i] * f->drives[i].scale;
	for (int j = 0; j < f->rate_count; j++)
		v[f->slots[f->rates[j].node]] = x[f->drive_count + j] * f->rates[j].scale;
	for (const struct field_step *s = f->steps; s < f->steps + f->step_count; s++)
		if (s->is_wide && s->op == OP_ANEW)
			v[s->to] = narrow[s->arg[0]];
		else
			run_narrow(s, s->is_wide ? v : narrow);
	for (int i = 0; i < f->output_count; i++)
		values[i] = v[f->result[i]];
}
