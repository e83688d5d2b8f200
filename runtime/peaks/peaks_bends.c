/* First and second derivatives by rows of q as expressions, bounded by norms. A rotation p = c x + s y is turned
   further by its own angle: dp = c (dx + y) + s (dy - x), which with r = c y - s x stays a rotation of two values. */
#define _POSIX_C_SOURCE 200809L
#include "core/seconds.h"
#include "peaks/peaks.h"
#include <math.h>
#include <string.h>

/* Of what is made of the adjoint's nodes by one row of q. */
struct bending {
	const struct peaks *p;
	int dim; /* of p->dims */
	struct adjoint x;
	struct norms norms;
	struct norms_values values;
	struct ref *first, *second; /* by node of the adjoint */
	uint32_t *pairs;	    /* by peak */
	uint32_t *known;	    /* by set of the adjoint's: the same here */
	unsigned char *live;
	struct arena arena;
};

/* ---- expressions ---- */

static struct ref sum(struct dag *d, int sign, struct ref a, int other_sign, struct ref b)
{
	if (sign < 0 && other_sign < 0)
		return dag_neg(d, dag_add(d, a, b));
	if (sign < 0)
		return dag_sub(d, b, a);
	return other_sign < 0 ? dag_sub(d, a, b) : dag_add(d, a, b);
}

/* The derivative of c x + s y, dot[] those of all before; is_own: by its own angle. */
static struct ref turn(
	struct dag *d, const struct trig_term *c, const struct trig_term *s, const struct ref *dot, int is_own)
{
	struct ref dx = dot[c->other.i], dy = dot[s->other.i], angle = {c->angle};
	struct ref x = is_own ? sum(d, c->sign, dx, s->sign, s->other) : sum(d, c->sign, dx, 1, (struct ref){0});
	struct ref y = is_own ? sum(d, s->sign, dy, -c->sign, c->other) : sum(d, s->sign, dy, 1, (struct ref){0});

	return dag_add(d, dag_mul(d, dag_cos(d, angle), x), dag_mul(d, dag_sin(d, angle), y));
}

static int is_rotation(const struct dag *d, const struct node *n, struct trig_term *c, struct trig_term *s)
{
	struct trig_term t;

	if ((n->op != OP_ADD && n->op != OP_SUB) || !trig_term(d, n->arg[0], c) || !trig_term(d, n->arg[1], s))
		return 0;
	s->sign = n->op == OP_SUB ? -s->sign : s->sign;
	if (c->is_sine) {
		t = *c;
		*c = *s;
		*s = t;
	}
	return c->angle == s->angle && !c->is_sine && s->is_sine;
}

static struct ref derivative(const struct bending *b, struct dag *d, uint32_t i, const struct ref *dot)
{
	const struct node n = d->nodes[i]; /* a copy: nodes move as they grow in number */
	struct trig_term c, s;

	if (is_rotation(d, &n, &c, &s))
		return turn(d, &c, &s, dot, dot[c.angle].i != 0);
	switch (n.op) {
	case OP_INPUT:
		return dag_const(d, (int)n.arg[0].i == b->p->position && (int)n.arg[1].i == b->p->dims[b->dim]);
	case OP_NEG:
		return dag_neg(d, dot[n.arg[0].i]);
	case OP_ADD:
		return dag_add(d, dot[n.arg[0].i], dot[n.arg[1].i]);
	case OP_SUB:
		return dag_sub(d, dot[n.arg[0].i], dot[n.arg[1].i]);
	case OP_MUL:
		return dag_add(d, dag_mul(d, dot[n.arg[0].i], n.arg[1]), dag_mul(d, n.arg[0], dot[n.arg[1].i]));
	case OP_SIN:
		return dag_mul(d, dot[n.arg[0].i], dag_cos(d, n.arg[0]));
	case OP_COS:
		return dag_neg(d, dag_mul(d, dot[n.arg[0].i], dag_sin(d, n.arg[0])));
	default:
		return (struct ref){0}; /* constants; others are of no peak that is known */
	}
}

/* Of live nodes; those that it makes are live too. */
static struct ref *derive(struct bending *b, const unsigned char *live, size_t count)
{
	struct ref *dot = arena_alloc(&b->arena, count, sizeof *dot);

	for (uint32_t i = 1; i < count && dot && !b->x.d.failed; i++)
		if (live[i])
			dot[i] = derivative(b, &b->x.d, i, dot);
	return dot;
}

static int is_asked(const struct bending *b, const struct peak *k)
{
	return peak_is_asked(k) && k->dims >> b->dim & 1;
}

/* What peaks are made of; of their derivatives too where `dot` has them. */
static unsigned char *mark(struct bending *b, const struct ref *dot)
{
	unsigned char *live = arena_alloc(&b->arena, b->x.d.count, 1);

	for (size_t i = 0; i < b->p->count && live; i++)
		for (int k = 0; k < 2 && is_asked(b, &b->p->list[i]); k++)
			live[dot ? dot[b->p->list[i].nodes[k]].i : b->p->list[i].nodes[k]] = 1;
	if (live)
		dag_mark_operands(&b->x.d, b->x.d.count, live);
	return live;
}

