/* A value at q is a polynomial of drives and rates x = middle + half t, t from -1 to 1; its coefficients follow from its values
   at a few t, the lanes, and the sum of their magnitudes is no smaller than any of its values. Between the places of a grid a
   value is off the straight lines between them by h_k^2/2 of its second derivative, by each row k of q (range/cover.c). Both
   hold for vectors with lengths in the place of magnitudes: of each component along a fixed direction. */
#define _POSIX_C_SOURCE 200809L
#include "core/seconds.h"
#include "peaks/peaks.h"
#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#if defined __x86_64__ && defined __GNUC__ && !defined __clang__ && !defined __SANITIZE_ADDRESS__ && !defined __SANITIZE_THREAD__
#define PEAKS_FAST __attribute__((target_clones("avx512f", "avx2", "default"), optimize("O3")))
#else
#define PEAKS_FAST
#endif

/* WIDTH: lanes of all points that are looked at together, where one point has fewer. */
enum { VECTOR = 8, WIDTH = 64, MOST_LANES = 512, LOOK_EVERY = 16, FIRST_POINTS = 512, MOST_PLACES = 4096 };

static const real TURN = 6.283185307179586476925286766559L;

typedef double vector __attribute__((vector_size(VECTOR * sizeof(double))));

struct step {
	enum op op;
	uint32_t to, a, b; /* slots */
};

/* A sine, a cosine or a length by a row of q. */
struct place_input {
	enum op op;
	uint32_t slot;
	int at; /* of the group's dims */
};

struct sampler {
	struct peaks *p;
	const struct peaks_group *g;
	int dims[PEAKS_DIMS], dim_count; /* of p->dims */
	double lower[PEAKS_DIMS], upper[PEAKS_DIMS], half[PEAKS_DIMS];
	double (*places[PEAKS_DIMS])[3]; /* length, sine, cosine */
	int counts[PEAKS_DIMS];
	unsigned char *live;
	uint32_t *slot, *drives, *rates; /* slot: by node; nodes of drives and rates */
	int drive_count, rate_count;
	struct step *steps;
	size_t step_count, slot_count;
	struct place_input *inputs;
	size_t input_count;
	int lanes, points; /* of a point; at once */
	size_t width;      /* vectors */
	vector *v, *most;  /* most: by member, of squares where there is one lane */
	double *found;     /* by member */
	struct arena arena;
};

/* ---- what is evaluated ---- */

static struct interval range_of(const struct sampler *s, const struct node *n)
{
	return s->p->rows[n->arg[0].i][n->arg[1].i];
}

static double middle_of(struct interval r)
{
	return r.lower == -r.upper ? 0 : 0.5 * r.lower + 0.5 * r.upper;
}

static double half_of(struct interval r)
{
	double middle = middle_of(r);

	return r.lower == r.upper ? 0 : fmax(round_up(r.upper - middle), round_up(middle - r.lower));
}

static void fill(const struct sampler *s, uint32_t slot, double x)
{
	double *to = (double *)(s->v + slot * s->width);

	for (size_t i = 0; i < s->width * VECTOR; i++)
		to[i] = x;
}

static int dim_at(const struct sampler *s, const struct node *n)
{
	for (int k = 0; k < s->dim_count && (int)n->arg[0].i == s->p->position; k++)
		if (s->p->dims[s->dims[k]] == (int)n->arg[1].i)
			return k;
	return -1;
}

/* By a row of q, which is fixed or a dimension; or a drive or a rate, whose lanes come later. */
static void list_leaf(struct sampler *s, uint32_t i)
{
	const struct node *n = &s->p->x->d.nodes[i], *q = op_arity[n->op] ? &s->p->x->d.nodes[n->arg[0].i] : n;

	if ((int)q->arg[0].i == s->p->position && dim_at(s, q) >= 0)
		s->inputs[s->input_count++] = (struct place_input){n->op, s->slot[i], dim_at(s, q)};
	else if (n->op == OP_INPUT && (int)q->arg[0].i != s->p->position)
		*(s->p->x->d.arguments[q->arg[0].i].role == ROLE_JOINT_VELOCITY ? &s->rates[s->rate_count++]
										 : &s->drives[s->drive_count++]) = i;
}

