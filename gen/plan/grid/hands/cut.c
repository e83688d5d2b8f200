/* A node is two places, one where paths come in and one where they go out, with room for one path between them. A search goes
   along edges that have no path, and back along those that have one. */
#include "plan/grid/hands/cut.h"
#include <string.h>

enum { NONE = 0 }; /* node 0 is a constant */

/* Twice the node, and one more for the place where paths go out. */
typedef uint32_t place;

struct network {
	const struct dag *d;
	const unsigned char *from, *to;
	unsigned char *between;  /* by node: from one of `from` a way leads over it to one of `to` */
	uint32_t *begin, *users; /* by node: where its users begin in the list; it is an operand of them */
	uint32_t *next, *last;   /* by node: the one after it in its path, and the one before it */
	unsigned char *taken;    /* by node: a path goes over it */
	place *came, *queue;     /* by place: 1 + the place that it was reached from, its own for a beginning; 0: not reached */
	uint32_t reached;
};

static place in(uint32_t node)
{
	return 2 * node;
}

static place out(uint32_t node)
{
	return 2 * node + 1;
}

static void mark(struct network *n)
{
	const struct dag *d = n->d;

	for (size_t i = 0; i < d->count; i++) {
		n->between[i] = n->from[i];
		for (int k = 0; k < op_arity[d->nodes[i].op]; k++)
			n->between[i] |= n->between[d->nodes[i].arg[k].i];
	}
	memcpy(n->taken, n->to, d->count);
	dag_mark_operands(d, d->count, n->taken);
	for (size_t i = 0; i < d->count; i++) {
		n->between[i] &= n->taken[i];
		n->taken[i] = 0;
	}
}

/* Each node's list is filled from its end, where `begin` is at first. */
static void list_users(struct network *n)
{
	const struct dag *d = n->d;

	for (size_t i = 0; i < d->count; i++)
		for (int k = 0; k < op_arity[d->nodes[i].op] && n->between[i]; k++)
			n->begin[d->nodes[i].arg[k].i]++;
	for (size_t i = 0; i < d->count; i++)
		n->begin[i + 1] += n->begin[i];
	for (size_t i = d->count; i-- > 0;)
		for (int k = 0; k < op_arity[d->nodes[i].op] && n->between[i]; k++)
			n->users[--n->begin[d->nodes[i].arg[k].i]] = (uint32_t)i;
}

static int network_make(struct network *n, const struct dag *d, const unsigned char *from, const unsigned char *to,
	struct arena *a)
{
	*n = (struct network){.d = d, .from = from, .to = to, .between = arena_alloc(a, d->count, 1),
		.begin = arena_alloc(a, d->count + 1, sizeof *n->begin), .users = arena_take(a, 3 * d->count, sizeof *n->users),
		.next = arena_alloc(a, d->count, sizeof *n->next), .last = arena_alloc(a, d->count, sizeof *n->last),
		.taken = arena_alloc(a, d->count, 1), .came = arena_alloc(a, 2 * d->count, sizeof *n->came),
		.queue = arena_take(a, 2 * d->count, sizeof *n->queue)};
	if (a->failed)
		return 0;
	mark(n);
	list_users(n);
	return 1;
}

static void reach(struct network *n, place p, place from)
{
	if (n->came[p])
		return;
	n->came[p] = from + 1;
	n->queue[n->reached++] = p;
}

static void reach_from(struct network *n, place p)
{
	uint32_t node = p / 2;

	if (p == in(node)) {
		if (!n->taken[node])
			reach(n, out(node), p);
		else if (n->last[node] != NONE)
			reach(n, out(n->last[node]), p);
		return;
	}
	if (n->taken[node])
		reach(n, in(node), p);
	for (uint32_t k = n->begin[node]; k < n->begin[node + 1]; k++)
		if (n->next[node] != n->users[k])
			reach(n, in(n->users[k]), p);
}

/* Returns where a path leaves one of `to`; NONE: there is none. */
static place search(struct network *n)
{
	n->reached = 0;
	memset(n->came, 0, 2 * n->d->count * sizeof *n->came);
	for (uint32_t i = 0; i < n->d->count; i++)
		if (n->from[i] && n->between[i])
			reach(n, in(i), in(i));
	for (uint32_t k = 0; k < n->reached; k++) {
		place p = n->queue[k];

		if (p == out(p / 2) && n->to[p / 2] && (!n->taken[p / 2] || n->next[p / 2] != NONE))
			return p;
		reach_from(n, p);
	}
	return NONE;
}

/* A step of the path: what it goes along is taken, what it goes back along is not any more. */
static void step(struct network *n, place a, place b)
{
	uint32_t x = a / 2, y = b / 2;

	if (x == y) {
		n->taken[x] = b == out(x);
	} else if (a == out(x)) {
		n->next[x] = y;
		n->last[y] = x;
	} else {
		n->next[y] = n->next[y] == x ? NONE : n->next[y];
		n->last[x] = n->last[x] == y ? NONE : n->last[x];
	}
}

static void take_path(struct network *n, place end)
{
	uint32_t length = 0;

	/* the queue is not needed any more */
	for (place p = end;; p = n->came[p] - 1) {
		n->queue[length++] = p;
		if (n->came[p] - 1 == p)
			break;
	}
	while (--length > 0)
		step(n, n->queue[length], n->queue[length - 1]);
	n->next[end / 2] = NONE;
}

static void find(struct cut *c, struct network *n)
{
	place end;
	int paths = 0;

	while ((end = search(n)) != NONE) {
		if (++paths > CUT_MOST)
			return;
		take_path(n, end);
	}
	for (uint32_t i = 0; i < n->d->count; i++)
		if (n->came[in(i)] && !n->came[out(i)])
			c->nodes[c->count++] = i;
}

int cut_find(struct cut *c, const struct dag *d, const unsigned char *from, const unsigned char *to, struct arena *a)
{
	struct arena spare;
	struct network n;

	c->count = 0;
	arena_init(&spare, &a->allocator);
	if (network_make(&n, d, from, to, &spare))
		find(c, &n);
	a->failed |= spare.failed;
	arena_free(&spare);
	return !a->failed;
}
