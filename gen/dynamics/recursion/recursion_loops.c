/* Coordinates on their way back to the base in loops: one for each body, over all that come through it, whose numbers stand in an
   array. It takes them to the parent, and finds what the parent's joint and each of them make the other feel. What is the same
   for all of them is made before the loops. */
#include "dynamics/recursion/recursion.h"

struct carried_vector {
	struct svec *at;
	const char *name;
};

/* The vectors that a coordinate carries, and their names; returns how many. */
static int carried_vectors(const struct way_back *w, struct traveller *x, struct carried_vector v[WAY_VECTORS])
{
	static const char *const names[][2] = {[BY_Q] = {"fq", "nq"}, [BY_QD] = {"fd", "nd"}};
	int count = 0;

	v[count++] = (struct carried_vector){&x->s.n2, "sn"};
	v[count++] = (struct carried_vector){&x->s.n1, "sm"};
	v[count++] = (struct carried_vector){&x->s.f2, "sf"};
	for (enum by b = BY_Q; b <= BY_QD; b++)
		if (w->is_wanted[b]) {
			v[count++] = (struct carried_vector){&x->w[b].f, names[b][0]};
			v[count++] = (struct carried_vector){&x->w[b].n, names[b][1]};
		}
	return count;
}

/* ---- whether there may be such loops ---- */

/* Rows of qd of a body and all beyond it, if they are in a row; 0: they are not. */
static int rows_beyond(const struct tree *t, int body)
{
	int first = t->bodies[body].iv, rows = 0;

	for (int b = body; b < tree_end(t, body); b++) {
		if (t->bodies[b].iv != first + rows)
			return 0;
		rows += joint_nv(t->bodies[b].type);
	}
	return rows;
}

/* Do elements of row j stand side by side by all rows beyond it, and those of column j as far behind where their rows begin? */
static int is_even(const struct pattern *p, int j, int first, int rows)
{
	int nv = p->cols, down = p->row[first * nv + j] - pattern_row_begins(p, first);

	for (int i = first; i < first + rows; i++)
		if (p->row[j * nv + i] != p->row[j * nv + first] + i - first || p->row[i * nv + j] - pattern_row_begins(p, i) != down)
			return 0;
	return 1;
}

/* Torques and their gradients, or accelerations and theirs. */
static int are_wanted(const struct request *k)
{
	static const enum want_kind kinds[][3] = {{WANT_TAU, WANT_DTAU_DQ, WANT_DTAU_DQD}, {WANT_QDD, WANT_DQDD_DQ, WANT_DQDD_DQD}};
	const enum want_kind *may = kinds[k->is_forward];

	for (int i = 0; i < k->want_count; i++)
		if (k->wants[i].kind != may[0] && k->wants[i].kind != may[1] && k->wants[i].kind != may[2])
			return 0;
	return request_wants(k, may[1]) || request_wants(k, may[2]);
}

/* So many elements of a loop for each row of the joint to which it comes. */
static int elements_each(const struct way_back *w)
{
	return 2 * (w->is_wanted[BY_Q] + w->is_wanted[BY_QD]);
}

/* Rows of the joint to which a body's loop comes; 0: there is none. */
static int rows_before(const struct tree *t, int body)
{
	int parent = t->bodies[body].parent;

	return parent < 0 ? 0 : joint_nv(t->bodies[parent].type);
}

/* May all that come through the body do so in a loop? */
static int is_regular(const struct tree *t, const struct pattern *p, int body)
{
	int rows = rows_beyond(t, body);

	for (int j = 0; j < rows_before(t, body) && rows; j++)
		if (!is_even(p, t->bodies[t->bodies[body].parent].iv + j, t->bodies[body].iv, rows))
			return 0;
	return rows > 0;
}

/* How many coordinates a loop has in the mean at least (../README.md, "Two ways to a derivative"). Each joint of g1_brainco on
   its own has 8: gradients of the torques take 1.83 of the time of lanes for a call, 1.34 for batches. */
enum { COORDINATES_LEAST = 20 };

