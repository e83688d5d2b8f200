#ifndef RNEAGEN_NORMS_FORM_H
#define RNEAGEN_NORMS_FORM_H
/* A set of values as sums of multiples of a few others, and of products of two: I w, h x a, w x (w x h). Their norm is at
   most ||A|| |x| for the vector x that is multiplied by a constant matrix A, and ||T|| |u| |v| for the products. */

#include "norms/norms.h"

struct norms_form {
	uint32_t x, u, v; /* 1 + set; 0: there is none, or there are no products */
	double factor;    /* ||A|| */
	double product;   /* ||T|| */
};

/* For a few nodes, in `a`; *set is what makes sets. NULL where there is none, or memory ran out. */
const struct norms_form *norms_form_find(const struct dag *d, const uint32_t *uses, const uint32_t *nodes, int count,
	uint32_t (*set)(void *context, const uint32_t *nodes, int count), void *context, struct arena *a);

/* What it says where these are the norms; in n lanes of x, into `norm`, without products. */
double norms_form_bound(const struct norms_form *f, double x, double u, double v);
void norms_form_lanes(const struct norms_form *f, size_t n, const double *x, double *norm);

#endif
