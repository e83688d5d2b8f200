/* A value at q is a polynomial of drives and rates x = middle + half t, t from -1 to 1; its coefficients follow from
   its values at a few t, the lanes, and the sum of their magnitudes is no smaller than any of its values; so with
   lengths, where two values go together. */
#define _POSIX_C_SOURCE 200809L
#include "peaks/peaks_points.h"
#include "peaks/peaks_lanes.h"
#include "core/seconds.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* WIDTH: lanes of all points that are looked at together, where one point has fewer. */
enum { WIDTH = 64, MOST_LANES = 512, LOOK_EVERY = 16 };

/* A sine, a cosine or a length of a row of q. */
struct place_input {
	uint32_t slot;
	int dim, of; /* number among the group's rows; of a place */
};

struct peaks_points {
	const struct peaks *p;
	const struct peaks_group *g;
	int dims[PEAKS_DIMS], dim_count; /* of p->dims */
	unsigned char *live;
	uint32_t *slot, *drives, *rates; /* slot: by node; nodes of drives and rates */
	int drive_count, rate_count;
	struct lanes_step *steps;
	size_t step_count, slot_count;
	struct place_input *inputs;
	size_t input_count;
	int lanes, points;	/* of a point; at once */
	int at[PEAKS_DIMS];	/* numbers of the next point's places */
	size_t width;		/* vectors */
	lanes_vector *v, *most; /* most: by member, of squares where there is one lane */
	struct arena arena;
};

/* ---- what is evaluated ---- */

static const struct node *node_at(const struct peaks_points *t, uint32_t i)
{
	return &t->p->x->d.nodes[i];
}

