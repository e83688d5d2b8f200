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

/* ---- samples side by side: one walk over the nodes for all of them ---- */

enum { SIDE = 8 };

struct side {
	double x[SIDE];
};

static void operate(struct side *x, enum op op, const struct side *a, const struct side *b, const struct side *c)
{
	switch (op) {
	case OP_NEG:
		for (int s = 0; s < SIDE; s++)
			x->x[s] = -a->x[s];
		break;
	case OP_ADD:
		for (int s = 0; s < SIDE; s++)
			x->x[s] = a->x[s] + b->x[s];
		break;
	case OP_SUB:
		for (int s = 0; s < SIDE; s++)
			x->x[s] = a->x[s] - b->x[s];
		break;
	case OP_MUL:
		for (int s = 0; s < SIDE; s++)
			x->x[s] = a->x[s] * b->x[s];
		break;
	default:
		for (int s = 0; s < SIDE; s++)
			x->x[s] = eval_operation(op, a->x[s], b->x[s], c->x[s]);
	}
}

/* What samples from this one on read; beyond the last one, it again. */
static void read(struct side *x, const struct dag *d, const struct node *n, const struct drawn *inputs, size_t sample)
{
	for (size_t s = 0; s < SIDE; s++) {
		size_t from = sample + s < inputs->samples ? sample + s : inputs->samples - 1;

		x->x[s] = n->op == OP_INPUT ? draw_rows(inputs, &d->arguments[n->arg[0].i], from)[n->arg[1].i] : (double)n->value;
	}
}

/* Torques of samples from this one on, by row. uses: dag_uses; v: room by node. */
static void torques(
	struct side *tau, const struct dag *d, const uint32_t *uses, struct side *v, const struct drawn *inputs, size_t sample)
{
	for (size_t i = 0; i < d->count; i++) {
		const struct node *n = &d->nodes[i];

		if (!uses[i])
			continue;
		if (n->op == OP_CONST || n->op == OP_INPUT)
			read(&v[i], d, n, inputs, sample);
		else
			operate(&v[i], n->op, &v[n->arg[0].i], &v[n->arg[1].i], &v[n->arg[2].i]);
	}
	for (size_t i = 0; i < d->output_count; i++)
		tau[d->outputs[i].row] = v[d->outputs[i].value.i];
}

static double share(double off, double size)
{
	return size > 0 ? off / size : 0;
}

/* What one sample is off is added to `whole`, and by row to the sums of squares. */
static void add_sample(
	struct accuracy *x, double *offs, double *sizes, const struct side *tau, int side, const real *reference, int rows)
{
	double off = 0, size = 0;

	for (int i = 0; i < rows; i++) {
		double ref = (double)reference[i], e = (double)((real)tau[i].x[side] - reference[i]);

		offs[i] += e * e;
		sizes[i] += ref * ref;
		off += e * e;
		size += ref * ref;
	}
	x->whole += share(off, size);
}

int accuracy_measure(
	struct accuracy *x, const struct dag *d, const struct drawn *inputs, const real *reference, struct arena *spare)
{
	int rows = rows_of(d);
	uint32_t *uses = arena_alloc(spare, d->count, sizeof *uses);
	struct side *v = arena_alloc(spare, d->count, sizeof *v), *tau = arena_alloc(spare, (size_t)rows, sizeof *tau);
	double *offs = arena_alloc(spare, (size_t)rows, sizeof *offs), *sizes = arena_alloc(spare, (size_t)rows, sizeof *sizes);

	*x = (struct accuracy){0};
	if (!uses || !v || !tau || !offs || !sizes)
		return 0;
	dag_uses(d, uses);
	for (size_t s = 0; s < inputs->samples; s++) {
		if (s % SIDE == 0)
			torques(tau, d, uses, v, inputs, s);
		add_sample(x, offs, sizes, tau, (int)(s % SIDE), reference + s * (size_t)rows, rows);
	}
	x->whole = sqrt(x->whole / (double)inputs->samples);
	for (int i = 0; i < rows; i++)
		x->each += share(offs[i], sizes[i]) / rows;
	x->each = sqrt(x->each);
	return 1;
}