/* Are there few enough loops, of coordinates enough? */
static int is_worth_it(const struct way_back *w, const struct tree *t, const struct request *k)
{
	int loops = 0, solves = k->is_forward, puts = 0, steps = 0;

	for (int body = 0; body < t->body_count; body++)
		if (t->bodies[body].parent >= 0) {
			loops++;
			puts += rows_before(t, body) * elements_each(w);
			steps += rows_beyond(t, body);
		}
	return loops && loops + solves <= DAG_LOOPS && puts <= DAG_PUTS && steps >= COORDINATES_LEAST * loops;
}

/* One sample's coordinates wait, in rows of their own, until it is their turn: vectors of the loops before may reach over their
   places. A batch's set out where they stand. */
static void make_room(struct way_back *w, const struct tree *t)
{
	int most = 0;

	for (int body = 0; body < t->body_count; body++)
		most = rows_before(t, body) > most ? rows_before(t, body) : most;
	w->carried = 3 * (3 + elements_each(w)); /* a row, and a wrench for each matrix */
	w->elements = most * elements_each(w);
	w->rows = w->carried + w->elements + (w->is_batch ? 0 : w->carried);
	w->places = w->is_batch ? t->nv : (t->nv + 2 * DAG_COLUMNS_UNIT - 2) / DAG_COLUMNS_UNIT * DAG_COLUMNS_UNIT;
}

int way_back_begin(struct way_back *w, const struct tree *t, const struct request *k, const struct pattern *to, int is_batch)
{
	*w = (struct way_back){.argument = -1, .here = -1, .is_batch = is_batch, .to = *to};
	w->is_wanted[BY_Q] = request_wants(k, WANT_DTAU_DQ) || request_wants(k, WANT_DQDD_DQ);
	w->is_wanted[BY_QD] = request_wants(k, WANT_DTAU_DQD) || request_wants(k, WANT_DQDD_DQD);
	if (t->mimic_count || tree_has_type(t, JOINT_FIXED) || !are_wanted(k) || k->stored_count < k->want_count ||
		!is_worth_it(w, t, k))
		return 0;
	for (int body = 0; body < t->body_count; body++)
		if (!is_regular(t, to, body))
			return 0;
	make_room(w, t);
	return 1;
}

int way_back_makes(const struct tree *t, int i, int j)
{
	int a = tree_joint_of_row(t, i)->body, b = tree_joint_of_row(t, j)->body, low = a < b ? a : b, high = a < b ? b : a;

	while (high > low)
		high = t->bodies[high].parent;
	return a != b && high == low;
}

void way_back_declare(struct way_back *w, struct dag *d)
{
	if (!w)
		return;
	w->argument = dag_argument_of(d, (struct argument){.name = "carried", .rows = w->rows * w->places, .is_output = 1,
		.per_batch = 1, .role = ROLE_UNKNOWN, .of = ""});
}

static void tell_begins(const struct way_back *w, struct dag *d)
{
	int *begins = dag_loops_begin_rows(d, w->to.lines);

	for (int i = 0; i < w->to.lines && begins; i++)
		begins[i] = pattern_row_begins(&w->to, i);
}

/* Where a row of a place is. A batch has those of a place together: else they are apart by powers of two, and share a few lines
   of the first cache. */
static int at(const struct way_back *w, int row, int place)
{
	return w->is_batch ? place * w->rows + row : row * w->places + place;
}

/* ---- on the way ---- */

void recursion_set_out(struct recursion *x, int body, int i, const struct row_vectors *s, const struct wrench *w)
{
	const struct tree *t = x->r->t;
	struct traveller one = {.s = *s, .w = {w[BY_Q], w[BY_QD]}};
	struct carried_vector vectors[WAY_VECTORS];
	int count = carried_vectors(x->way, &one, vectors), first = x->way->is_batch ? 0 : x->way->carried + x->way->elements;

	if (t->bodies[body].parent < 0)
		return;
	for (int k = 0; k < 3 * count; k++)
		dag_output(x->r->d, x->way->argument, at(x->way, first + k, i), vectors[k / 3].at->x[k % 3]);
	for (int b = t->bodies[body].parent; b >= 0; b = t->bodies[b].parent)
		for (int j = t->bodies[b].iv; j < t->bodies[b].iv + joint_nv(t->bodies[b].type); j++)
			for (enum by m = BY_Q; m <= BY_QD; m++)
				x->by[m].is_done[i * t->nv + j] = x->by[m].is_done[j * t->nv + i] = 1;
}

