#include "mechanics/field.h"

struct wrench field_load(struct dag *d, const struct composite *c, const struct field *x)
{
	struct smat I = rigid_body_inertia_matrix(&c->p);
	struct svec f = svec_add_cross(d, svec_cross(d, x->alpha, c->p.h), x->beta, c->P), n = svec_cross(d, c->p.h, x->gamma);

	/* gravity, in gamma, comes last: it cancels with that of the wrench turned */
	f = svec_add(d, f, svec_scale(d, c->p.mass, x->gamma));
	n = svec_add(d, smat_add_mul(d, smat_mul(d, &I, x->alpha), &c->K, x->beta), n);
	return (struct wrench){f, n};
}

struct row_vectors field_row(struct dag *d, const struct composite *c, struct svec Z, struct svec Y)
{
	struct smat I = rigid_body_inertia_matrix(&c->p);

	return (struct row_vectors){.f2 = svec_add_cross(d, svec_scale(d, c->p.mass, Y), Z, c->p.h),
		.n2 = svec_add_cross(d, smat_mul(d, &I, Z), c->p.h, Y),
		.n1 = svec_add_cross(d, smat_mul_transposed(d, &c->K, Z), c->P, Y)};
}

struct ref field_meet(struct dag *d, const struct row_vectors *s, const struct field *x)
{
	return svec_add_dot(d, svec_add_dot(d, svec_dot(d, s->n2, x->alpha), s->n1, x->beta), s->f2, x->gamma);
}
