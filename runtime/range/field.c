#include "range/field.h"
#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

typedef double lanes __attribute__((vector_size(FIELD_VECTOR * sizeof(double))));

#if defined __x86_64__ && defined __GNUC__ && !defined __clang__ && !defined __SANITIZE_ADDRESS__ && !defined __SANITIZE_THREAD__
#define FIELD_CLONES __attribute__((target_clones("avx512f", "avx2", "default")))
#else
#define FIELD_CLONES
#endif

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

static const struct field_input *find_input(const struct field_input *list, int count, const struct node *n)
{
	for (int i = 0; i < count; i++)
		if (list[i].argument == (int)n->arg[0].i && list[i].row == (int)n->arg[1].i)
			return &list[i];
	return NULL;
}

double *field_work(const struct field *f)
{
	size_t count = f->wide_count * f->lane_count + f->narrow_count;
	size_t unit = FIELD_VECTOR * sizeof(double), size = (count * sizeof(double) / unit + 1) * unit;
	double *work = aligned_alloc(unit, size);

	if (!work)
		return NULL;
	memset(work, 0, size);
	for (size_t i = 0; i < f->d->count; i++) {
		const struct node *n = &f->d->nodes[i];
		const struct field_input *drive, *rate;

		if (n->op == OP_CONST && f->slots[i] != UINT32_MAX)
			narrow_of(f, work)[f->slots[i]] = (double)n->value;
		if (n->op != OP_INPUT || f->slots[i] == UINT32_MAX)
			continue;
		drive = find_input(f->drives, f->drive_count, n);
		rate = find_input(f->rates, f->rate_count, n);
		if (drive)
			put_drive(f, (int)(drive - f->drives), work + f->slots[i] * f->lane_count);
		if (rate)
			put_rate(f, (int)(rate - f->rates), work + f->slots[i] * f->lane_count);
	}
	return work;
}
