#include "norms/norms.h"
#include "norms/adjoint.h"
#include "norms/norms_form.h"
#include <math.h>
#include <string.h>

enum { SETS_OF_A_NODE = 12, MOST_LANES = 256 };

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

/* (c x + s y, c y - s x): cosines and sines change places, and one sign differs. */
static int are_mates(const struct dag *d, const struct trig_term *a, const struct trig_term *b, uint32_t other)
{
	struct trig_term p, q;
	int first = a->sign, second = b->sign, third, fourth;

	if (!is_rotated(d, other, &p, &q) || p.angle != a->angle)
		return 0;
	third = p.sign;
	fourth = q.sign;
	if (dag_bare(d, a->other.i, &first) != dag_bare(d, q.other.i, &fourth) ||
		dag_bare(d, b->other.i, &second) != dag_bare(d, p.other.i, &third))
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
	put(&c, dag_bare(x->d, a->other.i, &sign));
	put(&c, dag_bare(x->d, b->other.i, &sign));
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
		a = dag_bare(x->d, n->arg[0].i, &sign);
		b = dag_bare(x->d, n->arg[1].i, &sign);
		put(&one, a < b ? a : b);
		put(&other, a < b ? b : a);
	}
	s->one = set_of(x, one);
	s->other = set_of(x, other);
	if (!s->one || !s->other)
		s->one = s->other = 0;
}

static int has_mate(const struct norms *x, const struct candidate *c, int at, const struct trig_term *a,
	const struct trig_term *b)
{
	for (int k = 0; k < c->count; k++)
		if (k != at && are_mates(x->d, a, b, c->nodes[k]))
			return 1;
	return 0;
}

static uint32_t set_of_nodes(void *context, const uint32_t *nodes, int count)
{
	struct candidate c = {.count = 0};

	for (int k = 0; k < count; k++)
		put(&c, nodes[k]);
	return set_of(context, c);
}

