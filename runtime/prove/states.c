#define _XOPEN_SOURCE 700
#include "prove/states.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

void states_of(struct states *s, const struct analysis *a, const struct box *b)
{
	*s = (struct states){.a = a, .b = b};
	for (int i = 0; i < a->dag.argument_count; i++) {
		s->at[i] = s->size;
		if (!a->dag.arguments[i].is_output)
			s->size += (size_t)a->dag.arguments[i].rows;
	}
}

void states_point(const struct states *s, double *state, double **in)
{
	for (int i = 0; i < s->a->dag.argument_count; i++)
		in[i] = s->a->dag.arguments[i].is_output ? NULL : state + s->at[i];
}

static int has_range(const struct states *s, int argument, int row)
{
	return s->b->rows[argument] && s->b->rows[argument][row].lower <= s->b->rows[argument][row].upper;
}

int states_is_free(const struct states *s, int argument, int row)
{
	return s->b->rows[argument] && s->b->rows[argument][row].lower < s->b->rows[argument][row].upper;
}

static void settle_quaternion(double *q)
{
	double size = sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);

	for (int i = 0; i < 4; i++)
		q[i] = size > 1e-3 ? q[i] / size : i == 3;
}

void states_settle(const struct states *s, double *const *in)
{
	const struct tree *t = &s->a->tree;
	int position = dag_find_role(&s->a->dag, ROLE_JOINT_POSITION, 0);

	for (int i = 0; i < s->a->dag.argument_count; i++)
		for (int r = 0; r < s->a->dag.arguments[i].rows && in[i]; r++)
			if (has_range(s, i, r))
				in[i][r] = fmin(s->b->rows[i][r].upper, fmax(s->b->rows[i][r].lower, in[i][r]));
	for (int i = 0; i < t->joint_count && position >= 0; i++)
		if (t->joints[i].type == JOINT_FLOATING)
			settle_quaternion(in[position] + t->joints[i].iq + 3);
}

void states_draw(const struct states *s, double *const *in, unsigned short seed[3])
{
	for (int i = 0; i < s->a->dag.argument_count; i++)
		for (int r = 0; r < s->a->dag.arguments[i].rows && in[i]; r++) {
			double at = erand48(seed);

			if (s->a->dag.arguments[i].role != ROLE_JOINT_POSITION)
				at = at > 0.5;
			in[i][r] = has_range(s, i, r) ? s->b->rows[i][r].lower +
								at * (s->b->rows[i][r].upper - s->b->rows[i][r].lower)
						      : 0;
		}
	states_settle(s, in);
}

void states_move(const struct states *s, double *const *in, int argument, int row, double step)
{
	struct interval r = s->b->rows[argument][row];
	double x = in[argument][row];

	if (s->a->dag.arguments[argument].role == ROLE_JOINT_POSITION)
		in[argument][row] = x + step * (r.upper - r.lower);
	else
		in[argument][row] = fabs(x - r.lower) < fabs(x - r.upper) ? r.upper : r.lower;
	states_settle(s, in);
}

static void take_row(const struct states *s, const struct relaxed *r, const struct field_dim *k, double q, double *const *in)
{
	const struct relaxed_row *row = &r->of_q[k->row];

	if (row->factor != 0 && row->argument >= 0 && row->row < s->a->dag.arguments[row->argument].rows)
		in[row->argument][row->row] = q / row->factor;
}

void states_take(const struct states *s, const struct relaxed *r, const struct field *f, const struct sought *found,
	double *const *in)
{
	for (int k = 0; k < f->dim_count; k++)
		take_row(s, r, &f->dims[k], found->q[k], in);
	for (int i = 0; i < f->drive_count; i++)
		if (f->drives[i].argument != r->drives)
			in[f->drives[i].argument][f->drives[i].row] = found->x[i] * f->drives[i].scale;
	for (int j = 0; j < f->rate_count; j++)
		in[f->rates[j].argument][f->rates[j].row] = found->x[f->drive_count + j] * f->rates[j].scale;
	states_settle(s, in);
}
