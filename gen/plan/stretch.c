#include "plan/stretch.h"
#include "plan/stage.h"
#include <string.h>

/* Rows of a gap at least; of arrays at most. */
enum { LEAST_GAP = 4, ROWS = 4096 };

void stretch_widen(struct stretch *s, int row)
{
	int end = s->first + s->rows;

	if (!s->rows)
		*s = (struct stretch){row, 1};
	else if (row < s->first)
		*s = (struct stretch){row, end - row};
	else if (row >= end)
		s->rows = row + 1 - s->first;
}

static int is_read(const struct dag *d, const struct node *n)
{
	return n->op == OP_INPUT && !d->arguments[n->arg[0].i].is_output;
}

/* Rows that all arrays have which have stretches, each sample's own: q may have one more, where a base moves. 0: these differ, or
   are too many. */
static int rows_of_all(const struct stretches *s, const struct dag *d)
{
	int rows = 0, of_q = 0;

	for (int i = 0; i < d->argument_count; i++) {
		const struct argument *a = &d->arguments[i];

		if (a->per_batch || (s->has_inputs_alone && a->is_output))
			continue;
		if (a->role == ROLE_JOINT_POSITION)
			of_q = a->rows;
		else if (rows && a->rows != rows)
			return 0;
		else
			rows = a->rows;
	}
	if (rows && of_q && of_q != rows && of_q != rows + 1)
		return 0;
	rows = rows ? rows : of_q;
	return rows <= ROWS ? rows : 0;
}

/* By row: is it touched, in any of them? */
static void mark_rows(const struct stretches *s, const struct dag *d, unsigned char *touched)
{
	for (size_t i = 0; i < d->count; i++)
		if (is_read(d, &d->nodes[i]) && !d->arguments[d->nodes[i].arg[0].i].per_batch)
			touched[d->nodes[i].arg[1].i] = 1;
	for (size_t i = 0; i < d->output_count && !s->has_inputs_alone; i++)
		touched[d->outputs[i].row] = 1;
}

/* The longest gap between rows that are touched. */
static void find_gap(struct stretches *s, const struct dag *d)
{
	unsigned char touched[ROWS + 1] = {0};
	int rows = rows_of_all(s, d), last = -1;

	if (rows)
		mark_rows(s, d, touched);
	for (int row = 0; row < rows; row++) {
		int gap = row - last - 1;

		if (!touched[row])
			continue;
		if (last >= 0 && gap >= LEAST_GAP && gap > s->gap) {
			s->second = row;
			s->gap = gap;
		}
		last = row;
	}
}

static void widen(const struct stretches *s, struct stretch *both, int row)
{
	stretch_widen(&both[s->gap && row >= s->second], row);
}

static void widen_by(const struct stretches *s, struct stretch *both, const struct stretch *by)
{
	for (int k = 0; k < STRETCHES; k++)
		if (by[k].rows) {
			widen(s, both, by[k].first);
			widen(s, both, by[k].first + by[k].rows - 1);
		}
}

/* Is there an input of so many rows or more, each sample its own? */
static int has_room_for(const struct dag *d, int argument, int rows)
{
	const struct argument *a = &d->arguments[argument];

	return argument < d->argument_count && !a->is_output && !a->per_batch && a->rows >= rows;
}

/* The vjp, if its rows can stand where q, qd and qdd were; or -1. */
static int find_divided(const struct dag *d, int nv)
{
	int vjp = nv > 0 ? dag_find_role(d, ROLE_VJP, 1) : -1;

	if (vjp < 0 || d->arguments[vjp].rows != PERIODS * nv)
		return -1;
	for (int i = 0; i < PERIODS; i++)
		if (!has_room_for(d, i, nv))
			return -1;
	return vjp;
}

static void find_places(struct stretches *s, const struct dag *d, int nv)
{
	int weights = dag_find_role(d, ROLE_COTANGENT, 0), tau = dag_find_role(d, ROLE_JOINT_TORQUE, 1);

	for (int i = 0; i < d->argument_count; i++)
		s->place_of[i] = stage_place(d, i);
	s->divided = find_divided(d, nv);
	if (s->divided < 0)
		return;
	s->period = nv;
	s->shift = d->arguments[0].rows - nv;
	s->place_of[s->divided] = 0;
	if (tau >= 0)
		s->place_of[tau] = weights >= PERIODS && has_room_for(d, weights, nv) ? weights : tau;
}

static int row_of(const struct stretches *s, int argument, int row)
{
	return s->period && argument == s->divided ? row % s->period : row;
}

int stretches_found_place(const struct dag *d, int found)
{
	return found == FOUND_MU ? PERIODS - 1 : dag_find_role(d, ROLE_COTANGENT, 0);
}

int stretches_found_row(const struct stretches *s, int found)
{
	return found == FOUND_MU ? (PERIODS - 1) * s->period : 0;
}

