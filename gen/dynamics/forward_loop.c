/* Derivatives of qdd in loops over columns: each loop's body makes M^-1 of a column of -d tau, which stands in its place, or
   beside the loop's others. */
#include "dynamics/forward.h"
#include "dynamics/want.h"

static int first_coupled(const struct pattern *coupled, int j)
{
	int i = 0;

	while (coupled->row[i * coupled->cols + j] < 0)
		i++;
	return i;
}

int loops_read(const struct loops *x, int nv, int i, int j)
{
	return !x->is_in_place || x->reads_all || x->related.row[i * nv + j] >= 0;
}

static const char COLUMNS[] = "columns";

void forward_declare_columns(struct dag *d, const struct loops *x)
{
	dag_argument_of(d, (struct argument){.name = COLUMNS, .rows = x->rows, .is_output = 1, .per_batch = 1, .role = ROLE_UNKNOWN,
		.of = ""});
}

/* Of the rows before row i, those of a loop: the joints that feel each other. */
static int rows_before(const struct loops *x, int leader, int i)
{
	int count = 0;

	while (i-- > 0)
		count += x->first[i] == leader;
	return count;
}

/* Does another gradient of qdd stand before this one? */
static int is_second(const struct build *b, int argument)
{
	for (int i = 0; i < b->k->want_count; i++)
		if ((b->k->wants[i].kind == WANT_DQDD_DQ || b->k->wants[i].kind == WANT_DQDD_DQD) && b->outputs[i] < argument)
			return 1;
	return 0;
}

/* Which of a loop's columns it is, if none is left out: those of the first gradient come first. */
static int place_of(const struct forward *x, int j, int argument)
{
	const struct loops *l = x->b->ways.loops;

	return rows_before(l, l->first[j], j) + (is_second(x->b, argument) ? l->rooms[l->first[j]].rows : 0);
}

void forward_leave_column(const struct forward *x, const struct ref *column, int j, int argument)
{
	struct dag *d = x->b->d;
	const int *first = x->b->ways.loops->first;
	const struct column_room *r = &x->b->ways.loops->rooms[first[j]];
	int nv = x->b->t->nv, row = r->first + place_of(x, j, argument), columns = dag_find_argument(d, COLUMNS);

	for (int i = 0; i < nv; i++) {
		if (first[i] == first[j]) {
			if (!x->b->ways.way || column[i].i) /* the array is zero before */
				dag_output(d, columns, row, column[i]);
			row += r->room;
		} else if (x->coupled.row[i * nv + j] >= 0) { /* zero, in a dense matrix */
			dag_output(d, argument, x->coupled.row[i * nv + j], column[i]);
		}
	}
}

void forward_tell_matrices(const struct build *b, const int *arguments)
{
	int has_room = b->ways.loops && b->ways.loops->rooms;

	if (!b->ways.way)
		return;
	for (enum by m = BY_Q; m <= BY_QD; m++) {
		b->ways.way->matrix[m].argument = arguments[m] >= 0 ? arguments[m] : has_room ? dag_find_argument(b->d, COLUMNS) : b->solved[m];
		b->ways.way->matrix[m].first = has_room && is_second(b, b->solved[m]) ? b->ways.loops->rooms[0].rows : 0;
	}
	b->ways.way->is_negated = b->ways.loops && b->ways.loops->is_in_place;
}

/* A row of an array has room for so many columns more as fill the last vectors. */
static int room_for(int columns)
{
	return (columns + DAG_COLUMNS_UNIT - 1) / DAG_COLUMNS_UNIT * DAG_COLUMNS_UNIT;
}

/* By a loop's places, how many columns are left out before; behind the last one, of all. */
static int *gaps_of(const struct forward *x, const struct column_room *r, int leader)
{
	int nv = x->b->t->nv, *gaps = arena_alloc(x->b->d->arena, (size_t)r->room + 1, sizeof *gaps);

	for (int k = 0; k < DAG_ARGUMENTS * nv && gaps; k++)
		if (x->looped[k] && x->b->ways.loops->first[k % nv] == leader)
			gaps[place_of(x, k % nv, k / nv)] = 1;
	for (int place = 0, gap = 0; place <= r->room && gaps; place++) {
		int is_there = gaps[place];

		gaps[place] = gap;
		gap += !is_there;
	}
	return gaps;
}

