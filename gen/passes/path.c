#include "passes/path.h"
#include "dynamics/registry.h"
#include <limits.h>
#include <math.h>

const struct request TORQUES_REQUEST = {.is_plain = 1};

void torques_build(struct dag *d, const struct tree *t, struct arena *a)
{
	dag_init(d, a);
	algorithm_rnea.build(d, t, &TORQUES_REQUEST);
}

long torques_flops(const struct dag *d, struct arena *a)
{
	uint32_t *uses = d->failed ? NULL : arena_alloc(a, d->count, sizeof *uses);
	long flops = 0;

	if (!uses)
		return -1;
	dag_uses(d, uses);
	for (size_t i = 0; i < d->count; i++) {
		enum op op = d->nodes[i].op;

		flops += uses[i] && (op == OP_MUL || op == OP_ADD || op == OP_SUB);
	}
	return flops;
}

/* ---- paths ---- */

/* Bodies between the ground and a body; beyond these, nothing near the ground is zero any more. */
enum { PATH_MOST = 6 };

static int is_on(const struct tree *t, int i, int body)
{
	for (int k = body, length = 0; k >= 0 && length <= PATH_MOST; k = t->bodies[k].parent, length++)
		if (k == i)
			return 1;
	return t->bodies[i].parent == body;
}

/* Rows are those of the tree. */
int path_make(struct path *p, const struct tree *t, const struct restatement *by, int body, struct arena *a)
{
	int *at = arena_alloc(a, (size_t)t->body_count, sizeof *at);
	struct body *bodies = arena_alloc(a, (size_t)t->body_count, sizeof *bodies);
	int count = 0;

	p->by = arena_alloc(a, (size_t)t->body_count, sizeof *p->by);
	p->floats = 0;
	if (!at || !bodies || !p->by)
		return 0;
	for (int i = 0; i < t->body_count; i++) {
		if (!is_on(t, i, body))
			continue;
		at[i] = count;
		p->floats |= !count && t->bodies[i].parent >= 0;
		bodies[count] = t->bodies[i];
		bodies[count].parent = count ? at[t->bodies[i].parent] : -1;
		p->by[count++] = by[i];
	}
	p->body = at[body];
	p->tree = *t;
	p->tree.bodies = bodies;
	p->tree.body_count = count;
	p->tree.mimic_count = 0;
	return 1;
}

/* The first body, on a base that floats, with rows of its own. */
static void set_free(struct tree *path)
{
	path->bodies[0].type = JOINT_FLOATING;
	path->bodies[0].iq = path->nq;
	path->bodies[0].iv = path->nv;
	path->nq += 7;
	path->nv += 6;
}

const struct cost PATH_COST_UNKNOWN = {INT_MAX, LONG_MAX};

static int weigh(struct within x)
{
	return x.x == 0 ? 0 : fabsl(x.x) == 1 ? 1 : 2;
}

static int weigh_body(const struct body *k)
{
	int n = weigh(k->inertia.mass) + weigh(k->ahead.s);

	for (int i = 0; i < 9; i++)
		n += weigh(k->X.R.m[i / 3][i % 3]);
	for (int i = 0; i < 3; i++)
		n += weigh(k->X.p[i]) + weigh(k->inertia.h[i]);
	for (int i = 0; i < 6; i++)
		n += weigh(k->inertia.I[i]);
	return n;
}

/* Of a body, its parent and its children. */
static int weigh_around(const struct tree *t, int body)
{
	int n = 0;

	for (int i = 0; i < t->body_count; i++)
		if (i == body || t->bodies[i].parent == body || t->bodies[body].parent == i)
			n += weigh_body(&t->bodies[i]);
	return n;
}

/* A frame that has more constants hardly ever takes fewer operations. */
struct cost path_cost(const struct path *p, const struct restatement *by, const struct cost *least,
	const struct rneagen_allocator *allocator)
{
	struct cost x = {.flops = -1};
	struct arena spare;
	struct dag d;
	struct tree t;

	arena_init(&spare, allocator);
	p->by[p->body] = *by;
	if (tree_restate_body(&t, &p->tree, p->by, p->body, &spare)) {
		x = (struct cost){weigh_around(&t, p->body), LONG_MAX};
		if (p->floats)
			set_free(&t);
		if (x.constants <= least->constants) {
			torques_build(&d, &t, &spare);
			x.flops = torques_flops(&d, &spare);
		}
	}
	arena_free(&spare);
	return x;
}