/* Both values of a rotation in the place of these; else by the latest of its nodes that a rule speaks of. */
static void find_rule(struct norms *x, const struct candidate *c, struct norms_set *s)
{
	struct trig_term a, b;

	for (int k = c->count - 1; k >= 0; k--)
		if (is_rotated(x->d, c->nodes[k], &a, &b) && has_mate(x, c, k, &a, &b)) {
			s->one = unrotate(x, *c, k, &a, &b);
			return;
		}
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

/* A sum of a set that is no rotation's stands apart. */
static void set_apart(struct norms *x, struct candidate c, struct norms_set *s)
{
	struct trig_term a, b;

	for (int k = c.count - 1; k >= 0 && c.count > 1; k--)
		if (is_sum(x->d, c.nodes[k]) && !is_rotated(x->d, c.nodes[k], &a, &b)) {
			s->apart = c.nodes[k];
			drop(&c, k);
			s->rest = set_of(x, c);
			return;
		}
}

static uint32_t *place(const struct norms *x, const struct candidate *c)
{
	uint32_t hash = 2166136261u;

	for (int k = 0; k < c->count; k++)
		hash = (hash ^ c->nodes[k]) * 16777619u;
	for (hash %= x->table_size;; hash = (hash + 1) % x->table_size) {
		uint32_t at = x->table[hash];

		if (!at || (x->sets[at - 1].count == c->count &&
			!memcmp(x->sets[at - 1].nodes, c->nodes, (size_t)c->count * sizeof *c->nodes)))
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
	set_apart(x, c, &s);
	if (c.count == 3)
		s.form = norms_form_find(x->d, x->uses, c.nodes, c.count, set_of_nodes, x, x->arena);
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

int norms_make(struct norms *x, const struct dag *d, int has_lanes, struct arena *a)
{
	struct trig_term p, q;

	*x = (struct norms){.d = d, .lanes = has_lanes ? 1 : 0, .set_limit = SETS_OF_A_NODE * (uint32_t)d->count,
		.table_size = 4 * SETS_OF_A_NODE * (uint32_t)d->count + 7};
	x->sets = arena_alloc(a, x->set_limit, sizeof *x->sets);
	x->table = arena_alloc(a, x->table_size, sizeof *x->table);
	x->order = arena_alloc(a, x->set_limit, sizeof *x->order);
	x->first = arena_alloc(a, d->count + 2, sizeof *x->first);
	x->uses = arena_alloc(a, d->count, sizeof *x->uses);
	x->arena = a;
	if (a->failed)
		return 0;
	for (uint32_t i = 0; i < d->count; i++)
		for (int k = 0; k < op_arity[d->nodes[i].op]; k++)
			x->uses[d->nodes[i].arg[k].i]++;
	for (uint32_t i = 0; i < d->count; i++)
		if (is_rotated(d, i, &p, &q))
			set_of(x, (struct candidate){{i}, 1});
	return 1;
}

uint32_t norms_pair(struct norms *x, uint32_t a, uint32_t b)
{
	struct candidate c = {.count = 0};
	int sign = 1;

	put(&c, dag_bare(x->d, a, &sign));
	put(&c, dag_bare(x->d, b, &sign));
	return set_of(x, c);
}

uint32_t norms_set(struct norms *x, const uint32_t *nodes, int count)
{
	return set_of_nodes(x, nodes, count);
}

/* ---- lanes ---- */

static int input_of(const struct norms *x, const struct node *n)
{
	for (int i = 0; i < x->drive_count + x->rate_count; i++)
		if (x->inputs[i].argument == (int)n->arg[0].i && x->inputs[i].row == (int)n->arg[1].i)
			return i;
	return -1;
}

/* Of role velocity, or all others but q. */
static int list_inputs(struct norms *x, int is_rate, int count)
{
	for (size_t i = 0; i < x->d->count; i++) {
		const struct node *n = &x->d->nodes[i];
		enum role role;

		if (n->op != OP_INPUT)
			continue;
		role = x->d->arguments[n->arg[0].i].role;
		if (role != ROLE_JOINT_POSITION && (role == ROLE_JOINT_VELOCITY) == is_rate) {
			x->inputs[count] = (struct norms_input){(int)n->arg[0].i, (int)n->arg[1].i, 1 + count};
			count++;
		}
	}
	return count;
}

static int form_is_wide(const struct norms *x, const struct norms_form *f)
{
	return f && ((f->x && x->is_wide_set[f->x - 1]) || (f->u && (x->is_wide_set[f->u - 1] || x->is_wide_set[f->v - 1])));
}

static int node_is_wide(const struct norms *x, const struct node *n)
{
	int found = n->op == OP_INPUT && input_of(x, n) >= 0;

	for (int k = 0; k < op_arity[n->op]; k++)
		found |= x->is_wide[n->arg[k].i];
	return found;
}

static int set_is_wide(const struct norms *x, const struct norms_set *s)
{
	int found = form_is_wide(x, s->form) || (s->one && x->is_wide_set[s->one - 1]) ||
		(s->other && x->is_wide_set[s->other - 1]) || (s->rest && x->is_wide_set[s->rest - 1]);

	for (int k = 0; k < s->count; k++)
		found |= x->is_wide[s->nodes[k]];
	return found;
}

int norms_lay(struct norms *x, struct arena *a)
{
	size_t n, most = x->lanes ? MOST_LANES : 0;

	sort(x);
	x->inputs = arena_alloc(a, x->d->count, sizeof *x->inputs);
	x->is_wide = arena_alloc(a, x->d->count, 1);
	x->is_wide_set = arena_alloc(a, (size_t)x->set_count + 1, 1);
	x->at = arena_alloc(a, x->d->count, sizeof *x->at);
	x->set_at = arena_alloc(a, (size_t)x->set_count + 1, sizeof *x->set_at);
	if (a->failed)
		return 0;
	x->drive_count = list_inputs(x, 0, 0);
	n = (size_t)(list_inputs(x, 1, x->drive_count) - x->drive_count);
	x->rate_count = (int)n;
	x->lanes = (1 + (size_t)x->drive_count + n + n * (n + 1) / 2 + 7) / 8 * 8;
	for (uint32_t i = 0; i < x->d->count; i++) {
		x->is_wide[i] = x->lanes <= most && node_is_wide(x, &x->d->nodes[i]);
		x->at[i] = (uint32_t)x->value_count;
		x->value_count += 2 * (x->is_wide[i] ? x->lanes : 1);
	}
	for (uint32_t i = 0; i < x->set_count; i++) {
		x->is_wide_set[i] = (unsigned char)set_is_wide(x, &x->sets[i]);
		x->set_at[i] = (uint32_t)x->norm_count;
		x->norm_count += x->is_wide_set[i] ? x->lanes : 1;
	}
	return 1;
}

/* A square of t is from 0 to 1. */
struct interval norms_range(const struct norms *x, const struct norms_values *v, uint32_t node)
{
	const double *lower = v->bounds + x->at[node], *upper = lower + (x->is_wide[node] ? x->lanes : 1);
	struct interval r = {*lower, *upper};
	size_t at = 1 + (size_t)(x->drive_count + x->rate_count);

	for (size_t i = 1; x->is_wide[node] && i < at; i++) {
		double size = fmax(-lower[i], upper[i]);

		r = interval_add(r, (struct interval){-size, size});
	}
	for (int j = 0; x->is_wide[node] && j < x->rate_count; j++)
		for (int k = j; k < x->rate_count; k++, at++) {
			double size = fmax(-lower[at], upper[at]);

			r = interval_add(r, j == k ? (struct interval){fmin(0, lower[at]), fmax(0, upper[at])}
				: (struct interval){-size, size});
		}
	return r;
}

double *norms_unknown(size_t count, struct arena *a)
{
	double *x = arena_alloc(a, count + 1, sizeof *x);

	for (size_t i = 0; i < count && x; i++)
		x[i] = (double)INFINITY;
	return x;
}