static struct interval range_of(const struct peaks_points *t, const struct node *n)
{
	return t->p->rows[n->arg[0].i][n->arg[1].i];
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

static double *lanes_at(const struct peaks_points *t, uint32_t node)
{
	return (double *)(t->v + t->slot[node] * t->width);
}

static void fill(const struct peaks_points *t, uint32_t node, double x)
{
	for (size_t i = 0; i < t->width * LANES_VECTOR; i++)
		lanes_at(t, node)[i] = x;
}

static int dim_at(const struct peaks_points *t, const struct node *n)
{
	for (int k = 0; k < t->dim_count && (int)n->arg[0].i == t->p->position; k++)
		if (t->p->dims[t->dims[k]] == (int)n->arg[1].i)
			return k;
	return -1;
}

/* The input of which it is a sine or cosine, or itself. */
static const struct node *input_of(const struct peaks_points *t, const struct node *n)
{
	return op_arity[n->op] ? node_at(t, n->arg[0].i) : n;
}

/* By a row of q, which is fixed or has places; or a drive or a rate, whose lanes come later. */
static void list_leaf(struct peaks_points *t, uint32_t i)
{
	const struct node *n = node_at(t, i), *q = input_of(t, n);

	if (dim_at(t, q) >= 0)
		t->inputs[t->input_count++] = (struct place_input){t->slot[i], dim_at(t, q),
			n->op == OP_SIN	  ? 1
			: n->op == OP_COS ? 2
					  : 0};
	else if ((int)q->arg[0].i != t->p->position)
		*(t->p->x->d.arguments[q->arg[0].i].role == ROLE_JOINT_VELOCITY ? &t->rates[t->rate_count++]
										: &t->drives[t->drive_count++]) = i;
}

static void list_node(struct peaks_points *t, uint32_t i)
{
	const struct node *n = node_at(t, i);

	t->slot[i] = (uint32_t)t->slot_count++;
	if (n->op == OP_INPUT || n->op == OP_SIN || n->op == OP_COS)
		list_leaf(t, i);
	else if (n->op != OP_CONST)
		t->steps[t->step_count++] = (struct lanes_step){
			n->op, t->slot[i], t->slot[n->arg[0].i], op_arity[n->op] > 1 ? t->slot[n->arg[1].i] : 0};
}

static int list_all(struct peaks_points *t)
{
	size_t count = t->p->x->d.count;

	t->live = arena_alloc(&t->arena, count, 1);
	t->slot = arena_alloc(&t->arena, count, sizeof *t->slot);
	t->drives = arena_alloc(&t->arena, count, sizeof *t->drives);
	t->rates = arena_alloc(&t->arena, count, sizeof *t->rates);
	t->steps = arena_alloc(&t->arena, count, sizeof *t->steps);
	t->inputs = arena_alloc(&t->arena, count, sizeof *t->inputs);
	if (t->arena.failed)
		return 0;
	for (size_t i = 0; i < t->g->count; i++)
		for (int k = 0; k < 2; k++)
			t->live[t->p->list[t->g->members[i]].nodes[k]] = 1;
	dag_mark_operands(&t->p->x->d, count, t->live);
	for (uint32_t i = 0; i < count; i++)
		if (t->live[i])
			list_node(t, i);
	return 1;
}

/* ---- lanes ---- */

static int lanes_of(const struct peaks_points *t)
{
	int n = t->rate_count;

	if (t->g->kind == PEAK_PLAIN)
		return 1;
	return t->g->kind == PEAK_LINEAR ? (n ? n : 1) : 1 + t->drive_count + 2 * n + n * (n - 1) / 2;
}

/* An input at t, in one lane of each point. */
static void put_lane(const struct peaks_points *t, uint32_t node, int lane, double x)
{
	struct interval r = range_of(t, node_at(t, node));

	for (int p = 0; p < t->points; p++)
		lanes_at(t, node)[p * t->lanes + lane] = middle_of(r) + x * half_of(r);
}

/* The middle of all; each drive; each rate, forth and back; each pair of rates. Of what is linear: each rate. */
static void put_lanes(const struct peaks_points *t)
{
	int lane = t->g->kind == PEAK_LINEAR ? 0 : 1, n = t->rate_count;

	for (int i = 0; i < t->drive_count; i++)
		fill(t, t->drives[i], middle_of(range_of(t, node_at(t, t->drives[i]))));
	for (int j = 0; j < n; j++)
		fill(t, t->rates[j], middle_of(range_of(t, node_at(t, t->rates[j]))));
	for (int i = 0; i < t->drive_count; i++)
		put_lane(t, t->drives[i], lane++, 1);
	for (int j = 0; j < n; j++)
		put_lane(t, t->rates[j], lane++, 1);
	for (int j = 0; j < n && t->g->kind == PEAK_FULL; j++)
		put_lane(t, t->rates[j], lane++, -1);
	for (int j = 0; j < n && t->g->kind == PEAK_FULL; j++)
		for (int k = j + 1; k < n; k++, lane++) {
			put_lane(t, t->rates[j], lane, 1);
			put_lane(t, t->rates[k], lane, 1);
		}
}

/* What never changes: constants, and rows of q that are fixed. */
static void put_constants(const struct peaks_points *t)
{
	for (uint32_t i = 0; i < t->p->x->d.count; i++) {
		const struct node *n = node_at(t, i), *q = input_of(t, n);
		real x;

		if (t->live[i] && n->op == OP_CONST)
			fill(t, i, (double)n->value);
		if (!t->live[i] || q->op != OP_INPUT || (int)q->arg[0].i != t->p->position || dim_at(t, q) >= 0 ||
			(n->op != OP_INPUT && n->op != OP_SIN && n->op != OP_COS))
			continue;
		x = (real)range_of(t, q).lower;
		fill(t, i, (double)(n->op == OP_SIN ? sinl(x) : n->op == OP_COS ? cosl(x) : x));
	}
}

/* Returns 0 when memory runs out. */
static int make_lanes(struct peaks_points *t)
{
	size_t of_slots;

	t->points = t->lanes >= WIDTH ? 1 : WIDTH / t->lanes;
	t->width = ((size_t)(t->points * t->lanes) + LANES_VECTOR - 1) / LANES_VECTOR;
	of_slots = t->slot_count * t->width * sizeof(lanes_vector);
	t->v = aligned_alloc(sizeof(lanes_vector), of_slots);
	t->most = aligned_alloc(sizeof(lanes_vector), (t->g->count + 1) * sizeof(lanes_vector));
	if (!t->v || !t->most)
		return 0;
	memset(t->v, 0, of_slots);
	put_constants(t);
	put_lanes(t);
	return 1;
}

struct peaks_points *peaks_points_new(const struct peaks *p, const struct peaks_group *g, int *is_large)
{
	struct peaks_points *t = calloc(1, sizeof *t);

