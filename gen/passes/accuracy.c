#include "passes/accuracy.h"
#include "dag/eval.h"
#include <math.h>

static int rows_of(const struct dag *d)
{
	for (int k = 0; k < d->argument_count; k++)
		if (d->arguments[k].is_output)
			return d->arguments[k].rows;
	return 0;
}

real *accuracy_reference(const struct dag *d, const struct drawn *inputs, struct arena *a)
{
	size_t rows = (size_t)rows_of(d);
	real *tau = arena_alloc(a, inputs->samples * rows, sizeof *tau), *wide[DAG_ARGUMENTS] = {NULL};

	for (int k = 0; k < d->argument_count && tau; k++)
		if (!d->arguments[k].is_output)
			wide[k] = arena_alloc(a, (size_t)d->arguments[k].rows, sizeof *wide[k]);
	for (size_t s = 0; s < inputs->samples && !a->failed; s++) {
		const real *in[DAG_ARGUMENTS] = {NULL};
		real *out[DAG_ARGUMENTS] = {NULL};

		for (int k = 0; k < d->argument_count; k++) {
			const double *x = draw_rows(inputs, &d->arguments[k], s);

			for (int i = 0; x && i < d->arguments[k].rows; i++)
				wide[k][i] = (real)x[i];
			in[k] = wide[k];
			out[k] = d->arguments[k].is_output ? tau + s * rows : NULL;
		}
		if (!eval_real(d, in, out, NULL))
			return NULL;
	}
	return a->failed ? NULL : tau;
}

/* One sample. */
static int torques(const struct dag *d, const struct drawn *inputs, size_t sample, double *tau)
{
	const double *in[DAG_ARGUMENTS] = {NULL};
	double *out[DAG_ARGUMENTS] = {NULL};

	for (int k = 0; k < d->argument_count; k++) {
		in[k] = draw_rows(inputs, &d->arguments[k], sample);
		out[k] = d->arguments[k].is_output ? tau : NULL;
	}
	return eval_f64(d, in, out, NULL);
}

static double share(double off, double size)
{
	return size > 0 ? off / size : 0;
}

int accuracy_measure(
	struct accuracy *x, const struct dag *d, const struct drawn *inputs, const real *reference, struct arena *spare)
{
	int rows = rows_of(d);
	/* of one sample; by row, summed squares */
	double *tau = arena_alloc(spare, 3 * (size_t)rows, sizeof *tau), *offs = tau ? tau + rows : NULL,
	       *sizes = tau ? offs + rows : NULL;

	*x = (struct accuracy){0};
	for (size_t s = 0; s < inputs->samples; s++, reference += rows) {
		double off = 0, size = 0;

		if (!tau || !torques(d, inputs, s, tau))
			return 0;
		for (int i = 0; i < rows; i++) {
			double ref = (double)reference[i], e = (double)((real)tau[i] - reference[i]);

			offs[i] += e * e;
			sizes[i] += ref * ref;
			off += e * e;
			size += ref * ref;
		}
		x->whole += share(off, size) / (double)inputs->samples;
	}
	x->whole = sqrt(x->whole);
	for (int i = 0; i < rows; i++)
		x->each += share(offs[i], sizes[i]) / rows;
	x->each = sqrt(x->each);
	return 1;
}
