/* Elements of the matrices as they grow, and when they are written. */
#include "dynamics/recursion/recursion.h"
#include <string.h>

int recursion_is_made(const struct recursion *x, enum by by)
{
	return by == BY_QDD || (by == BY_CORIOLIS ? x->has_coriolis : x->has_gradients);
}

void recursion_write(struct recursion *x, enum by by, int i, int j)
{
	struct by_matrix *m = &x->by[by];
	int at = i * x->r->t->nv + j;

	if (m->argument >= 0 && m->p.row[at] >= 0 && !m->is_done[at])
		dag_output(x->r->d, m->argument, m->p.row[at], m->element[at]);
	m->is_done[at] = 1;
}

/* Element (i, j); of several coordinates side by side one for each, whose row stands in place of the first one's. */
static void add_each(struct recursion *x, struct ref *elements, int i, int j, struct ref e)
{
	const struct traveller *now = x->now;
	int first = now ? now->rows[0] : -1;

	for (int k = 0; k < (now ? now->count : 1); k++) {
		int row = i == first ? now->rows[k] : i, column = j == first ? now->rows[k] : j;
		struct ref *to = &elements[row * x->r->t->nv + column];

		*to = dag_add(x->r->d, *to, dag_lane(x->r->d, e, k));
	}
}

void recursion_add(struct recursion *x, enum by by, int i, int j, struct ref e)
{
	if (x->way && x->way->here >= 0)
		recursion_put_element(x, by, i, j, e);
	else
		add_each(x, x->by[by].element, i, j, e);
}

static void fill_apart(struct recursion *x, enum by by, int i, int j, const struct row_vectors *s, struct field f)
{
	struct by_matrix *m = &x->by[by];

	m->shift[j] = f.gamma;
	memset(&f.gamma, 0, sizeof f.gamma);
	add_each(x, m->apart, i, j, field_meet(x->r->d, s, &f));
}

/* Row i of the gradients, by the coordinates of body `here`. */
void recursion_fill_row(struct recursion *x, int i, int here, const struct row_vectors *s)
{
	struct dag *d = x->r->d;
	const struct body *k = &x->r->t->bodies[here];
	struct field by[BY_QDD];

	for (int j = k->iv; j < k->iv + joint_nv(k->type); j++) {
		recursion_fields(x, here, j - k->iv, by);
		for (enum by b = BY_Q; b < BY_QDD; b++)
			if (recursion_is_made(x, b)) {
				recursion_add(x, b, i, j, field_meet(d, s, &by[b]));
				if (x->has_shifts && recursion_is_shifted(x, here))
					fill_apart(x, b, i, j, s, by[b]);
			}
	}
}

/* M_ij = Z.n2 + Y.f2, the unit acceleration of row i of body `from` felt by the joint of body `here`; it stands for M_ji too,
   and of a joint's own rows for one half. */
void recursion_fill_mass(struct recursion *x, int i, int from, int here, const struct row_vectors *s)
{
	struct dag *d = x->r->d;
	const struct body *k = &x->r->t->bodies[here];
	struct ref e[6];

	joint_project(d, k, s->f2, s->n2, joint_out_of(d, k, recursion_pose(x, here), s->f2), e);
	for (int j = k->iv; j < k->iv + joint_nv(k->type) && (here != from || j <= i); j++) {
		recursion_add(x, BY_QDD, i, j, e[j - k->iv]);
		if (here != from || j != i)
			recursion_add(x, BY_QDD, j, i, e[j - k->iv]);
	}
}

/* Column j: what the joint of body `here`, nearer to the base, feels of a wrench. */
void recursion_fill_column(struct recursion *x, enum by by, int j, int here, struct wrench w)
{
	struct dag *d = x->r->d;
	const struct body *k = &x->r->t->bodies[here];
	struct ref e[6];

	if (!recursion_is_made(x, by))
		return;
	joint_project(d, k, w.f, w.n, joint_out_of(d, k, recursion_pose(x, here), w.f), e);
	for (int i = 0; i < joint_nv(k->type); i++)
		recursion_add(x, by, k->iv + i, j, e[i]);
}

/* What is complete: all but what several bodies add to. */
void recursion_write_between(struct recursion *x, int i, int here)
{
	const struct body *k = &x->r->t->bodies[here];

	for (int j = k->iv; j < k->iv + joint_nv(k->type); j++)
		for (enum by b = BY_Q; b < BY_COUNT && !x->is_shared[i] && !x->is_shared[j]; b++) {
			recursion_write(x, b, i, j);
			recursion_write(x, b, j, i);
		}
}

int recursion_grows(const struct recursion *x)
{
	return x->is_in_lanes || x->r->t->mimic_count;
}