static int derive_twice(struct bending *b)
{
	size_t count = b->p->x->d.count;
	unsigned char *live;
	struct ref *all;

	if (!adjoint_make(&b->x, b->p->text, b->p->output, 1, &b->arena) || b->x.d.count != count ||
		!(live = mark(b, NULL)) || !(b->first = derive(b, live, count)) || !(live = mark(b, b->first)) ||
		!(all = derive(b, live, b->x.d.count)) ||
		!(b->second = arena_alloc(&b->arena, count, sizeof *b->second)))
		return 0;
	for (size_t i = 0; i < count; i++)
		b->second[i] = all[b->first[i].i];
	return !b->x.d.failed;
}

/* ---- bounds ---- */

/* Of the derivatives of[node]; `pair` is their set, 0: there is none. */
static double length_of(const struct bending *b, const struct peak *k, const struct ref *of, uint32_t pair)
{
	double sum = 0;

	for (int n = 0; n < (k->pair ? 2 : 1); n++)
		sum += b->values.size[of[k->nodes[n]].i] * b->values.size[of[k->nodes[n]].i];
	sum = sqrt(sum) * (1 + 0x1p-40) + SQUARES_LOST;
	if (pair)
		sum = interval_least(norms_of_pair(&b->norms, &b->values, pair), sum);
	return sum >= 0 ? sum : (double)INFINITY;
}

static int make_norms(struct bending *b)
{
	const struct peaks *p = b->p;

	b->pairs = arena_alloc(&b->arena, p->count + 1, sizeof *b->pairs);
	b->known = arena_alloc(&b->arena, (size_t)p->norms->set_count + 1, sizeof *b->known);
	if (b->arena.failed || !norms_make(&b->norms, &b->x.d, 0, &b->arena))
		return 0;
	for (size_t i = 0; i < p->count; i++)
		if (p->list[i].pair && is_asked(b, &p->list[i]))
			b->pairs[i] = norms_pair(
				&b->norms, b->second[p->list[i].nodes[0]].i, b->second[p->list[i].nodes[1]].i);
	for (uint32_t k = 0; k < p->norms->set_count; k++)
		b->known[k] = norms_set(&b->norms, p->norms->sets[k].nodes, p->norms->sets[k].count);
	return norms_lay(&b->norms, &b->arena) && norms_values_make(&b->values, &b->norms, &b->arena);
}

/* Over the box alone, where what is known of the adjoint's nodes and sets holds for them here. */
static int evaluate_near(struct bending *b)
{
	const struct peaks *p = b->p;

	b->values.most = norms_unknown(b->x.d.count, &b->arena);
	b->values.most_norm = norms_unknown(b->norms.set_count, &b->arena);
	if (b->arena.failed)
		return 0;
	for (size_t i = 0; i < p->x->d.count && p->values->most; i++)
		b->values.most[i] = p->values->most[i];
	for (uint32_t k = 0; k < p->norms->set_count && p->values->most_norm; k++)
		if (b->known[k])
			b->values.most_norm[b->known[k] - 1] = p->values->most_norm[k];
	norms_evaluate(&b->norms, p->rows, &b->values);
	return 1;
}

static int take_bends(struct bending *b)
{
	struct peak *list = b->p->list;

	norms_evaluate(&b->norms, (const struct interval *const *)b->p->whole_rows, &b->values);
	for (size_t i = 0; i < b->p->count; i++)
		if (is_asked(b, &list[i])) {
			list[i].tilts[b->dim] = length_of(b, &list[i], b->first, 0);
			list[i].bends[b->dim] = length_of(b, &list[i], b->second, b->pairs[i]);
		}
	if (!evaluate_near(b))
		return 0;
	for (size_t i = 0; i < b->p->count; i++)
		if (is_asked(b, &list[i]))
			list[i].near[b->dim] = length_of(b, &list[i], b->second, b->pairs[i]);
	return 1;
}

int peaks_bends(struct peaks *p, double deadline)
{
	int done = 1;

	for (size_t i = 0; i < p->count; i++)
		for (int k = 0; k < p->dim_count; k++)
			p->list[i].tilts[k] = p->list[i].bends[k] = p->list[i].near[k] =
				p->list[i].dims >> k & 1 ? (double)INFINITY : 0;
	for (int k = 0; k < p->dim_count && done && seconds_now() < deadline; k++) {
		struct bending b = {.p = p, .dim = k};

		arena_init(&b.arena, NULL);
		done = derive_twice(&b) && make_norms(&b) && take_bends(&b);
		arena_free(&b.arena);
	}
	return done;
}
