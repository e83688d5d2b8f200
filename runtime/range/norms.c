#include "range/norms.h"
#include "range/adjoint.h"
#include <math.h>
#include <string.h>

enum { SETS_OF_A_NODE = 12 };

struct candidate {
	uint32_t nodes[2 * NORMS_SET];
	int count;
};

/* ---- sets ---- */

static void put(struct candidate *c, uint32_t node)
{
	int at = c->count++;

	for (; at > 0 && c->nodes[at - 1] > node; at--)
		c->nodes[at] = c->nodes[at - 1];
	c->nodes[at] = node;
}

static void drop(struct candidate *c, int at)
{
	memmove(&c->nodes[at], &c->nodes[at + 1], (size_t)(--c->count - at) * sizeof *c->nodes);
}

/* Is it c x + s y with any signs? */
static int is_rotated(const struct dag *d, uint32_t i, struct trig_term *a, struct trig_term *b)
{
	const struct node *n = &d->nodes[i];

	if ((n->op != OP_ADD && n->op != OP_SUB) || !trig_term(d, n->arg[0], a) || !trig_term(d, n->arg[1], b))
		return 0;
	b->sign = n->op == OP_SUB ? -b->sign : b->sign;
	if (a->is_sine) {
		struct trig_term t = *a;

		*a = *b;
		*b = t;
	}
	return a->angle == b->angle && !a->is_sine && b->is_sine;
}

/* The node without its signs, which are gathered in *sign. */
static uint32_t bare(const struct dag *d, uint32_t i, int *sign)
{
	for (; d->nodes[i].op == OP_NEG; i = d->nodes[i].arg[0].i)
		*sign = -*sign;
	return i;
}

/* (c x + s y, c y - s x): cosines and sines change places, and one sign differs. */
static int are_mates(const struct dag *d, const struct trig_term *a, const struct trig_term *b, uint32_t other)
{
	struct trig_term p, q;
	int first = a->sign, second = b->sign, third, fourth;

	if (!is_rotated(d, other, &p, &q) || p.angle != a->angle)
		return 0;
	third = p.sign;
	fourth = q.sign;
	if (bare(d, a->other.i, &first) != bare(d, q.other.i, &fourth) || bare(d, b->other.i, &second) != bare(d, p.other.i, &third))
		return 0;
	return first * second == -third * fourth;
}

static uint32_t set_of(struct norms *x, struct candidate c);

/* The set with x and y in the place of a rotated node and of its mate. */
static uint32_t unrotate(struct norms *x, struct candidate c, int at, const struct trig_term *a, const struct trig_term *b)
{
	int sign = 1;

	for (int k = 0; k < c.count; k++)
		if (k != at && are_mates(x->d, a, b, c.nodes[k])) {
			drop(&c, k);
			at -= k < at;
			break;
		}
	drop(&c, at);
	put(&c, bare(x->d, a->other.i, &sign));
	put(&c, bare(x->d, b->other.i, &sign));
	return set_of(x, c);
}

static int is_sum(const struct dag *d, uint32_t i)
{
	return d->nodes[i].op == OP_ADD || d->nodes[i].op == OP_SUB;
}

/* The terms that stood first, which come from further away, and the others. */
static void split(struct norms *x, const struct candidate *c, struct norms_set *s)
{
	struct candidate one = {.count = 0}, other = {.count = 0};
	int sign = 1;

	for (int k = 0; k < c->count; k++) {
		const struct node *n = &x->d->nodes[c->nodes[k]];
		uint32_t a, b;

		if (!is_sum(x->d, c->nodes[k])) {
			put(&one, c->nodes[k]);
			continue;
		}
		a = bare(x->d, n->arg[0].i, &sign);
		b = bare(x->d, n->arg[1].i, &sign);
		put(&one, a < b ? a : b);
		put(&other, a < b ? b : a);
	}
	s->one = set_of(x, one);
	s->other = set_of(x, other);
	if (!s->one || !s->other)
		s->one = s->other = 0;
}

/* By the latest of its nodes that a rule speaks of. */
static void find_rule(struct norms *x, const struct candidate *c, struct norms_set *s)
{
	struct trig_term a, b;

	for (int k = c->count - 1; k >= 0; k--) {
		if (is_rotated(x->d, c->nodes[k], &a, &b)) {
			s->one = unrotate(x, *c, k, &a, &b);
			return;
		}
		if (is_sum(x->d, c->nodes[k])) {
			split(x, c, s);
			return;
		}
	}
}

