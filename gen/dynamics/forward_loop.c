/* Derivatives of qdd in loops over columns: -d tau stands in their place, and each loop's body makes M^-1 of a column. */
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
	return !x->is_relay || x->related.row[i * nv + j] >= 0;
}

/* M^-1 of the columns that have `leader`. Element (i, j) stands as far behind (first, j) as in any other of them. */
static void loop_over(const struct forward *x, int leader)
{
	struct dag *d = x->b->d;
	const struct loops *l = x->b->loops;
	int nv = x->b->t->nv, loop = dag_loop(d), first = first_coupled(&x->coupled, leader);
	const int *at = x->coupled.row;
	struct ref *column = arena_alloc(d->arena, (size_t)nv, sizeof *column);

	if (!column || loop < 0 || d->failed) {
		d->failed = 1;
		return;
	}
	for (int i = 0; i < nv; i++)
		if (at[i * nv + leader] >= 0 && loops_read(l, nv, i, leader))
			column[i] = dag_input(d, DAG_COLUMN + loop, at[i * nv + leader] - at[first * nv + leader]);
	forward_solve(x, column);
	for (int i = 0; i < nv; i++)
		if (at[i * nv + leader] >= 0)
			dag_output(d, DAG_COLUMN + loop, at[i * nv + leader] - at[first * nv + leader], column[i]);
	for (int k = 0; k < DAG_ARGUMENTS * nv; k++)
		if (x->looped[k] && l->first[k % nv] == leader)
			dag_loop_over(d, k / nv, at[first * nv + k % nv]);
}

void forward_loop(const struct forward *x)
{
	for (int i = 0; i < x->b->t->nv; i++)
		if (x->b->loops->first[i] == i)
			loop_over(x, i);
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

/* One call in f64, AVX2, against the straight line: 30 operations, ur5, 0.85; 42 iiwa14 1.1, 70 panda with both fingers 0.86,
   90 fetch 0.82, 198 floating hyq 0.76, 612 g1_29dof 0.65. A compiler takes some seconds for the most. */
enum { LOOP_LEAST = 60, LOOP_MOST = 2000 };

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

int forward_loops(struct loops *x, const struct tree *t, int dense, int is_relay, struct arena *a)
{
	struct pattern coupled;
	int count = 0, nv = t->nv;

	*x = (struct loops){.is_relay = is_relay, .first = arena_alloc(a, (size_t)nv, sizeof *x->first)};
	if (!x->first || !pattern_make(&x->related, t, 0, 0, a) || !pattern_coupled(&coupled, t, 0, 0, a))
		return 0;
	for (int i = 0; i < nv; i++) {
		int first = is_relay ? first_alike(&x->related, i) : first_coupled(&coupled, i);

		if (first < i)
			x->first[i] = x->first[first];
		else
			x->first[i] = is_relay || is_worth_it(x, &coupled, i, count, dense) ? i : -1;
		count += x->first[i] == i;
	}
	return count <= DAG_LOOPS ? count : 0;
}
