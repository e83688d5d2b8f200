#include "prove/twins.h"

struct twins_of {
	const struct dag *d;
	const struct adjoint *x;
	struct arena *arena;
};

/* A product of a node with a sine or cosine: c x. */
static int product_of(const struct twins_of *h, uint32_t i, struct trig_term *t)
{
	const struct node *n = &h->d->nodes[i];

	if ((n->op != OP_MUL && n->op != OP_FMA) || !h->x->slope[i].i)
		return 0;
	for (int k = 0; k < 2; k++) {
		const struct node *f = &h->d->nodes[n->arg[k].i];
		struct ref other = h->x->value[n->arg[!k].i];

		if (f->op != OP_SIN && f->op != OP_COS)
			continue;
		other.i = dag_bare(&h->x->d, other.i, NULL);
		*t = (struct trig_term){.angle = f->arg[0].i, .is_sine = f->op == OP_SIN, .other = other};
		return 1;
	}
	return 0;
}

/* c x + s y, the second product in a node of its own. */
static int sum_of(const struct twins_of *h, uint32_t i, struct trig_term *a, struct trig_term *b)
{
	const struct node *n = &h->d->nodes[i];
	uint32_t at;

	if (n->op != OP_FMA || !product_of(h, i, a))
		return 0;
	at = dag_bare(h->d, n->arg[2].i, NULL);
	return h->d->nodes[at].op == OP_MUL && product_of(h, at, b) && a->angle == b->angle && a->is_sine != b->is_sine;
}

static void add_product(const struct twins_of *h, struct view *v, uint32_t i, uint32_t k, struct ref x)
{
	struct twins t = {i, k, 0, norms_pair(&v->norms, h->x->slope[i].i, h->x->slope[k].i), x.i, {0}};

	if (t.slopes)
		v->products[v->product_count++] = t;
}

static void add_sum(const struct twins_of *h, struct view *v, uint32_t i, uint32_t k)
{
	struct twins t = {i, k, norms_pair(&v->norms, h->x->value[i].i, h->x->value[k].i),
		norms_pair(&v->norms, h->x->slope[i].i, h->x->slope[k].i), 0, {0}};

	if (t.slopes && t.values)
		v->sums[v->sum_count++] = t;
}

static void add_angle(const struct twins_of *h, struct view *v, uint32_t i, uint32_t k)
{
	struct twins t = {i, k, 0, norms_pair(&v->norms, h->x->slope[i].i, h->x->slope[k].i), 0, {0}};

	if (t.slopes && shares_find(&t.shares, &v->norms, h->d, h->x, k, i, h->arena))
		v->angles[v->angle_count++] = t;
}

static void find_angles(const struct twins_of *h, struct view *v)
{
	for (uint32_t i = 0; i < h->x->count; i++)
		for (uint32_t k = 0; k < h->x->count && h->d->nodes[i].op == OP_SIN && h->x->slope[i].i; k++)
			if (h->d->nodes[k].op == OP_COS && h->x->slope[k].i && h->d->nodes[k].arg[0].i == h->d->nodes[i].arg[0].i)
				add_angle(h, v, i, k);
}

int twins_find(struct view *v, const struct dag *d, const struct adjoint *x, struct arena *arena)
{
	const struct twins_of of = {d, x, arena}, *h = &of;
	unsigned char *taken = arena_alloc(h->arena, h->x->count, 1);
	struct trig_term a, b, p, q;

	v->products = arena_alloc(h->arena, h->x->count, sizeof *v->products);
	v->sums = arena_alloc(h->arena, h->x->count, sizeof *v->sums);
	for (uint32_t i = 0; i < h->x->count && !h->arena->failed; i++)
		for (uint32_t k = i + 1; k < h->x->count && product_of(h, i, &a) && !(taken[i] & 1); k++)
			if (!(taken[k] & 1) && product_of(h, k, &p) && a.angle == p.angle && a.is_sine != p.is_sine &&
				a.other.i == p.other.i) {
				taken[i] |= 1;
				taken[k] |= 1;
				add_product(h, v, i, k, a.other);
			}
	for (uint32_t i = 0; i < h->x->count && !h->arena->failed; i++)
		for (uint32_t k = i + 1; k < h->x->count && sum_of(h, i, &a, &b) && !(taken[i] & 2); k++)
			if (!(taken[k] & 2) && sum_of(h, k, &p, &q) && a.angle == p.angle &&
				((a.other.i == q.other.i && b.other.i == p.other.i) ||
					(a.other.i == p.other.i && b.other.i == q.other.i))) {
				taken[i] |= 2;
				taken[k] |= 2;
				add_sum(h, v, i, k);
			}
	v->angles = arena_alloc(h->arena, h->x->count, sizeof *v->angles);
	if (!h->arena->failed)
		find_angles(h, v);
	return !h->arena->failed;
}
