#include "passes/accuracy.h"
#include "dag/eval.h"
#include <math.h>

struct measure {
	const struct dag *d;
	int rows;
	double *tau, *off, *size; /* of one sample; by row, summed squares */
	real *in[3], *ref;
};

/* One sample both ways. */
static int both(const struct measure *m, const struct drawn *inputs, size_t sample)
{
	const double *in[DAG_ARGUMENTS] = {NULL};
	double *out[DAG_ARGUMENTS] = {NULL};
	const real *wide_in[DAG_ARGUMENTS] = {NULL};
	real *wide_out[DAG_ARGUMENTS] = {NULL};

	for (int k = 0; k < m->d->argument_count; k++) {
		const struct argument *x = &m->d->arguments[k];

		if (x->is_output) {
			out[k] = m->tau;
			wide_out[k] = m->ref;
			continue;
		}
		in[k] = draw_rows(inputs, x, sample);
		for (int i = 0; i < x->rows; i++)
			m->in[k][i] = (real)in[k][i];
		wide_in[k] = m->in[k];
	}
	return eval_f64(m->d, in, out, NULL) && eval_real(m->d, wide_in, wide_out, NULL);
}

static double share(double off, double size)
{
	return size > 0 ? off / size : 0;
}

static int alloc(struct measure *m, struct arena *a)
{
	for (int k = 0; k < m->d->argument_count; k++) {
		size_t rows = (size_t)m->d->arguments[k].rows;

		if (m->d->arguments[k].is_output) {
			m->rows = m->d->arguments[k].rows;
			m->tau = arena_alloc(a, 3 * rows, sizeof *m->tau);
			m->ref = arena_alloc(a, rows, sizeof *m->ref);
			m->off = m->tau + rows;
			m->size = m->off + rows;
		} else {
			m->in[k] = arena_alloc(a, rows, sizeof *m->in[k]);
		}
	}
	return !a->failed;
}

int accuracy_measure(struct accuracy *x, const struct dag *d, const struct drawn *inputs, struct arena *spare)
{
	struct measure m = {.d = d};

	*x = (struct accuracy){0};
	if (!alloc(&m, spare))
		return 0;
	for (size_t s = 0; s < inputs->samples; s++) {
		double off = 0, size = 0;

		if (!both(&m, inputs, s))
			return 0;
		for (int i = 0; i < m.rows; i++) {
			double ref = (double)m.ref[i], e = (double)((real)m.tau[i] - m.ref[i]);

			m.off[i] += e * e;
			m.size[i] += ref * ref;
			off += e * e;
			size += ref * ref;
		}
		x->whole += share(off, size) / (double)inputs->samples;
	}
	x->whole = sqrt(x->whole);
	for (int i = 0; i < m.rows; i++)
		x->each += share(m.off[i], m.size[i]) / m.rows;
	x->each = sqrt(x->each);
	return 1;
}