static void list_node(struct sampler *s, uint32_t i)
{
	const struct node *n = &s->p->x->d.nodes[i];

	s->slot[i] = (uint32_t)s->slot_count++;
	switch (n->op) {
	case OP_NEG:
	case OP_ADD:
	case OP_SUB:
	case OP_MUL:
		s->steps[s->step_count++] = (struct step){n->op, s->slot[i], s->slot[n->arg[0].i],
			op_arity[n->op] > 1 ? s->slot[n->arg[1].i] : 0};
		return;
	case OP_INPUT:
	case OP_SIN:
	case OP_COS:
		list_leaf(s, i);
		return;
	default:
		return;
	}
}

static int list_all(struct sampler *s)
{
	const struct dag *d = &s->p->x->d;

	s->live = arena_alloc(&s->arena, d->count, 1);
	s->slot = arena_alloc(&s->arena, d->count, sizeof *s->slot);
	s->drives = arena_alloc(&s->arena, d->count, sizeof *s->drives);
	s->rates = arena_alloc(&s->arena, d->count, sizeof *s->rates);
	s->steps = arena_alloc(&s->arena, d->count, sizeof *s->steps);
	s->inputs = arena_alloc(&s->arena, d->count, sizeof *s->inputs);
	if (s->arena.failed)
		return 0;
	for (size_t i = 0; i < s->g->count; i++)
		for (int k = 0; k < 2; k++)
			s->live[s->p->list[s->g->members[i]].nodes[k]] = 1;
	dag_mark_operands(d, d->count, s->live);
	for (uint32_t i = 0; i < d->count; i++)
		if (s->live[i])
			list_node(s, i);
	return 1;
}

/* ---- lanes ---- */

static int lanes_of(const struct sampler *s)
{
	int n = s->rate_count;

	if (s->g->kind == PEAK_PLAIN)
		return 1;
	return s->g->kind == PEAK_LINEAR ? (n ? n : 1) : 1 + s->drive_count + 2 * n + n * (n - 1) / 2;
}

/* An input at t, in one lane of each point. */
static void put_lane(const struct sampler *s, uint32_t node, int lane, double t)
{
	struct interval r = range_of(s, &s->p->x->d.nodes[node]);
	double *to = (double *)(s->v + s->slot[node] * s->width);

	for (int p = 0; p < s->points; p++)
		to[p * s->lanes + lane] = middle_of(r) + t * half_of(r);
}

/* The middle of all; each drive; each rate, forth and back; each pair of rates. Of what is linear: each rate. */
static void put_lanes(const struct sampler *s)
{
	int lane = s->g->kind == PEAK_LINEAR ? 0 : 1, n = s->rate_count;

	for (int i = 0; i < s->drive_count; i++)
		fill(s, s->slot[s->drives[i]], middle_of(range_of(s, &s->p->x->d.nodes[s->drives[i]])));
	for (int j = 0; j < n; j++)
		fill(s, s->slot[s->rates[j]], middle_of(range_of(s, &s->p->x->d.nodes[s->rates[j]])));
	for (int i = 0; i < s->drive_count; i++)
		put_lane(s, s->drives[i], lane++, 1);
	for (int j = 0; j < n; j++)
		put_lane(s, s->rates[j], lane++, 1);
	for (int j = 0; j < n && s->g->kind == PEAK_FULL; j++)
		put_lane(s, s->rates[j], lane++, -1);
	for (int j = 0; j < n && s->g->kind == PEAK_FULL; j++)
		for (int k = j + 1; k < n; k++, lane++) {
			put_lane(s, s->rates[j], lane, 1);
			put_lane(s, s->rates[k], lane, 1);
		}
}

