#include "passes/path.h"

/* Bodies between the ground and a body; beyond these, nothing near the ground is zero any more. */
enum { PATH_MOST = 6 };

static int is_on(const struct tree *t, int i, int body)
{
	for (int k = body, length = 0; k >= 0 && length <= PATH_MOST; k = t->bodies[k].parent, length++)
		if (k == i)
			return 1;
	return t->bodies[i].parent == body;
}

int path_make(struct tree *path, const struct tree *t, int body, struct arena *a)
{
	int *at = arena_alloc(a, (size_t)t->body_count, sizeof *at);
	struct body *bodies = arena_alloc(a, (size_t)t->body_count, sizeof *bodies);
	int count = 0;

	if (!at || !bodies)
		return 0;
	for (int i = 0; i < t->body_count; i++) {
		const struct body *k = &t->bodies[i];
		int is_first = !count;

		if (!is_on(t, i, body))
			continue;
		at[i] = count;
		bodies[count] = *k;
		bodies[count].parent = is_first ? -1 : at[k->parent];
		if (is_first && k->parent >= 0) {
			bodies[count].type = JOINT_FLOATING;
			bodies[count].iq = t->nq; /* rows of their own */
			bodies[count].iv = t->nv;
		}
		count++;
	}
	*path = *t;
	path->nq += 7;
	path->nv += 6;
	path->bodies = bodies;
	path->body_count = count;
	path->mimic_count = 0;
	return 1;
}