/* Columns that are left out, as those of a floating base are, leave no gap: the array stays in a core's first cache. */
static void close_up(const struct forward *x, struct column_room *r, int leader)
{
	struct dag *d = x->b->d;
	int end = r->first + r->rows * r->room, *gaps = gaps_of(x, r, leader), room = gaps ? room_for(r->room - gaps[r->room]) : 0;

	for (size_t k = 0; k < d->output_count && gaps; k++) {
		struct output *o = &d->outputs[k];
		int at = o->row - r->first, place = at % r->room;

		if (o->argument == r->argument && o->row >= r->first && o->row < end)
			o->row = r->first + at / r->room * room + place - gaps[place];
	}
	r->room = room;
	d->arguments[r->argument].rows = r->first + r->rows * room;
}

/* The row with which a loop's columns begin. */
static int first_row(const struct forward *x, int leader)
{
	return x->b->ways.loops->rooms ? leader : first_coupled(&x->coupled, leader);
}

/* Element (i, j) stands as far behind the first one as in any other column; -1: it is no part of the loop. */
static int element_row(const struct forward *x, int leader, int i)
{
	const struct loops *l = x->b->ways.loops;
	const int *at = x->coupled.row;
	int nv = x->b->t->nv;

	if (l->rooms)
		return l->first[i] == leader ? rows_before(l, leader, i) * l->rooms[leader].room : -1;
	return at[i * nv + leader] < 0 ? -1 : at[i * nv + leader] - at[first_row(x, leader) * nv + leader];
}

/* Where columns stand side by side, they are of d tau: its sign moves to the end, where it costs nothing. */
static struct ref signed_input(const struct forward *x, int loop, int row)
{
	struct ref e = dag_input(x->b->d, DAG_COLUMN + loop, row);

	return x->b->ways.loops->rooms ? dag_neg(x->b->d, e) : e;
}

/* A loop over the columns that have `leader`, which it reads; returns its number, -1 where d->failed is set. */
static int begin_loop(const struct forward *x, int leader, struct ref *column)
{
	struct dag *d = x->b->d;
	const struct loops *l = x->b->ways.loops;
	struct column_room *room = l->rooms ? &l->rooms[leader] : NULL;
	int nv = x->b->t->nv, loop;

	if (room) {
		room->argument = dag_find_argument(d, COLUMNS);
		close_up(x, room, leader);
	}
	loop = dag_loop(d, room);
	d->failed |= loop < 0;
	for (int i = 0; i < nv && !d->failed; i++) {
		int is_read = element_row(x, leader, i) >= 0 && loops_read(l, nv, i, leader);

		column[i] = is_read ? signed_input(x, loop, element_row(x, leader, i)) : (struct ref){0};
	}
	for (int k = 0; k < DAG_ARGUMENTS * nv && !d->failed; k++)
		if (x->looped[k] && l->first[k % nv] == leader)
			dag_loop_over(d, k / nv, x->coupled.row[first_row(x, leader) * nv + k % nv]);
	return d->failed ? -1 : loop;
}

static void write_column(const struct forward *x, int loop, int leader, const struct ref *column)
{
	for (int i = 0; i < x->b->t->nv; i++)
		if (element_row(x, leader, i) >= 0)
			dag_output(x->b->d, DAG_COLUMN + loop, element_row(x, leader, i), column[i]);
}

/* M^-1 of the columns that have `leader`. */
static void loop_over(const struct forward *x, int leader, struct ref *column)
{
	int loop = begin_loop(x, leader, column);

	if (loop < 0)
		return;
	forward_solve(x, column);
	write_column(x, loop, leader, column);
}

/* The first half of it, which is left for the last loop. */
static void reduce_over(const struct forward *x, int leader, struct ref *column)
{
	if (begin_loop(x, leader, column) < 0)
		return;
	factor_reduce(&x->M, column);
	for (int i = 0; i < x->b->t->nv; i++)
		if (column[i].i)
			dag_output(x->b->d, DAG_REDUCED, i, column[i]);
}

