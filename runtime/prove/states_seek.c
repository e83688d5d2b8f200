#define _POSIX_C_SOURCE 200809L
#define _XOPEN_SOURCE 700
#include "prove/states.h"
#include "core/seconds.h"
#include "dag/eval.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { ROUNDS = 24 };

struct seeking {
	const struct states *s;
	double (*values)[2], *(*best)[2];
	double deadline;
	int failed;
};

/* The value of an output, uphill or downhill. */
struct side {
	struct seeking *k;
	size_t output;
	int sign;
};

int states_room_make(struct states_room *r, const struct states *s)
{
	const struct dag *d = &s->a->dag;
	size_t outs = 0;

	for (int i = 0; i < d->argument_count; i++)
		outs += d->arguments[i].is_output ? (size_t)d->arguments[i].rows : 0;
	*r = (struct states_room){.state = calloc(s->size + 1, sizeof(double)), .before = calloc(s->size + 1, sizeof(double)),
		.out = calloc(outs + 1, sizeof(double)), .size = s->size * sizeof(double)};
	if (!r->state || !r->before || !r->out)
		return 0;
	states_point(s, r->state, r->in);
	outs = 0;
	for (int i = 0; i < d->argument_count; i++)
		if (d->arguments[i].is_output) {
			r->outs[i] = r->out + outs;
			outs += (size_t)d->arguments[i].rows;
		}
	return 1;
}

void states_room_free(struct states_room *r)
{
	free(r->state);
	free(r->before);
	free(r->out);
}

static double go_round(const struct states *s, struct states_room *r, const struct states_climb *c, double best, double step)
{
	const struct dag *d = &s->a->dag;

	for (int i = 0; i < d->argument_count; i++)
		for (int row = 0; row < d->arguments[i].rows && r->in[i]; row++) {
			double now;

			if (!states_is_free(s, i, row) || seconds_now() > c->deadline)
				continue;
			memcpy(r->before, r->state, r->size);
			states_move(s, r->in, i, row, step);
			if (c->fit)
				c->fit(c->context, r);
			now = c->value(c->context, r);
			if (now > best)
				best = now;
			else
				memcpy(r->state, r->before, r->size);
		}
	return best;
}

double states_climb(const struct states *s, struct states_room *r, const struct states_climb *c)
{
	double best = c->value(c->context, r), step = c->step;

	for (int round = 0; round < c->rounds && seconds_now() < c->deadline; round++, step *= round % 2 ? -1 : -0.6)
		best = go_round(s, r, c, best, step);
	return best;
}

static double value_at(void *context, struct states_room *r)
{
	const struct side *side = context;
	const struct dag *d = &side->k->s->a->dag;
	const struct output *o = &d->outputs[side->output];

	side->k->failed |= !eval_f64(d, (const double *const *)r->in, r->outs, NULL);
	return side->sign * r->outs[o->argument][o->row];
}

/* From the state that is there, and from another. */
static void seek_side(struct seeking *k, struct states_room *r, size_t output, int side, unsigned short seed[3])
{
	struct side of = {k, output, side ? 1 : -1};
	const struct states_climb c = {value_at, NULL, &of, 0.17, ROUNDS, k->deadline};

	for (int start = 0; start < 2; start++) {
		double value;

		if (start)
			states_draw(k->s, r->in, seed);
		else
			memcpy(r->state, k->best[output][side], r->size);
		value = states_climb(k->s, r, &c);
		if (start == 0 || value > of.sign * k->values[output][side]) {
			k->values[output][side] = of.sign * value;
			memcpy(k->best[output][side], r->state, r->size);
		}
		if (seconds_now() > k->deadline)
			return;
	}
}

static void seek(void *job, size_t output)
{
	struct seeking *k = job;
	unsigned short seed[3] = {(unsigned short)output, 5, 23};
	struct states_room r;

	if (states_room_make(&r, k->s))
		for (int side = 0; side < 2; side++)
			seek_side(k, &r, output, side, seed);
	else
		k->failed = 1;
	states_room_free(&r);
}

int states_seek(const struct states *s, double (*values)[2], double *(*best)[2], const struct effort *x, double seconds)
{
	struct seeking k = {s, values, best, fmin(x->deadline, seconds_now() + seconds), 0};

	workers_run(x->workers, x->threads, seek, &k, s->a->dag.output_count);
	return !k.failed;
}