	*is_large = 0;
	if (!t)
		return NULL;
	t->p = p;
	t->g = g;
	arena_init(&t->arena, NULL);
	for (int k = 0; k < p->dim_count; k++)
		if (g->dims >> k & 1)
			t->dims[t->dim_count++] = k;
	if (list_all(t)) {
		t->lanes = lanes_of(t);
		*is_large = t->lanes > MOST_LANES;
		if (*is_large || make_lanes(t))
			return t;
	}
	peaks_points_free(t);
	return NULL;
}

void peaks_points_free(struct peaks_points *t)
{
	if (!t)
		return;
	free(t->v);
	free(t->most);
	arena_free(&t->arena);
	free(t);
}

/* ---- at points ---- */

static double length_of(const struct peaks_points *t, const double *a, const double *b)
{
	double c[2][MOST_LANES], lengths[MOST_LANES], sums[4] = {0};
	int i = 0;

	if (t->g->kind == PEAK_FULL) {
		lanes_coefficients(t->drive_count, t->rate_count, a, c[0]);
		if (b)
			lanes_coefficients(t->drive_count, t->rate_count, b, c[1]);
		a = c[0];
		b = b ? c[1] : NULL;
	}
	lanes_lengths(t->lanes, a, b, lengths);
	for (; i + 4 <= t->lanes; i += 4)
		for (int k = 0; k < 4; k++)
			sums[k] += lengths[i + k];
	for (; i < t->lanes; i++)
		sums[0] += lengths[i];
	return sums[0] + sums[1] + sums[2] + sums[3];
}

static void take_members(struct peaks_points *t, double *found)
{
	for (size_t i = 0; i < t->g->count; i++) {
		const struct peak *k = &t->p->list[t->g->members[i]];
		const double *a = lanes_at(t, k->nodes[0]), *b = k->pair ? lanes_at(t, k->nodes[1]) : NULL;

		if (t->lanes == 1) {
			lanes_squares(t->width, (const lanes_vector *)a, (const lanes_vector *)b, &t->most[i]);
			continue;
		}
		for (int p = 0; p < t->points; p++)
			found[i] = fmax(found[i], length_of(t, a + p * t->lanes, b ? b + p * t->lanes : NULL));
	}
}

/* The next one of the grid; the first row of q goes fastest. */
static void advance(struct peaks_points *t, const int *counts)
{
	for (int k = 0; k < t->dim_count; k++) {
		if (++t->at[k] < counts[k])
			return;
		t->at[k] = 0;
	}
}

static void put_point(const struct peaks_points *t, peaks_place *const *places, int point)
{
	for (size_t i = 0; i < t->input_count; i++) {
		const struct place_input *in = &t->inputs[i];
		double *to = (double *)(t->v + in->slot * t->width) + point * t->lanes;

		for (int l = 0; l < t->lanes; l++)
			to[l] = places[in->dim][t->at[in->dim]][in->of];
	}
}

int peaks_points_take(
	struct peaks_points *t, const int *counts, peaks_place *const *places, double *found, double deadline)
{
	size_t points = 1;

	for (int k = 0; k < t->dim_count; k++)
		points *= (size_t)counts[k];
	memset(t->most, 0, (t->g->count + 1) * sizeof *t->most);
	memset(found, 0, t->g->count * sizeof *found);
	memset(t->at, 0, sizeof t->at);
	for (size_t i = 0; i < points; i += (size_t)t->points) {
		for (int p = 0; p < t->points; p++) {
			put_point(t, places, p);
			if (i + (size_t)p + 1 < points)
				advance(t, counts);
		}
		lanes_run(t->steps, t->step_count, t->width, t->v);
		take_members(t, found);
		if (i / (size_t)t->points % LOOK_EVERY == 0 && seconds_now() > deadline)
			return 0;
	}
	for (size_t i = 0; i < t->g->count && t->lanes == 1; i++)
		for (int k = 0; k < LANES_VECTOR; k++)
			found[i] = fmax(found[i], sqrt(t->most[i][k]));
	return 1;
}

/* Coefficients are sums of four lanes at most. */
double peaks_points_off(const struct peaks_points *t, size_t member)
{
	const struct peak *k = &t->p->list[t->g->members[member]];

	return 8 * t->lanes * (t->p->noise[k->nodes[0]] + (k->pair ? t->p->noise[k->nodes[1]] : 0));
}