/* The second half, of all columns. */
static void expand_all(const struct forward *x, struct ref *column)
{
	struct dag *d = x->b->d;
	int loop = dag_loop(d, NULL);

	d->failed |= loop < 0;
	if (d->failed)
		return;
	dag_loops_reduce(d, x->b->t->nv);
	for (int i = 0; i < x->b->t->nv; i++)
		column[i] = dag_input(d, DAG_REDUCED, i);
	factor_expand(&x->M, column);
	write_column(x, loop, 0, column);
}

/* Is a column left to this loop? None is of slides of a base, or of a balanced wheel. */
static int has_columns(const struct forward *x, int leader)
{
	int nv = x->b->t->nv;

	for (int k = 0; k < DAG_ARGUMENTS * nv; k++)
		if (x->looped[k] && x->b->ways.loops->first[k % nv] == leader)
			return 1;
	return 0;
}

/* Of M^-1 times a column: two for each pair of rows of which one is nearer to the base. */
static int operations(const struct pattern *related, const struct pattern *coupled, int first)
{
	int pairs = 0, nv = related->cols;

	for (int i = 0; i < nv; i++)
		for (int j = 0; j < i && coupled->row[first * nv + i] >= 0; j++)
			pairs += related->row[i * nv + j] >= 0;
	return 2 * pairs;
}

/* Operations that a relay's third kernel is to have fewer, so that a column goes from a limb's loop on to one of all. H200, how
   many fewer, and ns for each of 262144 samples of the kernel, in loops of their own and so: floating hyq 396, f32 1.07 and 1.08,
   f64 1.96 and 2.01; atlas without its right side 513, 2.27 and 2.48, 4.28 and 7.0; anymal_kinova 750, 2.41 and 2.56, 4.70 and
   3.69; g1_29dof 1530, 7.9 and 6.9, 20.1 and 15.0; atlas 1896, 9.0 and 7.1, 21.9 and 14.8. */
enum { HALVED_LEAST = 1000 };

/* Where all rows of a column feel what limbs have left in the base's, the way out from the base is the same for the columns of
   all limbs. */
static int is_halved(const struct forward *x)
{
	int nv = x->b->t->nv, loops = 0;

	for (int i = 0; i < nv; i++)
		loops += x->b->ways.loops->first[i] == i && has_columns(x, i);
	return x->b->ways.loops->is_relay && x->coupled.rows == nv * nv && loops < DAG_LOOPS &&
		(loops - 1) * operations(&x->b->ways.loops->related, &x->coupled, 0) / 2 >= HALVED_LEAST;
}

void forward_loop(const struct forward *x)
{
	int nv = x->b->t->nv, is_in_halves = is_halved(x);
	struct ref *column = arena_alloc(x->b->d->arena, (size_t)nv, sizeof *column);

	x->b->d->failed |= !column;
	for (int i = 0; i < nv && !x->b->d->failed; i++)
		if (x->b->ways.loops->first[i] == i && has_columns(x, i))
			(is_in_halves ? reduce_over : loop_over)(x, i, column);
	if (is_in_halves && !x->b->d->failed)
		expand_all(x, column);
}

/* One call in f64, AVX2, against the straight line: 6 operations, a leg of hyq, 0.97, for a text half as long again; 12, a finger
   of allegro, 0.90; 30 ur5 0.88, 42 iiwa14 0.92, 70 panda with both fingers 0.79, 198 floating hyq 0.64, 612 g1_29dof 0.60. A
   compiler takes some seconds for the most. */
enum { LOOP_LEAST = 10, LOOP_MOST = 2000 };

/* Do the elements of a row stand side by side? In a dense matrix those between them are of rows that feel nothing of these. */
static int is_in_a_row(const struct pattern *coupled, int first, int dense)
{
	int nv = coupled->cols, gap = 0;

	for (int i = first; i < nv && dense; i++)
		if (coupled->row[first * nv + i] < 0)
			gap = 1;
		else if (gap)
			return 0;
	return 1;
}

