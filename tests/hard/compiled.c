#include "compiled.h"
#include <check.h>
#include <stdlib.h>

static void open_arrays(struct compiled *x)
{
	for (int i = 0; i < 3; i++) {
		x->in[i] = array_new(x->target.f32, (size_t)(i ? x->nv : x->nq));
		x->state[i] = numbers_new(i ? x->nv : x->nq, sizeof(double));
	}
	x->tau = array_new(x->target.f32, (size_t)x->nv);
	x->eval = numbers_new(x->nv, sizeof(double));
	x->noise = numbers_new(x->nv, sizeof(double));
	x->reference = numbers_new(x->nv, sizeof(__float128));
}

void compiled_open(struct compiled *x, const struct hard_case *c, const struct rneagen_options *how,
	const struct compiler *compiler, const char *stem)
{
	struct rneagen_options o;
	char message[256];

	*x = (struct compiled){0};
	hard_open(&x->hard, c);
	o = x->hard.options;
	o.target = RNEAGEN_TARGET_C;
	o.precision = how->precision;
	o.trig = how->trig;
	o.strict = how->strict;
	o.bounded = how->bounded;
	x->nq = x->hard.model.tree.nq;
	x->nv = x->hard.model.tree.nv;
	target_open(&x->target, x->hard.urdf, x->hard.length, &o, compiler, stem);
	x->quad = quad_open(
		x->hard.urdf, x->hard.length, c->floating, 0, QUAD_DECIMALS, o.gravity, NULL, message, sizeof message);
	ck_assert_msg(x->quad != NULL, "%s: %s", c->name, message);
	open_arrays(x);
}

void compiled_close(struct compiled *x)
{
	for (int i = 0; i < 3; i++) {
		array_free(&x->in[i]);
		free(x->state[i]);
	}
	array_free(&x->tau);
	free(x->eval);
	free(x->noise);
	free(x->reference);
	quad_close(x->quad);
	target_close(&x->target);
	hard_close(&x->hard);
}

void compiled_sample(struct compiled *x, struct rng *rng)
{
	hard_sample(&x->hard, rng, x->target.f32, x->state[0], x->state[1], x->state[2]);
}

void compiled_set(struct compiled *x)
{
	for (int i = 0; i < 3; i++)
		for (int k = 0; k < (i ? x->nv : x->nq); k++)
			array_set(&x->in[i], (size_t)k, x->state[i][k]);
}

void compiled_refer(struct compiled *x)
{
	quad_rnea(x->quad, x->state[0], x->state[1], x->state[2], x->reference);
	quad_magnitude(x->quad, x->state[0], x->state[1], x->state[2], x->noise);
}
