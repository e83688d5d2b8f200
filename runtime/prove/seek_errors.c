#define _POSIX_C_SOURCE 200809L
#define _XOPEN_SOURCE 700
#include "prove/seek_errors.h"
#include "core/seconds.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { ROUNDS = 7, MORE_ROUNDS = 28, FRESH = 4, OTHERS = 4 };
#define STEP 0.11
#define SHAKEN 0.25 /* of the rows, where a climb begins anew near the best so far */

struct seeking {
	const struct dag *d;
	const struct box *b;
	const struct eval_model *models;
	int count;
	struct states states;
	double *const (*found)[2];
	double deadline, *best; /* [piece][output][model] */
	size_t pieces;
	int failed;
};

/* The bound of one output in one model. */
struct sought_bound {
	struct seeking *s;
	const struct eval_model *m;
	size_t output;
	int is_float;
};

/* By output and model, where a climb has come to so far. */
struct top {
	double value, *state;
};

/* ---- states ---- */

/* Within the range, and a number that the text's memory has where the range has one. */
static double fit(struct interval r, double x, int is_float)
{
	double y;

	x = fmin(r.upper, fmax(r.lower, x));
	y = is_float ? (double)(float)x : x;
	if (y > r.upper)
		y = (double)nextafterf((float)y, -INFINITY);
	if (y < r.lower)
		y = (double)nextafterf((float)y, INFINITY);
	return y >= r.lower && y <= r.upper ? y : x;
}

/* Are numbers in memory floats? Those of f32x2 are rounded when they are read. */
static int has_floats(const struct eval_model *m)
{
	return m->input == 0 && (m->store_largest < 1e300 || m->largest < 1e300);
}

static void fit_all(const struct seeking *s, const struct states_room *t, int is_float)
{
	for (int i = 0; i < s->d->argument_count; i++)
		for (int r = 0; r < s->d->arguments[i].rows && t->in[i]; r++)
			if (s->b->rows[i][r].lower <= s->b->rows[i][r].upper)
				t->in[i][r] = fit(s->b->rows[i][r], t->in[i][r], is_float);
}

/* ---- uphill ---- */

static void fit_state(void *context, struct states_room *t)
{
	const struct sought_bound *b = context;

	fit_all(b->s, t, b->is_float);
}

static double bound_at(void *context, struct states_room *t)
{
	const struct sought_bound *b = context;
	const struct output *o = &b->s->d->outputs[b->output];
	struct dag alone = *b->s->d; /* other outputs take time */

	alone.outputs += b->output;
	alone.output_count = 1;
	if (!eval_bound(&alone, b->m, (const double *const *)t->in, t->outs))
		b->s->failed = 1;
	return isfinite(t->outs[o->argument][o->row]) ? t->outs[o->argument][o->row] : 0;
}

static void take_model(struct seeking *s, struct states_room *t, int model, double *best)
{
	const struct eval_model *m = &s->models[model];

	if (!eval_bound(s->d, m, (const double *const *)t->in, t->outs))
		s->failed = 1;
	for (size_t o = 0; o < s->d->output_count; o++) {
		double x = t->outs[s->d->outputs[o].argument][s->d->outputs[o].row];

		if (isfinite(x))
			best[o * PROVE_PRECISIONS + (size_t)model] = fmax(best[o * PROVE_PRECISIONS + (size_t)model], x);
	}
}

/* A state that is bad for a type is so for others too, and is one of theirs where it is of floats, or they are of doubles. */
static void take(struct seeking *s, struct states_room *t, int model, double *best)
{
	for (int k = 0; k < s->count; k++)
		if (k == model || has_floats(&s->models[model]) || !has_floats(&s->models[k]))
			take_model(s, t, k, best);
}

/* Some rows of it, anywhere. */
static void shake(const struct states *s, const struct states_room *t, unsigned short seed[3])
{
	for (int i = 0; i < s->a->dag.argument_count; i++)
		for (int r = 0; r < s->a->dag.arguments[i].rows && t->in[i]; r++)
			if (states_is_free(s, i, r) && erand48(seed) < SHAKEN)
				states_move(s, t->in, i, r, erand48(seed) - 0.5);
}

