#include "quad.h"
#include "reference.h"
#include <stdlib.h>

#define VISIBLE __attribute__((visibility("default")))

struct quad {
	struct reference *reference;
	wide *out;
};

VISIBLE struct quad *quad_open(const char *urdf, size_t length, int floating, int independent, const double gravity[3],
	const char *order, char *message, size_t size)
{
	struct reference_options o = {
		.floating = floating, .independent = independent, .gravity = gravity, .order = order};
	struct quad *x = calloc(1, sizeof *x);

	if (!x)
		abort();
	x->reference = reference_open(urdf, length, &o, message, size);
	if (!x->reference) {
		free(x);
		return NULL;
	}
	x->out = calloc((size_t)x->reference->nv + 1, sizeof *x->out);
	if (!x->out)
		abort();
	return x;
}

VISIBLE void quad_close(struct quad *x)
{
	reference_close(x->reference);
	free(x->out);
	free(x);
}

VISIBLE void quad_rnea(struct quad *x, const double *q, const double *qd, const double *qdd, __float128 *tau)
{
	reference_rnea(x->reference, q, qd, qdd, tau);
}

VISIBLE void quad_magnitude(struct quad *x, const double *q, const double *qd, const double *qdd, double *size)
{
	reference_magnitude(x->reference, q, qd, qdd, x->out);
	for (int i = 0; i < x->reference->nv; i++)
		size[i] = (double)x->out[i];
}
