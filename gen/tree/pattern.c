#include "tree/pattern.h"
#include "tree/lumps.h"

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
	p->lines = p->cols = t->nv;
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

int pattern_row_begins(const struct pattern *p, int line)
{
	const int *row = p->row + line * p->cols;

	while (*row < 0)
		row++;
	return *row;
}

int pattern_coupled(struct pattern *p, const struct tree *t, int symmetric, int dense, struct arena *a)
{
	return make(p, t, 1, symmetric, dense, a);
}

/* Rows of a body, by the columns of a lump that hangs on it. */
static void mark_columns(struct pattern *p, const struct body *k, int lump)
{
	for (int i = k->iv; i < k->iv + joint_nv(k->type); i++)
		for (int c = 0; c < LUMP_PARAMETERS; c++)
			p->row[i * p->cols + LUMP_PARAMETERS * lump + c] = 1;
}

int pattern_lumps(struct pattern *p, const struct tree *t, int dense, struct arena *a)
{
	struct lumps x;

	*p = (struct pattern){0};
	if (!lumps_make(&x, t, a))
		return 0;
	p->lines = t->nv;
	p->cols = LUMP_PARAMETERS * x.count;
	p->row = arena_alloc(a, (size_t)t->nv * (size_t)p->cols, sizeof *p->row);
	if (!p->row)
		return 0;
	for (int lump = 0; lump < x.count; lump++)
		for (int k = x.body[lump]; k >= 0; k = t->bodies[k].parent)
			mark_columns(p, &t->bodies[k], lump);
	for (int e = 0; e < t->nv * p->cols; e++)
		p->row[e] = dense || p->row[e] ? p->rows++ : -1;
	return 1;
}

static int make_empty(struct pattern *p, int lines, int cols, struct arena *a)
{
	*p = (struct pattern){.lines = lines, .cols = cols};
	p->row = arena_alloc(a, (size_t)lines * (size_t)cols, sizeof *p->row);
	return p->row != NULL;
}

int pattern_chain(struct pattern *p, const struct tree *t, int body, int dense, struct arena *a)
{
	unsigned char *moves = arena_alloc(a, (size_t)t->nv, 1);

	if (!moves || !make_empty(p, 6, t->nv, a))
		return 0;
	for (int k = body; k >= 0; k = t->bodies[k].parent)
		for (int i = 0; i < joint_nv(t->bodies[k].type); i++)
			moves[t->bodies[k].iv + i] = 1;
	for (int e = 0; e < 6 * t->nv; e++)
		p->row[e] = dense || moves[e % t->nv] ? p->rows++ : -1;
	return 1;
}

int pattern_whole(struct pattern *p, int lines, int cols, int is_lower, struct arena *a)
{
	if (!make_empty(p, lines, cols, a))
		return 0;
	for (int e = 0; e < lines * cols; e++)
		p->row[e] = !is_lower || e % cols <= e / cols ? p->rows++ : -1;
	return 1;
}

/* Rows of a joint, from its first, that slide. */
static int slides_of(enum joint_type type)
{
	return type == JOINT_FLOATING ? 3 : type == JOINT_PLANAR ? 2 : type == JOINT_PRISMATIC;
}

/* All that moves slides with the first body, where no other one stands on the ground or follows its joint. */
static int slide_count(const struct tree *t)
{
	int count = slides_of(t->bodies[0].type);

	for (int k = 1; k < t->body_count; k++)
		if (t->bodies[k].parent < 0 || (joint_nv(t->bodies[k].type) && t->bodies[k].iv == t->bodies[0].iv))
			count = 0;
	return count;
}

int pattern_momentum(struct pattern *p, const struct tree *t, int dense, struct arena *a)
{
	int first = t->bodies[0].iv, end = first + slide_count(t);

	if (!make_empty(p, 6, t->nv, a))
		return 0;
	for (int e = 0; e < 6 * t->nv; e++)
		p->row[e] = dense || e < 3 * t->nv || e % t->nv < first || e % t->nv >= end ? p->rows++ : -1;
	return 1;
}
