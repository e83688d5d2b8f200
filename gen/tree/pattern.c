#include "tree/pattern.h"
#include "tree/tree.h"

/* Rows of a body in qd, and of one that its wrenches go through; a follower has its driver's. */
static void mark(unsigned char *related, const struct tree *t, int a, int b)
{
	const struct body *x = &t->bodies[a], *y = &t->bodies[b];

	for (int i = x->iv; i < x->iv + joint_nv(x->type); i++)
		for (int j = y->iv; j < y->iv + joint_nv(y->type); j++)
			related[i * t->nv + j] = related[j * t->nv + i] = 1;
}

/* What is related to the same is. */
static void close_over(unsigned char *related, int n)
{
	for (int k = 0; k < n; k++)
		for (int i = 0; i < n; i++)
			for (int j = 0; j < n && related[i * n + k]; j++)
				related[i * n + j] |= related[k * n + j];
}

static int make(struct pattern *p, const struct tree *t, int is_coupled, int symmetric, int dense, struct arena *a)
{
	size_t size = (size_t)t->nv * (size_t)t->nv;
	unsigned char *related = arena_alloc(a, size, 1);

	p->rows = 0;
	p->row = arena_alloc(a, size, sizeof *p->row);
	if (!related || !p->row)
		return 0;
	for (int i = 0; i < t->body_count; i++)
		for (int up = i; up >= 0; up = t->bodies[up].parent)
			mark(related, t, i, up);
	if (is_coupled)
		close_over(related, t->nv);
	for (int i = 0; i < t->nv; i++)
		for (int j = 0; j < t->nv; j++)
			p->row[i * t->nv + j] = dense || (related[i * t->nv + j] && (!symmetric || j <= i)) ? p->rows++ : -1;
	arena_release(a, related);
	return 1;
}

int pattern_make(struct pattern *p, const struct tree *t, int symmetric, int dense, struct arena *a)
{
	return make(p, t, 0, symmetric, dense, a);
}

int pattern_coupled(struct pattern *p, const struct tree *t, int symmetric, int dense, struct arena *a)
{
	return make(p, t, 1, symmetric, dense, a);
}
