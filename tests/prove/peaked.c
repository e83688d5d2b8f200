#define _POSIX_C_SOURCE 200809L
#include "prove/peaked.h"
#include "core/seconds.h"
#include "dag/eval.h"
#include "peaks/caps.h"
#include <check.h>
#include <math.h>
#include <stdlib.h>

static const double PI = 3.14159265358979323846;

static void add(struct peaked *c, uint32_t node, uint32_t pair)
{
	struct peak *k = &c->p.list[c->p.count++];

	*k = (struct peak){.nodes = {node, node},
		.pair = pair,
		.weight = 1,
		.most = pair ? norms_of_pair(&c->norms, &c->values, pair) : c->values.size[node]};
	for (int n = 0; n < 2 && pair; n++)
		k->nodes[n] = c->norms.sets[pair - 1].nodes[n];
}

static void list_all(struct peaked *c)
{
	c->p.list = arena_alloc(&c->x.arena, c->adjoint.d.count + c->norms.set_count, sizeof *c->p.list);
	ck_assert_ptr_nonnull(c->p.list);
	for (uint32_t i = 1; i < c->adjoint.d.count; i += 3)
		add(c, i, 0);
	for (uint32_t k = 0; k < c->norms.set_count; k++)
		if (c->norms.sets[k].count == 2)
			add(c, 0, k + 1);
}

void peaked_open(struct peaked *c, const char *name, const char *scene, size_t output, double seconds)
{
	const struct dag *d;
	struct arena *a = &c->x.arena;
	struct caps caps;

	*c = (struct peaked){0};
	robot_box_open(&c->x, name, scene, 0);
	d = &c->x.analysis.dag;
	ck_assert(adjoint_make(&c->adjoint, d, output, 1, a) && norms_make(&c->norms, &c->adjoint.d, 0, a) &&
		  norms_lay(&c->norms, a) && norms_values_make(&c->values, &c->norms, a));
	ck_assert(d->arguments[0].role == ROLE_JOINT_POSITION);
	norms_evaluate(&c->norms, (const struct interval *const *)c->x.box.rows, &c->values);
	c->p = (struct peaks){.text = d,
		.output = output,
		.x = &c->adjoint,
		.norms = &c->norms,
		.values = &c->values,
		.rows = (const struct interval *const *)c->x.box.rows,
		.dims = c->dims,
		.deadline = 0,
		.arena = a};
	for (; c->p.dim_count < d->arguments[0].rows; c->p.dim_count++)
		c->dims[c->p.dim_count] = c->p.dim_count;
	ck_assert(box_copy(c->rows, &c->x.box, d, a));
	caps = (struct caps){c->rows, c->rows[0], c->dims, c->p.dim_count, (double)INFINITY};
	ck_assert(caps_find(&caps, &c->norms, &c->values, a));
	norms_evaluate(&c->norms, c->p.rows, &c->values);
	list_all(c);
	c->p.deadline = seconds_now() + seconds;
	ck_assert(peaks_find(&c->p));
	c->v = arena_alloc(a, c->adjoint.d.count, sizeof *c->v);
	for (int i = 0; i < d->argument_count; i++)
		c->in[i] = arena_alloc(a, (size_t)d->arguments[i].rows + 1, sizeof(double));
}

void peaked_evaluate(struct peaked *c)
{
	const struct dag *d = &c->adjoint.d;

	for (size_t i = 0; i < d->count; i++)
		c->v[i] = d->nodes[i].op == OP_INPUT ? c->in[d->nodes[i].arg[0].i][d->nodes[i].arg[1].i]
						     : eval_node(&d->nodes[i], c->v);
}

void peaked_draw(struct peaked *c, struct rng *r, int is_whole)
{
	const struct dag *d = &c->x.analysis.dag;
	int is_corner = rng_chance(r, 0.7);

	for (int i = 0; i < d->argument_count; i++)
		for (int k = 0; k < d->arguments[i].rows && c->x.box.rows[i]; k++) {
			struct interval all = c->x.box.rows[i][k];

			c->in[i][k] = i && is_corner ? rng_chance(r, 0.5) ? all.lower : all.upper
						     : rng_uniform(r, all.lower, all.upper);
			if (i == 0 && is_whole && c->p.is_angle[k])
				c->in[i][k] = rng_uniform(r, -PI, PI);
		}
}
