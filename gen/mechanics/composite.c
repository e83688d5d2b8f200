#include "mechanics/composite.h"
#include <string.h>

static struct ref *parameter(struct parameters *p, int i)
{
	return i == 0 ? &p->mass : i < 4 ? &p->h.x[i - 1] : &p->I[i - 4];
}

static int is_constant(const struct dag *d, struct ref a)
{
	return !a.i || d->nodes[a.i].op == OP_CONST;
}

/* Constants are summed apart, all into one. */
static void add_parameters(struct dag *d, struct composite *to, struct parameters *p)
{
	for (int i = 0; i < 10; i++) {
		struct ref e = *parameter(p, i), *sum = parameter(is_constant(d, e) ? &to->constant : &to->varied, i);

		*sum = dag_add(d, *sum, e);
	}
}

void composite_add_body(struct dag *d, struct composite *to, const struct parameters *p, struct svec w)
{
	struct smat G = rigid_body_inertia_matrix(p);
	struct ref trace = dag_add(d, dag_add(d, G.m[0][0], G.m[1][1]), G.m[2][2]), half = dag_mul(d, dag_const(d, 0.5L), trace);
	struct parameters own = *p;

	for (int i = 0; i < 3; i++)
		G.m[i][i] = dag_sub(d, G.m[i][i], half);
	for (int j = 0; j < 3; j++)
		smat_set_column(&to->K, j, svec_add(d, smat_column(&to->K, j), svec_cross(d, w, smat_column(&G, j))));
	to->P = svec_add(d, to->P, svec_cross(d, w, p->h));
	add_parameters(d, to, &own);
	for (int i = 0; i < 10; i++)
		*parameter(&to->p, i) = dag_add(d, *parameter(&to->constant, i), *parameter(&to->varied, i));
}

/* What each diagonal element takes of three terms: all but its own. */
static struct ref others(struct dag *d, struct ref e, const struct ref *terms, int i)
{
	return dag_add(d, dag_add(d, e, terms[(i + 1) % 3]), terms[(i + 2) % 3]);
}

static struct ref minus_product(struct dag *d, struct ref e, struct ref a, struct ref b)
{
	return dag_sub(d, e, dag_mul(d, a, b));
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
			struct ref *to_ij = &to->I[inertia_index(i, j)], e = I->m[i][j];

			e = i == j ? others(d, e, terms, i)
				: minus_product(d, minus_product(d, e, w.x[i], p.x[j]), p.x[i], w.x[j]);
			*to_ij = dag_add(d, *to_ij, e);
		}
}

/* K' = A K A^T + (h.p' + p.X) 1 - p' h^T - X p^T with X = P + m p', h and P turned */
static void add_rate(struct dag *d, struct smat *to, const struct smat *K, struct svec h, struct svec X, struct svec p,
	struct svec rate)
{
	struct ref terms[3];

	for (int i = 0; i < 3; i++)
		terms[i] = dag_add_products(d, rate.x[i], h.x[i], X.x[i], p.x[i]);
	for (int i = 0; i < 3; i++)
		for (int j = 0; j < 3; j++) {
			struct ref e = K->m[i][j];

			e = i == j ? others(d, e, terms, i)
				: minus_product(d, minus_product(d, e, rate.x[i], h.x[j]), X.x[i], p.x[j]);
			to->m[i][j] = dag_add(d, to->m[i][j], e);
		}
}

/* From the origin p on: h' = h + m p, I as above. */
static void move_origin(struct dag *d, struct parameters *to, struct svec p)
{
	struct smat I = rigid_body_inertia_matrix(to);

	memset(to->I, 0, sizeof to->I);
	add_inertia(d, to, &I, to->mass, to->h, p);
	to->h = svec_add(d, to->h, svec_scale(d, to->mass, p));
}

/* Into the parent's axes. */
static void turn(struct dag *d, struct composite *c, const struct body *child, const struct joint_pose *at)
{
	struct smat constant = rigid_body_inertia_matrix(&c->constant), varied = rigid_body_inertia_matrix(&c->varied);

	joint_turn_apart(d, child, at, &constant, &varied);
	for (int i = 0; i < 3; i++)
		for (int j = i; j < 3; j++) {
			c->constant.I[inertia_index(i, j)] = constant.m[i][j];
			c->varied.I[inertia_index(i, j)] = varied.m[i][j];
		}
	joint_to_parent_apart(d, child, at, &c->constant.h, &c->varied.h);
}

/* Where p varies, all that it multiplies does. */
static void mix(struct dag *d, struct composite *c, struct svec p)
{
	if (is_constant(d, p.x[0]) && is_constant(d, p.x[1]) && is_constant(d, p.x[2]))
		return;
	for (int i = 0; i < 4; i++) {
		struct ref *from = parameter(&c->constant, i), *to = parameter(&c->varied, i);

		*to = dag_add(d, *from, *to);
		*from = (struct ref){0};
	}
}

void composite_add_child(
	struct dag *d, struct composite *parent, const struct composite *c, const struct body *child, const struct joint_pose *at,
	const struct svec *rate)
{
	struct composite moved = *c;

	if (rate) {
		struct svec h = joint_to_parent(d, child, at, c->p.h);
		struct svec moved_mass = svec_scale(d, c->p.mass, *rate);
		struct svec X = svec_add(d, joint_to_parent(d, child, at, c->P), moved_mass);
		struct smat K = joint_turn(d, child, at, &c->K);

		add_rate(d, &parent->K, &K, h, X, at->p, *rate);
		parent->P = svec_add(d, parent->P, X);
	}
	turn(d, &moved, child, at);
	mix(d, &moved, at->p);
	move_origin(d, &moved.constant, at->p);
	move_origin(d, &moved.varied, at->p);
	add_parameters(d, parent, &moved.constant);
	add_parameters(d, parent, &moved.varied);
}