/* From a body to its parent. */
static void step(struct recursion *x, int body, struct traveller *one)
{
	int parent = x->r->t->bodies[body].parent;

	one->s = recursion_row_to_parent(x, body, one->s);
	recursion_fill_row(x, one->rows[0], parent, &one->s);
	for (enum by b = BY_Q; b <= BY_QD; b++)
		if (x->way->is_wanted[b]) {
			one->w[b] = recursion_wrench_to_parent(x, body, one->w[b]);
			recursion_fill_column(x, b, one->rows[0], parent, one->w[b]);
		}
}

/* Of the body to which the loop comes, by rows of its joint and by matrices: first what the coordinate feels of it. */
void recursion_put_element(struct recursion *x, enum by by, int i, int j, struct ref e)
{
	const struct way_back *w = x->way;
	const struct body *k = &x->r->t->bodies[w->here];
	int is_down = j >= k->iv && j < k->iv + joint_nv(k->type), nv = x->r->t->nv;
	int number = (is_down ? j : i) - k->iv, second = by == BY_QD && w->is_wanted[BY_Q];
	int row = w->carried + number * elements_each(w) + 2 * second + !is_down;

	if (w->loop < 0 || !w->is_wanted[by])
		return;
	dag_output(x->r->d, DAG_COLUMN + w->loop, at(w, row, 0), w->is_negated ? dag_neg(x->r->d, e) : e);
	dag_loop_put(x->r->d, &(struct column_put){.row = row, .argument = w->matrix[by].argument, .is_down = is_down,
		.first = w->matrix[by].first + w->to.row[i * nv + j] - (is_down ? pattern_row_begins(&w->to, i) : 0)});
}

static void name_vectors(const struct recursion *x, const struct carried_vector *vectors, int count, int body)
{
	for (int k = 0; k < count; k++)
		svec_tag(x->r->d, *vectors[k].at, vectors[k].name, x->r->t->bodies[body].number);
}

/* A coordinate from a body to its parent: one of a loop, or, without one, of nobody. */
static void walk(struct recursion *x, int body, int loop)
{
	struct dag *d = x->r->d;
	const struct tree *t = x->r->t;
	struct way_back *w = x->way;
	struct traveller one = {.count = 1, .rows = {t->bodies[body].iv}};
	struct carried_vector vectors[WAY_VECTORS];
	int count = carried_vectors(w, &one, vectors), parent = t->bodies[body].parent;

	w->loop = loop;
	w->here = parent;
	for (int k = 0; k < 3 * count; k++)
		vectors[k / 3].at->x[k % 3] = dag_input(d, loop < 0 ? DAG_STRUCK : DAG_COLUMN + loop, at(w, k, 0));
	name_vectors(x, vectors, count, body);
	step(x, body, &one);
	name_vectors(x, vectors, count, parent);
	for (int k = 0; k < 3 * count && loop >= 0 && t->bodies[parent].parent >= 0; k++)
		dag_output(d, DAG_COLUMN + loop, at(w, k, 0), vectors[k / 3].at->x[k % 3]);
	w->here = -1;
}

/* Nobody reads what walks here, so that nothing is left of it but what all coordinates share. */
void recursion_prepare(struct recursion *x, int body)
{
	if (x->r->t->bodies[body].parent >= 0)
		walk(x, body, -1);
}

static void loop_from(struct recursion *x, int body)
{
	const struct tree *t = x->r->t;
	struct way_back *w = x->way;
	const struct column_room room = {.argument = w->argument, .first = t->bodies[body].iv, .rows = w->carried,
		.room = w->is_batch ? w->rows : w->places, .is_batch = w->is_batch, .columns = rows_beyond(t, body),
		.own = joint_nv(t->bodies[body].type), .body = body};
	int loop;

	for (int child = body + 1; child < t->body_count; child++)
		if (t->bodies[child].parent == body)
			loop_from(x, child);
	if (t->bodies[body].parent < 0)
		return;
	loop = dag_loop(x->r->d, &room);
	if (loop >= 0)
		walk(x, body, loop);
	else
		x->r->d->failed = 1;
}

void recursion_loop(struct recursion *x)
{
	tell_begins(x->way, x->r->d);
	for (int body = 0; body < x->r->t->body_count; body++)
		if (x->r->t->bodies[body].parent < 0)
			loop_from(x, body);
}