static uint32_t *place(const struct norms *x, const struct candidate *c)
{
	uint32_t hash = 2166136261u;

	for (int k = 0; k < c->count; k++)
		hash = (hash ^ c->nodes[k]) * 16777619u;
	for (hash %= x->table_size;; hash = (hash + 1) % x->table_size) {
		uint32_t at = x->table[hash];

		if (!at || (x->sets[at - 1].count == c->count && !memcmp(x->sets[at - 1].nodes, c->nodes, (size_t)c->count * sizeof *c->nodes)))
			return &x->table[hash];
	}
}

/* 1 + the set; 0: it is too large, or there are too many. */
static uint32_t set_of(struct norms *x, struct candidate c)
{
	struct norms_set s = {.count = c.count};
	uint32_t *at;

	if (c.count > NORMS_SET || c.count == 0 || x->set_count >= x->set_limit)
		return 0;
	at = place(x, &c);
	if (*at)
		return *at;
	memcpy(s.nodes, c.nodes, (size_t)c.count * sizeof *c.nodes);
	s.last = c.nodes[c.count - 1];
	find_rule(x, &c, &s);
	if (x->set_count >= x->set_limit)
		return 0;
	x->sets[x->set_count++] = s;
	return *place(x, &c) = x->set_count;
}

/* By the latest node, those that others need first. */
static void sort(struct norms *x)
{
	for (uint32_t i = 0; i < x->set_count; i++)
		x->first[x->sets[i].last + 1]++;
	for (size_t i = 0; i < x->d->count; i++)
		x->first[i + 1] += x->first[i];
	for (uint32_t i = x->set_count; i-- > 0;)
		x->order[--x->first[x->sets[i].last + 1]] = i;
	/* first[i + 1] is now where node i begins */
	memmove(x->first, x->first + 1, x->d->count * sizeof *x->first);
	x->first[x->d->count] = x->set_count;
}

int norms_make(struct norms *x, const struct dag *d, struct arena *a)
{
	struct trig_term p, q;

	*x = (struct norms){.d = d, .set_limit = SETS_OF_A_NODE * (uint32_t)d->count, .table_size = 4 * SETS_OF_A_NODE * (uint32_t)d->count + 7};
	x->sets = arena_alloc(a, x->set_limit, sizeof *x->sets);
	x->table = arena_alloc(a, x->table_size, sizeof *x->table);
	x->order = arena_alloc(a, x->set_limit, sizeof *x->order);
	x->first = arena_alloc(a, d->count + 2, sizeof *x->first);
	if (a->failed)
		return 0;
	for (uint32_t i = 0; i < d->count; i++)
		if (is_rotated(d, i, &p, &q))
			set_of(x, (struct candidate){{i}, 1});
	sort(x);
	return 1;
}

/* ---- evaluating ---- */

static struct interval value_of(const struct dag *d, const struct node *n, const struct interval *v, const struct interval *const *rows)
{
	struct interval a = v[op_arity[n->op] > 0 ? n->arg[0].i : 0], b = v[op_arity[n->op] > 1 ? n->arg[1].i : 0];

	switch (n->op) {
	case OP_CONST:
		return interval_around(n->value, within_error(dag_number(d, n)));
	case OP_INPUT:
		return rows[n->arg[0].i][n->arg[1].i];
	case OP_NEG:
		return interval_neg(a);
	case OP_ADD:
		return interval_add(a, b);
	case OP_SUB:
		return interval_sub(a, b);
	case OP_MUL:
		return interval_mul(a, b);
	case OP_SIN:
		return interval_sin(a);
	case OP_COS:
		return interval_cos(a);
	default:
		return (struct interval){-(double)INFINITY, (double)INFINITY};
	}
}

static double norm_of(const struct norms *x, const struct norms_set *s, const struct interval *v, const double *norm)
{
	double sum = 0, by_rule = (double)INFINITY;

	for (int k = 0; k < s->count; k++)
		sum += interval_size(v[s->nodes[k]]) * interval_size(v[s->nodes[k]]);
	if (s->one)
		by_rule = norm[s->one] + (s->other ? norm[s->other] : 0);
	(void)x;
	return fmin(sqrt(sum), by_rule) * (1 + 0x1p-48);
}

void norms_evaluate(const struct norms *x, const struct interval *const *rows, struct interval *v, double *norm)
{
	for (uint32_t i = 0; i < x->d->count; i++) {
		v[i] = value_of(x->d, &x->d->nodes[i], v, rows);
		for (uint32_t k = x->first[i]; k < x->first[i + 1]; k++) {
			const struct norms_set *s = &x->sets[x->order[k]];
			double most = norm[x->order[k] + 1] = norm_of(x, s, v, norm);

			if (s->count == 1) {
				v[i].lower = fmax(v[i].lower, -most);
				v[i].upper = fmin(v[i].upper, most);
			}
		}
	}
}