static void put_start(const struct seeking *s, struct states_room *t, const struct top *top, size_t output, int start,
	unsigned short seed[3])
{
	states_draw(&s->states, t->in, seed);
	if (start < 2)
		memcpy(t->state, s->found[output][start], t->size);
	if (start < FRESH || start % 3 == 0 || !(top->value > 0))
		return;
	memcpy(t->state, top->state, t->size);
	shake(&s->states, t, seed);
}

/* From what is in the room. */
static void climb(struct seeking *s, struct states_room *t, struct top *top, size_t output, int model, int rounds, double *best)
{
	struct sought_bound of = {s, &s->models[model], output, has_floats(&s->models[model])};
	double value;

	fit_all(s, t, of.is_float);
	take(s, t, model, best);
	value = states_climb(&s->states, t, &(struct states_climb){bound_at, fit_state, &of, STEP, rounds, s->deadline});
	take(s, t, model, best);
	if (value > top->value) {
		top->value = value;
		memcpy(top->state, t->state, t->size);
	}
}

/* What is bad for one type is nearly so for the others: one of some climbs goes on from there for these. tops[]
   are the output's. */
static void climb_for(struct seeking *s, struct states_room *t, struct top *tops, size_t output, int start,
	unsigned short seed[3], double *best)
{
	int model = s->count > 1 && start % OTHERS == OTHERS - 1 ? 1 + start / OTHERS % (s->count - 1) : 0;

	if (model && tops->value > 0)
		memcpy(t->state, tops->state, t->size);
	else
		put_start(s, t, &tops[model], output, start, seed);
	climb(s, t, &tops[model], output, model, start < FRESH ? ROUNDS : MORE_ROUNDS, best);
}

/* In one block. */
static struct top *tops_new(const struct seeking *s)
{
	size_t count = s->d->output_count * (size_t)s->count, rows = s->states.size + 1;
	struct top *tops = calloc(count, sizeof *tops);
	double *states = calloc(count * rows, sizeof *states);

	for (size_t i = 0; tops && states && i < count; i++)
		tops[i].state = states + i * rows;
	if (tops && states)
		return tops;
	free(tops);
	free(states);
	return NULL;
}

/* The numbers of a job go through outputs and starts: twice the states found, then others, some of them near the best so far. */
static void seek(void *job, size_t piece)
{
	struct seeking *s = job;
	double *best = s->best + piece * s->d->output_count * PROVE_PRECISIONS;
	unsigned short seed[3] = {(unsigned short)piece, 7, 19};
	struct states_room t;
	struct top *tops = tops_new(s);
	int done = states_room_make(&t, &s->states) && tops;

	for (int model = 0; model < s->count && done; model++) {
		states_draw(&s->states, t.in, seed);
		fit_all(s, &t, has_floats(&s->models[model]));
		take(s, &t, model, best);
	}
	for (size_t i = piece; done && !s->failed && seconds_now() < s->deadline; i += s->pieces) {
		size_t output = i % s->d->output_count;

		climb_for(s, &t, &tops[output * (size_t)s->count], output, (int)(i / s->d->output_count), seed, best);
	}
	s->failed |= !done;
	free(tops ? tops->state : NULL);
	free(tops);
	states_room_free(&t);
}

int seek_errors(struct prove_row *rows, const struct analysis *a, const struct box *b, const struct eval_model *models, int count,
	double *const (*found)[2], const struct effort *x, double seconds)
{
	struct seeking s = {.d = &a->dag, .b = b, .models = models, .count = count, .found = found,
		.deadline = fmin(x->deadline, seconds_now() + seconds), .pieces = x->threads};
	size_t size = s.d->output_count * PROVE_PRECISIONS;

	states_of(&s.states, a, b);
	s.best = calloc(s.pieces * size, sizeof *s.best);
	if (!s.best)
		return 0;
	workers_run(x->workers, x->threads, seek, &s, s.pieces);
	for (size_t p = 0; p < s.pieces; p++)
		for (size_t o = 0; o < s.d->output_count; o++)
			for (int k = 0; k < count; k++)
				rows[o].error_found[k] = fmax(
					rows[o].error_found[k], s.best[p * size + o * PROVE_PRECISIONS + (size_t)k]);
	free(s.best);
	return !s.failed;
}