/* What never changes: constants, and sines and cosines of angles that are fixed. */
static void put_constants(const struct sampler *s)
{
	const struct dag *d = &s->p->x->d;

	for (uint32_t i = 0; i < d->count; i++) {
		const struct node *n = &d->nodes[i], *q = op_arity[n->op] ? &d->nodes[n->arg[0].i] : n;

		if (!s->live[i])
			continue;
		if (n->op == OP_CONST)
			fill(s, s->slot[i], (double)n->value);
		else if (n->op == OP_INPUT && (int)n->arg[0].i == s->p->position && dim_at(s, n) < 0)
			fill(s, s->slot[i], range_of(s, n).lower);
		else if ((n->op == OP_SIN || n->op == OP_COS) && dim_at(s, q) < 0)
			fill(s, s->slot[i], (double)(n->op == OP_SIN ? sinl(range_of(s, q).lower) : cosl(range_of(s, q).lower)));
	}
}

static int make_lanes(struct sampler *s)
{
	s->lanes = lanes_of(s);
	if (s->lanes > MOST_LANES)
		return -1;
	s->points = s->lanes >= WIDTH ? 1 : WIDTH / s->lanes;
	s->width = ((size_t)(s->points * s->lanes) + VECTOR - 1) / VECTOR;
	s->v = aligned_alloc(sizeof(vector), s->slot_count * s->width * sizeof(vector));
	s->most = aligned_alloc(sizeof(vector), (s->g->count + 1) * sizeof(vector));
	s->found = calloc(s->g->count + 1, sizeof *s->found);
	if (!s->v || !s->most || !s->found)
		return 0;
	memset(s->v, 0, s->slot_count * s->width * sizeof(vector));
	memset(s->most, 0, (s->g->count + 1) * sizeof(vector));
	put_constants(s);
	put_lanes(s);
	return 1;
}

/* ---- points ---- */

static void put_point(const struct sampler *s, size_t number, int point)
{
	int at[PEAKS_DIMS];

	for (int k = 0; k < s->dim_count; k++) {
		at[k] = (int)(number % (size_t)s->counts[k]);
		number /= (size_t)s->counts[k];
	}
	for (size_t i = 0; i < s->input_count; i++) {
		const struct place_input *in = &s->inputs[i];
		double *to = (double *)(s->v + in->slot * s->width) + point * s->lanes;
		double x = s->places[in->at][at[in->at]][in->op == OP_SIN ? 1 : in->op == OP_COS ? 2 : 0];

		for (int l = 0; l < s->lanes; l++)
			to[l] = x;
	}
}

PEAKS_FAST static void run(const struct step *steps, size_t count, size_t width, vector *v)
{
	for (const struct step *s = steps; s < steps + count; s++) {
		vector *to = v + s->to * width;
		const vector *a = v + s->a * width, *b = v + s->b * width;

		switch (s->op) {
		case OP_NEG:
			for (size_t i = 0; i < width; i++)
				to[i] = -a[i];
			break;
		case OP_ADD:
			for (size_t i = 0; i < width; i++)
				to[i] = a[i] + b[i];
			break;
		case OP_SUB:
			for (size_t i = 0; i < width; i++)
				to[i] = a[i] - b[i];
			break;
		default:
			for (size_t i = 0; i < width; i++)
				to[i] = a[i] * b[i];
		}
	}
}

/* Of one lane: the largest squares, lane by lane. All numbers are finite (peaks.c). */
PEAKS_FAST static void take_squares(size_t width, const vector *a, const vector *b, vector *most)
{
	for (size_t i = 0; i < width; i++) {
		vector x = a[i] * a[i] + (b ? b[i] * b[i] : (vector){0});

		for (int k = 0; k < VECTOR; k++)
			(*most)[k] = x[k] > (*most)[k] ? x[k] : (*most)[k];
	}
}

/* The coefficients of a polynomial of t from its lanes. */
static void to_coefficients(const struct sampler *s, const double *v, double *c)
{
	int m = s->drive_count, n = s->rate_count;
	const double *forth = v + 1 + m, *back = forth + n, *pair = back + n;
	double *squares = c + 1 + m + n, *pairs = squares + n;

	c[0] = v[0];
	for (int i = 0; i < m; i++)
		c[1 + i] = v[1 + i] - v[0];
	for (int j = 0; j < n; j++) {
		c[1 + m + j] = 0.5 * (forth[j] - back[j]);
		squares[j] = 0.5 * (forth[j] + back[j]) - v[0];
		for (int k = j + 1; k < n; k++)
			*pairs++ = *pair++ - forth[j] - forth[k] + v[0];
	}
}

