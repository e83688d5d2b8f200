#define _POSIX_C_SOURCE 200809L
#define _XOPEN_SOURCE 700
#include "prove/seek_errors.h"
#include "core/seconds.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* A state, by the DAG's arguments, and what comes of it. */
struct trial {
	double *in[DAG_ARGUMENTS], *out[DAG_ARGUMENTS], *before;
};

struct seeking {
	const struct analysis *a;
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

/* ---- states ---- */

static int trial_new(struct trial *t, const struct states *s)
{
	const struct dag *d = &s->a->dag;
	int done;

	*t = (struct trial){.before = calloc(s->size + 1, sizeof *t->before)};
	done = t->before != NULL;
	for (int i = 0; i < d->argument_count; i++) {
		double *rows = calloc((size_t)d->arguments[i].rows + 1, sizeof *rows);

		*(d->arguments[i].is_output ? &t->out[i] : &t->in[i]) = rows;
		done &= rows != NULL;
	}
	return done;
}

static void trial_free(struct trial *t)
{
	free(t->before);
	for (int i = 0; i < DAG_ARGUMENTS; i++) {
		free(t->in[i]);
		free(t->out[i]);
	}
}

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

static void fit_all(const struct seeking *s, struct trial *t, int is_float)
{
	for (int i = 0; i < s->d->argument_count; i++)
		for (int r = 0; r < s->d->arguments[i].rows && t->in[i]; r++)
			if (s->b->rows[i][r].lower <= s->b->rows[i][r].upper)
				t->in[i][r] = fit(s->b->rows[i][r], t->in[i][r], is_float);
}

/* ---- uphill ---- */

static double bound_at(struct seeking *s, struct trial *t, const struct eval_model *m, size_t output)
{
	const struct output *o = &s->d->outputs[output];

	if (!eval_bound(s->d, m, (const double *const *)t->in, t->out))
		s->failed = 1;
	return isfinite(t->out[o->argument][o->row]) ? t->out[o->argument][o->row] : 0;
}

static void keep(const struct seeking *s, struct trial *t)
{
	for (int i = 0; i < s->d->argument_count; i++)
		if (t->in[i])
			memcpy(t->before + s->states.at[i], t->in[i], (size_t)s->d->arguments[i].rows * sizeof *t->before);
}

static void put_back(const struct seeking *s, struct trial *t)
{
	for (int i = 0; i < s->d->argument_count; i++)
		if (t->in[i])
			memcpy(t->in[i], t->before + s->states.at[i], (size_t)s->d->arguments[i].rows * sizeof *t->before);
}

static double climb(struct seeking *s, struct trial *t, int model, size_t output, int rounds)
{
	const struct eval_model *m = &s->models[model];
	int is_float = has_floats(m);
	double best = bound_at(s, t, m, output), step = 0.11;

	for (int round = 0; round < rounds; round++, step *= round % 2 ? -1 : -0.6)
		for (int i = 0; i < s->d->argument_count; i++)
			for (int r = 0; r < s->d->arguments[i].rows && t->in[i]; r++) {
				double now;

				if (!(s->b->rows[i][r].lower < s->b->rows[i][r].upper) || seconds_now() > s->deadline)
					continue;
				keep(s, t);
				states_move(&s->states, t->in, i, r, step);
				fit_all(s, t, is_float);
				now = bound_at(s, t, m, output);
				if (now > best)
					best = now;
				else
					put_back(s, t);
			}
	return best;
}

static void take_model(struct seeking *s, struct trial *t, int model, double *best)
{
	const struct eval_model *m = &s->models[model];

	if (!eval_bound(s->d, m, (const double *const *)t->in, t->out))
		s->failed = 1;
	for (size_t o = 0; o < s->d->output_count; o++) {
		double x = t->out[s->d->outputs[o].argument][s->d->outputs[o].row];

		if (isfinite(x))
			best[o * PROVE_PRECISIONS + (size_t)model] = fmax(best[o * PROVE_PRECISIONS + (size_t)model], x);
	}
}

/* A state that is bad for a type is so for others too, and is one of theirs where it is of floats, or they are of doubles. */
static void take(struct seeking *s, struct trial *t, int model, double *best)
{
	for (int k = 0; k < s->count; k++)
		if (k == model || has_floats(&s->models[model]) || !has_floats(&s->models[k]))
			take_model(s, t, k, best);
}

static void take_found(const struct seeking *s, const double *state, struct trial *t)
{
	for (int i = 0; i < s->d->argument_count; i++)
		if (t->in[i])
			memcpy(t->in[i], state + s->states.at[i], (size_t)s->d->arguments[i].rows * sizeof *state);
}

/* The numbers of a job go through outputs, models, and starts: twice the states found, then others. */
static void seek(void *job, size_t piece)
{
	struct seeking *s = job;
	double *best = s->best + piece * s->d->output_count * PROVE_PRECISIONS;
	unsigned short seed[3] = {(unsigned short)piece, 7, 19};
	struct trial t;
	int done = trial_new(&t, &s->states);

	for (int model = 0; model < s->count && done; model++) {
		states_draw(&s->states, t.in, seed);
		fit_all(s, &t, has_floats(&s->models[model]));
		take(s, &t, model, best);
	}
	for (size_t i = piece; done && !s->failed && seconds_now() < s->deadline; i += s->pieces) {
		size_t output = i % s->d->output_count;
		int model = (int)(i / s->d->output_count) % s->count, start = (int)(i / s->d->output_count) / s->count;
		const struct eval_model *m = &s->models[model];

		states_draw(&s->states, t.in, seed);
		if (start < 2)
			take_found(s, s->found[output][start], &t);
		fit_all(s, &t, has_floats(m));
		take(s, &t, model, best);
		climb(s, &t, model, output, 8);
		take(s, &t, model, best);
	}
	s->failed |= !done;
	trial_free(&t);
}

int seek_errors(struct prove_row *rows, const struct analysis *a, const struct box *b, const struct eval_model *models, int count,
	double *const (*found)[2], const struct effort *x, double seconds)
{
	struct seeking s = {.a = a, .d = &a->dag, .b = b, .models = models, .count = count, .found = found,
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
				rows[o].error_found[k] = fmax(rows[o].error_found[k], s.best[p * size + o * PROVE_PRECISIONS + (size_t)k]);
	free(s.best);
	return !s.failed;
}
