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

/* What one thread works in. */
struct room {
	double *state, *before, *out, *in[DAG_ARGUMENTS], *outs[DAG_ARGUMENTS];
};

static int room_make(struct room *r, const struct states *s)
{
	const struct dag *d = &s->a->dag;
	size_t outs = 0;

	for (int i = 0; i < d->argument_count; i++)
		outs += d->arguments[i].is_output ? (size_t)d->arguments[i].rows : 0;
	*r = (struct room){.state = calloc(s->size + 1, sizeof(double)), .before = calloc(s->size + 1, sizeof(double)),
		.out = calloc(outs + 1, sizeof(double))};
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

static void room_free(struct room *r)
{
	free(r->state);
	free(r->before);
	free(r->out);
}

static double value_at(struct seeking *k, struct room *r, size_t output)
{
	const struct output *o = &k->s->a->dag.outputs[output];

	k->failed |= !eval_f64(&k->s->a->dag, (const double *const *)r->in, r->outs, NULL);
	return r->outs[o->argument][o->row];
}

static double go_round(struct seeking *k, struct room *r, size_t output, int sign, double best, double step)
{
	const struct dag *d = &k->s->a->dag;

	for (int i = 0; i < d->argument_count; i++)
		for (int row = 0; row < d->arguments[i].rows && r->in[i]; row++) {
			double now;

			if (!states_is_free(k->s, i, row) || seconds_now() > k->deadline)
				continue;
			memcpy(r->before, r->state, k->s->size * sizeof *r->state);
			states_move(k->s, r->in, i, row, step);
			now = value_at(k, r, output);
			if (sign * now > sign * best)
				best = now;
			else
				memcpy(r->state, r->before, k->s->size * sizeof *r->state);
		}
	return best;
}

/* From the state that is there, and from another. */
static void seek_side(struct seeking *k, struct room *r, size_t output, int side, unsigned short seed[3])
{
	int sign = side ? 1 : -1;

	for (int start = 0; start < 2; start++) {
		double value, step = 0.17;

		if (start)
			states_draw(k->s, r->in, seed);
		else
			memcpy(r->state, k->best[output][side], k->s->size * sizeof *r->state);
		value = value_at(k, r, output);
		for (int round = 0; round < ROUNDS && seconds_now() < k->deadline; round++, step *= round % 2 ? -1 : -0.6)
			value = go_round(k, r, output, sign, value, step);
		if (start == 0 || sign * value > sign * k->values[output][side]) {
			k->values[output][side] = value;
			memcpy(k->best[output][side], r->state, k->s->size * sizeof *r->state);
		}
		if (seconds_now() > k->deadline)
			return;
	}
}

static void seek(void *job, size_t output)
{
	struct seeking *k = job;
	unsigned short seed[3] = {(unsigned short)output, 5, 23};
	struct room r;

	if (room_make(&r, k->s))
		for (int side = 0; side < 2; side++)
			seek_side(k, &r, output, side, seed);
	else
		k->failed = 1;
	room_free(&r);
}

int states_seek(const struct states *s, double (*values)[2], double *(*best)[2], const struct effort *x, double seconds)
{
	struct seeking k = {s, values, best, fmin(x->deadline, seconds_now() + seconds), 0};

	workers_run(x->workers, x->threads, seek, &k, s->a->dag.output_count);
	return !k.failed;
}