/* Of the coefficients of one value: a square of t is from 0 to 1. */
static double reach_of_one(const struct sampler *s, const double *c)
{
	int squares = 1 + s->drive_count + s->rate_count;
	double lower = c[0], upper = c[0], sum = 0;

	for (int i = 1; i < s->lanes; i++)
		if (i >= squares && i < squares + s->rate_count) {
			lower += fmin(0, c[i]);
			upper += fmax(0, c[i]);
		} else {
			sum += fabs(c[i]);
		}
	return sum + fmax(-lower, upper);
}

static double reach_of(const struct sampler *s, const double *a, const double *b)
{
	double c[2][MOST_LANES], sum = 0;

	if (s->g->kind == PEAK_FULL) {
		to_coefficients(s, a, c[0]);
		if (!b)
			return reach_of_one(s, c[0]);
		to_coefficients(s, b, c[1]);
		a = c[0];
		b = c[1];
	}
	for (int i = 0; i < s->lanes; i++)
		sum += b ? sqrt(a[i] * a[i] + b[i] * b[i]) : fabs(a[i]);
	return sum;
}

static void take_points(struct sampler *s)
{
	for (size_t i = 0; i < s->g->count; i++) {
		const struct peak *k = &s->p->list[s->g->members[i]];
		const vector *a = s->v + s->slot[k->nodes[0]] * s->width, *b = k->pair ? s->v + s->slot[k->nodes[1]] * s->width : NULL;

		if (s->lanes == 1) {
			take_squares(s->width, a, b, &s->most[i]);
			continue;
		}
		for (int p = 0; p < s->points; p++)
			s->found[i] = fmax(s->found[i], reach_of(s, (const double *)a + p * s->lanes, b ? (const double *)b + p * s->lanes : NULL));
	}
}

/* Returns 0 when time ran out. */
static int take_grid(struct sampler *s, double size, double deadline)
{
	size_t points = (size_t)size;

	for (size_t i = 0; i < points; i += (size_t)s->points) {
		for (int p = 0; p < s->points; p++)
			put_point(s, i + (size_t)p < points ? i + (size_t)p : points - 1, p);
		run(s->steps, s->step_count, s->width, s->v);
		take_points(s);
		if (i / (size_t)s->points % LOOK_EVERY == 0 && seconds_now() > deadline)
			return 0;
	}
	for (size_t i = 0; i < s->g->count && s->lanes == 1; i++)
		for (int k = 0; k < VECTOR; k++)
			s->found[i] = fmax(s->found[i], sqrt(s->most[i][k]));
	return 1;
}

/* ---- grids ---- */

/* Is q read by its sine and cosine alone? Then a turn is enough. */
static int is_angle(const struct sampler *s, int k)
{
	for (size_t i = 0; i < s->input_count; i++)
		if (s->inputs[i].at == k && s->inputs[i].op == OP_INPUT)
			for (size_t j = 0; j < s->step_count; j++)
				if (s->steps[j].a == s->inputs[i].slot || s->steps[j].b == s->inputs[i].slot)
					return 0;
	return 1;
}

static void set_dims(struct sampler *s)
{
	for (int k = 0; k < s->p->dim_count; k++)
		if (s->g->dims >> k & 1)
			s->dims[s->dim_count++] = k;
}

static void set_ranges(struct sampler *s)
{
	for (int k = 0; k < s->dim_count; k++) {
		struct interval r = s->p->rows[s->p->position][s->p->dims[s->dims[k]]];
		double turn = round_up(r.lower + (double)TURN * (1 + 0x1p-48));

		s->lower[k] = r.lower;
		s->upper[k] = is_angle(s, k) && turn < r.upper ? turn : r.upper;
	}
}

