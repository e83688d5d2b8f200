#include "mechanics/composite.h"

static struct svec column(const struct smat *T, int j)
{
	return (struct svec){{T->m[0][j], T->m[1][j], T->m[2][j]}};
}

static void set_column(struct smat *T, int j, struct svec u)
{
	for (int i = 0; i < 3; i++)
		T->m[i][j] = u.x[i];
}

void composite_add_body(struct dag *d, struct composite *to, const struct parameters *p, struct svec w)
{
	struct smat G = rigid_body_inertia_matrix(p);
	struct ref trace = dag_add(d, dag_add(d, G.m[0][0], G.m[1][1]), G.m[2][2]), half = dag_mul(d, dag_const(d, 0.5L), trace);

	for (int i = 0; i < 3; i++)
		G.m[i][i] = dag_sub(d, G.m[i][i], half);
	for (int j = 0; j < 3; j++)
		set_column(&to->K, j, svec_add(d, column(&to->K, j), svec_cross(d, w, column(&G, j))));
	for (int i = 0; i < 6; i++)
		to->p.I[i] = dag_add(d, to->p.I[i], p->I[i]);
	to->P = svec_add(d, to->P, svec_cross(d, w, p->h));
	to->p.h = svec_add(d, to->p.h, p->h);
	to->p.mass = dag_add(d, to->p.mass, p->mass);
}

/* What each diagonal element takes of three terms: all but its own. */
static struct ref others(struct dag *d, const struct ref *terms, int i)
{
	return dag_add(d, terms[(i + 1) % 3], terms[(i + 2) % 3]);
}

/* I' = A I A^T + 2 p.w 1 - w p^T - p w^T with w = A h + m p/2 */
static void add_inertia(struct dag *d, struct parameters *to, const struct smat *I, struct ref mass, struct svec h, struct svec p)
{
	struct svec w = svec_add(d, h, svec_scale(d, dag_mul(d, dag_const(d, 0.5L), mass), p));
	struct svec twice = svec_scale(d, dag_const(d, 2), p);
	struct ref terms[3];

	for (int i = 0; i < 3; i++)
		terms[i] = dag_mul(d, twice.x[i], w.x[i]);
	for (int i = 0; i < 3; i++)
		for (int j = i; j < 3; j++) {
			struct ref *e = &to->I[inertia_index(i, j)];
			struct ref more = i == j ? others(d, terms, i) : dag_neg(d, dag_add(d, dag_mul(d, w.x[i], p.x[j]), dag_mul(d, p.x[i], w.x[j])));

			*e = dag_add(d, *e, dag_add(d, I->m[i][j], more));
		}
}

/* K' = A K A^T + (h.p' + p.X) 1 - p' h^T - X p^T with X = P + m p', h and P turned */
static void add_rate(struct dag *d, struct smat *to, const struct smat *K, struct svec h, struct svec X, struct svec p, struct svec rate)
{
	struct ref outer[3][3], terms[3];

	for (int i = 0; i < 3; i++)
		for (int j = 0; j < 3; j++)
			outer[i][j] = dag_add(d, dag_mul(d, rate.x[i], h.x[j]), dag_mul(d, X.x[i], p.x[j]));
	for (int i = 0; i < 3; i++)
		terms[i] = outer[i][i];
	for (int i = 0; i < 3; i++)
		for (int j = 0; j < 3; j++) {
			struct ref more = i == j ? others(d, terms, i) : dag_neg(d, outer[i][j]);

			to->m[i][j] = dag_add(d, to->m[i][j], dag_add(d, K->m[i][j], more));
		}
}

void composite_add_child(
	struct dag *d, struct composite *parent, const struct composite *c, const struct body *child, const struct joint_pose *at,
	struct svec rate)
{
	struct svec h = joint_to_parent(d, child, at, c->p.h), p = at->p;
	struct svec X = svec_add(d, joint_to_parent(d, child, at, c->P), svec_scale(d, c->p.mass, rate));
	struct smat I = rigid_body_inertia_matrix(&c->p), K = joint_turn(d, child, at, &c->K);

	I = joint_turn(d, child, at, &I);
	add_inertia(d, &parent->p, &I, c->p.mass, h, p);
	add_rate(d, &parent->K, &K, h, X, p, rate);
	parent->P = svec_add(d, parent->P, X);
	parent->p.h = svec_add(d, parent->p.h, svec_add(d, h, svec_scale(d, c->p.mass, p)));
	parent->p.mass = dag_add(d, parent->p.mass, c->p.mass);
}

void composite_add_still(
	struct dag *d, struct composite *parent, const struct composite *c, const struct body *child, const struct joint_pose *at)
{
	struct svec h = joint_to_parent(d, child, at, c->p.h), p = at->p;
	struct smat I = rigid_body_inertia_matrix(&c->p);

	I = joint_turn(d, child, at, &I);
	add_inertia(d, &parent->p, &I, c->p.mass, h, p);
	parent->p.h = svec_add(d, parent->p.h, svec_add(d, h, svec_scale(d, c->p.mass, p)));
	parent->p.mass = dag_add(d, parent->p.mass, c->p.mass);
}