/* From an element to the one below it, the same for all rows of a column, in the matrix as it is stored; 0: it is not. */
static int pitch_of(const struct pattern *stored, const struct pattern *coupled, int first)
{
	int nv = coupled->cols, last = first, pitch = 0;

	for (int i = first + 1; i < nv; i++) {
		int step = stored->row[i * nv + first] - stored->row[last * nv + first];

		if (coupled->row[i * nv + first] < 0)
			continue;
		if (pitch && step != pitch)
			return 0;
		pitch = step;
		last = i;
	}
	return pitch;
}

/* For the columns of both gradients, or of one. */
static void make_room(struct loops *x, const struct pattern *stored, const struct pattern *coupled, int first, int gradients)
{
	int rows = 0;

	for (int i = 0; i < coupled->cols; i++)
		rows += coupled->row[i * coupled->cols + first] >= 0;
	x->rooms[first] = (struct column_room){.first = x->rows, .rows = rows, .room = room_for(gradients * rows),
		.pitch = pitch_of(stored, coupled, first)};
	x->rows += x->rooms[first].room * rows;
}

/* One loop for all joints that feel each other, where that pays on a processor. */
static int is_worth_it(const struct loops *x, const struct pattern *coupled, int first, int count, int dense)
{
	int n = operations(&x->related, coupled, first);

	return n >= LOOP_LEAST && n <= LOOP_MOST && count < DAG_LOOPS && is_in_a_row(coupled, first, dense);
}

/* Do the same rows feel both joints, so that both columns of d tau are zero in the same rows? */
static int is_alike(const struct pattern *related, int j, int k)
{
	for (int i = 0; i < related->lines; i++)
		if ((related->row[i * related->cols + j] >= 0) != (related->row[i * related->cols + k] >= 0))
			return 0;
	return 1;
}

static int first_alike(const struct pattern *related, int j)
{
	int k = 0;

	while (!is_alike(related, k, j))
		k++;
	return k;
}

int forward_loops(struct loops *x, const struct tree *t, int dense, int is_in_place, struct arena *a)
{
	struct pattern coupled, stored;
	int count = 0, nv = t->nv;

	*x = (struct loops){.is_in_place = is_in_place, .first = arena_alloc(a, (size_t)nv, sizeof *x->first)};
	x->rooms = is_in_place ? NULL : arena_alloc(a, (size_t)nv, sizeof *x->rooms);
	if (!x->first || (!is_in_place && !x->rooms) || !pattern_make(&x->related, t, 0, 0, a) ||
		!pattern_coupled(&coupled, t, 0, 0, a) || !pattern_coupled(&stored, t, 0, dense, a))
		return 0;
	for (int i = 0; i < nv; i++) {
		int first = is_in_place ? first_alike(&x->related, i) : first_coupled(&coupled, i);

		if (first < i)
			x->first[i] = x->first[first];
		else
			x->first[i] = is_in_place || (is_worth_it(x, &coupled, i, count, dense) && pitch_of(&stored, &coupled, i)) ? i : -1;
		if (x->first[i] == i && !is_in_place)
			make_room(x, &stored, &coupled, i, 2);
		count += x->first[i] == i;
	}
	return count <= DAG_LOOPS ? count : 0;
}

int forward_loops_behind(struct loops *x, const struct tree *t, const struct request *k, int is_in_place, struct arena *a)
{
	int gradients = request_wants(k, WANT_DQDD_DQ) + request_wants(k, WANT_DQDD_DQD), nv = t->nv;
	struct pattern coupled, stored;

	*x = (struct loops){.is_in_place = is_in_place, .reads_all = 1, .first = arena_alloc(a, (size_t)nv, sizeof *x->first)};
	x->rooms = is_in_place ? NULL : arena_alloc(a, (size_t)nv, sizeof *x->rooms);
	if (!x->first || (!is_in_place && !x->rooms) || !pattern_coupled(&coupled, t, 0, 0, a) ||
		!pattern_coupled(&stored, t, 0, k->dense, a) || coupled.rows < nv * nv)
		return 0;
	if (!is_in_place)
		make_room(x, &stored, &coupled, 0, gradients);
	return 1;
}