/* How much outputs of the group are off between places h apart, over h^2, each by its weight. */
static double weight_of(const struct sampler *s, int k)
{
	double sum = 0;

	for (size_t i = 0; i < s->g->count; i++) {
		const struct peak *x = &s->p->list[s->g->members[i]];

		if (isfinite(x->bends[s->dims[k]]) && x->most > 0)
			sum += x->weight * x->bends[s->dims[k]] / x->most;
	}
	return sum;
}

/* Places where they gain most, in room for so many points. */
static double choose(struct sampler *s, double room)
{
	double size = 1, by[PEAKS_DIMS];

	for (int k = 0; k < s->dim_count; k++) {
		double h = s->upper[k] - s->lower[k];

		by[k] = weight_of(s, k) * h * h;
		size *= s->counts[k] = 2;
	}
	for (;;) {
		double best = 0;
		int at = -1;

		for (int k = 0; k < s->dim_count; k++) {
			double n = s->counts[k], gain = by[k] * (1 / ((n - 1) * (n - 1)) - 1 / (n * n)) / log((n + 1) / n);

			if (size * (n + 1) / n <= room && s->counts[k] < MOST_PLACES && gain > best) {
				best = gain;
				at = k;
			}
		}
		if (at < 0)
			return size;
		size *= (s->counts[at] + 1.0) / s->counts[at];
		s->counts[at]++;
	}
}

static int make_places(struct sampler *s)
{
	for (int k = 0; k < s->dim_count; k++) {
		double before = s->lower[k], most = 0;
		int n = s->counts[k];

		if (!(s->places[k] = arena_alloc(&s->arena, (size_t)n, sizeof *s->places[k])))
			return 0;
		for (int i = 0; i < n; i++) {
			double x = i == n - 1 ? s->upper[k] : fmin(s->upper[k], s->lower[k] + (s->upper[k] - s->lower[k]) * i / (n - 1));

			s->places[k][i][0] = x;
			s->places[k][i][1] = (double)sinl((real)x);
			s->places[k][i][2] = (double)cosl((real)x);
			most = fmax(most, round_up(x - before));
			before = x;
		}
		s->half[k] = 0.5 * most;
	}
	return 1;
}

/* Sums of four lanes, and of all coefficients. */
static double off_of(const struct sampler *s, const struct peak *k)
{
	double noise = s->p->noise[k->nodes[0]] + (k->pair ? s->p->noise[k->nodes[1]] : 0);

	return 8 * s->lanes * noise;
}

static void take_found(const struct sampler *s)
{
	for (size_t i = 0; i < s->g->count; i++) {
		struct peak *x = &s->p->list[s->g->members[i]];
		double slack = off_of(s, x), most;

		for (int k = 0; k < s->dim_count; k++)
			slack += s->half[k] * s->half[k] / 2 * x->bends[s->dims[k]];
		most = (s->found[i] + slack) * (1 + 0x1p-30) + DBL_MIN;
		if (most < x->most)
			x->most = most;
	}
}

/* On a few points first, to see how long they take. Returns as peaks_sample. */
static int rounds(struct sampler *s, double deadline)
{
	double pace = 0;

	for (int i = 0; i < 2; i++) {
		double start = seconds_now(), room = i ? 0.8 * (deadline - start) / pace : FIRST_POINTS;
		double size = choose(s, room);

		if (size > 2 * room || (i && size <= FIRST_POINTS))
			return 1;
		if (!make_places(s))
			return 0;
		memset(s->most, 0, (s->g->count + 1) * sizeof *s->most);
		memset(s->found, 0, (s->g->count + 1) * sizeof *s->found);
		if (!take_grid(s, size, deadline))
			return 1;
		take_found(s);
		pace = (seconds_now() - start) / size;
	}
	return 1;
}

int peaks_sample(struct peaks *p, const struct peaks_group *g, double deadline)
{
	struct sampler s = {.p = p, .g = g};
	int done;

	arena_init(&s.arena, NULL);
	set_dims(&s);
	done = list_all(&s);
	if (done)
		done = make_lanes(&s);
	if (done == 1) {
		set_ranges(&s);
		done = rounds(&s, deadline);
	}
	free(s.v);
	free(s.most);
	free(s.found);
	arena_free(&s.arena);
	return done != 0;
}
