#include "mechanics/field.h"

struct wrench field_load(struct dag *d, const struct composite *c, const struct field *x)
{
	struct wrench w;

	w.f = svec_add(d, svec_cross(d, x->alpha, c->p.h), svec_cross(d, x->beta, c->P));
	w.f = svec_add(d, w.f, svec_scale(d, c->p.mass, x->gamma));
	w.n = svec_add(d, rigid_body_inertia_times(d, &c->p, x->alpha), smat_mul(d, &c->K, x->beta));
	w.n = svec_add(d, w.n, svec_cross(d, c->p.h, x->gamma));
	return w;
}

struct row_vectors field_row(struct dag *d, const struct composite *c, struct svec Z, struct svec Y)
{
	return (struct row_vectors){.f2 = svec_add(d, svec_cross(d, Z, c->p.h), svec_scale(d, c->p.mass, Y)),
		.n2 = svec_add(d, rigid_body_inertia_times(d, &c->p, Z), svec_cross(d, c->p.h, Y)),
		.n1 = svec_add(d, smat_mul_transposed(d, &c->K, Z), svec_cross(d, c->P, Y))};
}

struct ref field_meet(struct dag *d, const struct row_vectors *s, const struct field *x)
{
	struct ref sum = dag_add(d, svec_dot(d, s->n2, x->alpha), svec_dot(d, s->n1, x->beta));

	return dag_add(d, sum, svec_dot(d, s->f2, x->gamma));
}
