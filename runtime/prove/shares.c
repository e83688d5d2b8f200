#include "prove/shares.h"

/* A node that reads the sine, or the cosine: sign x slope is its share of the derivative. */
struct use {
	int is_sine, sign, is_taken;
	uint32_t x, slope;
};

struct sharing {
	struct shares *shares;
	struct norms *norms;
	const struct dag *d;
	const struct adjoint *x;
	struct use *uses;
	size_t count;
};

/* The node of the adjoint's DAG without its signs. */
static uint32_t bare(const struct adjoint *x, struct ref a, int *sign)
{
	for (; x->d.nodes[a.i].op == OP_NEG; a = x->d.nodes[a.i].arg[0])
		*sign = -*sign;
	return a.i;
}

/* By what a node multiplies operand k; 0 where it is 1, but for its sign. Returns 0 where its derivative is none of these. */
static int factor_of(const struct sharing *h, const struct node *n, int k, uint32_t *x, int *sign)
{
	*x = 0;
	switch (n->op) {
	case OP_MUL:
	case OP_FMA:
		if (k < 2)
			*x = bare(h->x, h->x->value[n->arg[!k].i], sign);
		return k == 2 || *x;
	case OP_SUB:
		*sign = k ? -*sign : *sign;
		return 1;
	case OP_ADD:
		return 1;
	default:
		return 0;
	}
}

/* Of node `of`, which is the sine or the cosine, or minus that. */
static int list_uses(struct sharing *h, uint32_t of, int is_sine, int sign)
{
	for (uint32_t i = 0; i < h->x->count; i++)
		for (int k = 0; k < op_arity[h->d->nodes[i].op] && h->x->slope[i].i; k++) {
			const struct node *n = &h->d->nodes[i];
			struct use u = {.is_sine = is_sine, .sign = sign};

			if (n->arg[k].i != of)
				continue;
			if (n->op == OP_NEG || n->op == OP_ANEW) {
				if (!list_uses(h, i, is_sine, n->op == OP_NEG ? -sign : sign))
					return 0;
				continue;
			}
			u.slope = bare(h->x, h->x->slope[i], &u.sign);
			if (!factor_of(h, n, k, &u.x, &u.sign))
				return 0;
			h->uses[h->count++] = u;
		}
	return 1;
}

static void add(struct sharing *h, struct share t, struct use *const *of, int count)
{
	h->shares->list[h->shares->count++] = t;
	for (int i = 0; i < count; i++)
		of[i]->is_taken = 1;
}

/* The use that is left of the other one of sine and cosine with this factor and slope, 0: any of them but 1. */
static struct use *find(struct sharing *h, const struct use *beside, int is_sine, uint32_t x, uint32_t slope)
{
	for (size_t i = 0; i < h->count; i++) {
		struct use *u = &h->uses[i];

		if (u != beside && !u->is_taken && u->is_sine == is_sine && u->x && (!x || u->x == x) &&
			(!slope || u->slope == slope))
			return u;
	}
	return NULL;
}

/* c x v, s y v, c y w, s x w, where the product of all signs is -1. */
static void add_four(struct sharing *h, struct use *a)
{
	for (size_t i = 0; i < h->count; i++) {
		struct use *b = &h->uses[i], *c, *d;
		struct share t = {0};

		if (a->is_taken || !a->x || b->is_taken || b->is_sine == a->is_sine || b->slope != a->slope || !b->x ||
			b->x == a->x)
			continue;
		for (size_t k = 0; k < h->count; k++) {
			c = &h->uses[k];
			if (c->is_taken || c->is_sine != a->is_sine || c->x != b->x || c->slope == a->slope)
				continue;
			d = find(h, NULL, !a->is_sine, a->x, c->slope);
			if (!d || a->sign * b->sign * c->sign * d->sign > 0)
				continue;
			t.values = norms_pair(h->norms, a->x, b->x);
			t.slopes = norms_pair(h->norms, a->slope, c->slope);
			if (t.values && t.slopes) {
				add(h, t, (struct use *[]){a, b, c, d}, 4);
				return;
			}
		}
	}
}

static void add_two(struct sharing *h, struct use *a)
{
	struct use *b;
	struct share t = {.x = a->x, .slope = a->slope};

	if (a->is_taken || !a->x)
		return;
	b = find(h, a, !a->is_sine, a->x, 0);
	if (b && b->slope != a->slope && (t.slopes = norms_pair(h->norms, a->slope, b->slope))) {
		add(h, t, (struct use *[]){a, b}, 2);
		return;
	}
	b = find(h, a, !a->is_sine, 0, a->slope);
	if (b && b->x != a->x && (t.values = norms_pair(h->norms, a->x, b->x)))
		add(h, t, (struct use *[]){a, b}, 2);
}

int shares_find(struct shares *t, struct norms *norms, const struct dag *d, const struct adjoint *x, uint32_t cosine,
	uint32_t sine, struct arena *arena)
{
	struct sharing h = {t, norms, d, x, arena_alloc(arena, 3 * (size_t)x->count, sizeof *h.uses), 0};

	*t = (struct shares){arena_alloc(arena, 3 * (size_t)x->count, sizeof *t->list), 0};
	if (arena->failed)
		return 0;
	if (!list_uses(&h, cosine, 0, 1) || !list_uses(&h, sine, 1, 1))
		return 1;
	for (size_t i = 0; i < h.count; i++)
		add_four(&h, &h.uses[i]);
	for (size_t i = 0; i < h.count; i++)
		add_two(&h, &h.uses[i]);
	for (size_t i = 0; i < h.count; i++)
		if (!h.uses[i].is_taken)
			add(&h, (struct share){.x = h.uses[i].x, .slope = h.uses[i].slope}, (struct use *[]){&h.uses[i]}, 1);
	return 1;
}

double shares_of(const struct share *t, const struct norms *norms, const struct norms_values *v)
{
	double values = t->values ? norms_of_pair(norms, v, t->values) : t->x ? v->size[t->x] : 1;

	return values * (t->slopes ? norms_of_pair(norms, v, t->slopes) : v->size[t->slope]);
}

double shares_length(const struct shares *t, const struct norms *norms, const struct norms_values *v)
{
	double sum = 0;

	for (size_t i = 0; i < t->count; i++)
		sum += shares_of(&t->list[i], norms, v);
	return t->count && sum >= 0 ? sum * (1 + 0x1p-30) : (double)INFINITY;
}