/* Is it the place of qdd or of mu? */
static int has_found(const struct stretches *s, const struct dag *d, int argument)
{
	return s->takes_found && s->period &&
		(argument == stretches_found_place(d, FOUND_QDD) || argument == stretches_found_place(d, FOUND_MU));
}

static void find_own(struct stretches *s, const struct dag *d)
{
	for (size_t i = 0; i < d->count; i++) {
		const struct node *n = &d->nodes[i];

		if (is_read(d, n))
			widen(s, s->own[n->arg[0].i], (int)n->arg[1].i);
		else if (s->takes_found && s->period && n->op == OP_INPUT)
			stretch_widen(&s->found, (int)n->arg[1].i % s->period);
	}
	for (size_t i = 0; i < d->output_count; i++) {
		const struct output *o = &d->outputs[i];

		widen(s, s->own[o->argument], row_of(s, o->argument, o->row));
		if (s->period && o->argument == s->divided)
			s->periods |= 1u << o->row / s->period;
	}
	for (int i = 0; i < d->argument_count; i++)
		if (!s->own[i][0].rows && !s->own[i][1].rows && !has_found(s, d, i))
			widen(s, s->own[i], s->gap ? s->second : 0);
}

/* The places of q, qd and qdd hold the vjp's rows too, and are as far from each other. */
static void align_periods(struct stretches *s, const struct dag *d)
{
	struct stretch all[STRETCHES] = {{0}}, own = s->own[s->divided][0];

	widen(s, all, own.first + s->shift);
	widen(s, all, own.first + s->shift + own.rows - 1);
	if (s->found.rows) {
		widen(s, all, s->found.first + s->shift);
		widen(s, all, s->found.first + s->shift + s->found.rows - 1);
	}
	for (int i = 0; i < PERIODS; i++)
		widen_by(s, all, s->place[i]);
	for (int i = 0; i < d->argument_count; i++)
		if (i < PERIODS || has_found(s, d, i))
			widen_by(s, s->place[i], all);
}

/* Where they stand, once the rows are found. */
static void place_own(struct stretches *s, const struct dag *d)
{
	for (int i = 0; i < d->argument_count; i++)
		if (!s->period || i != s->divided)
			widen_by(s, s->place[s->place_of[i]], s->own[i]);
	for (int i = 0; i < d->argument_count && s->gap; i++) { /* so that the gap of all arrays is the same */
		if (s->has_inputs_alone && d->arguments[i].is_output)
			continue;
		widen(s, s->place[i], s->second - s->gap - 1);
		widen(s, s->place[i], s->second);
	}
	if (s->period)
		align_periods(s, d);
}

static void make(struct stretches *s, const struct dag *d, int nv)
{
	find_places(s, d, nv);
	find_gap(s, d);
	find_own(s, d);
	place_own(s, d);
}

void stretches_make(struct stretches *s, const struct dag *d, int nv)
{
	*s = (struct stretches){0};
	make(s, d, nv);
}

void stretches_make_found(struct stretches *s, const struct dag *d, int nv)
{
	*s = (struct stretches){.takes_found = 1};
	make(s, d, nv);
}

void stretches_make_whole(struct stretches *s, const struct dag *d, int nv)
{
	*s = (struct stretches){0};
	find_places(s, d, nv);
	s->periods = (1u << PERIODS) - 1;
	for (int i = 0; i < d->argument_count; i++)
		s->own[i][0] = (struct stretch){0, s->period && i == s->divided ? s->period : d->arguments[i].rows};
	place_own(s, d);
}

void stretches_make_inputs(struct stretches *s, const struct dag *d)
{
	*s = (struct stretches){.has_inputs_alone = 1};
	for (int i = 0; i < d->argument_count; i++)
		s->place_of[i] = i;
	find_gap(s, d);
	for (size_t i = 0; i < d->count; i++)
		if (is_read(d, &d->nodes[i]))
			widen(s, s->own[d->nodes[i].arg[0].i], (int)d->nodes[i].arg[1].i);
	place_own(s, d);
}

int stretches_are_written(const struct stretches *s, const struct dag *d)
{
	size_t rows = 0;

	for (int i = 0; i < d->argument_count; i++)
		for (int k = 0; k < STRETCHES && d->arguments[i].is_output; k++)
			rows += (size_t)s->own[i][k].rows * (s->period && i == s->divided ? PERIODS : 1);
	return rows == d->output_count;
}

int stretches_rows(const struct stretches *s, int argument)
{
	return s->place[argument][0].rows + s->place[argument][1].rows;
}

int stretches_words(const struct stretches *s, const struct dag *d, const struct rneagen_options *o)
{
	int words = 0;

	for (int i = 0; i < d->argument_count; i++)
		if (!d->arguments[i].per_batch && s->place_of[i] == i)
			words += stage_pitch(stretches_rows(s, i), o);
	return words;
}
