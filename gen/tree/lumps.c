#include "tree/lumps.h"
#include <string.h>

int lumps_is_held(const struct tree *t, int body)
{
	while (body >= 0 && t->bodies[body].type == JOINT_FIXED)
		body = t->bodies[body].parent;
	return body < 0;
}

int lumps_make(struct lumps *x, const struct tree *t, struct arena *a)
{
	size_t bodies = (size_t)t->body_count;

	*x = (struct lumps){.body = arena_alloc(a, bodies, sizeof *x->body), .of = arena_alloc(a, bodies, sizeof *x->of)};
	if (!x->body || !x->of)
		return 0;
	for (int k = 0; k < t->body_count; k++) {
		int is_held = t->bodies[k].type == JOINT_FIXED, parent = t->bodies[k].parent;

		x->of[k] = !is_held ? x->count : parent < 0 ? -1 : x->of[parent];
		if (!is_held)
			x->body[x->count++] = k;
	}
	return 1;
}

/* A held body's frame in that of the body that moves it. */
static struct placement placed(const struct tree *t, int body, int mover)
{
	struct placement X = {.R = ROTATION_IDENTITY};

	for (int k = body; k != mover; k = t->bodies[k].parent) {
		const struct placement turn = {.R = rotation_about(t->bodies[k].axis, t->bodies[k].turn)};
		struct placement step = placement_mul(&t->bodies[k].X, &turn);

		X = placement_mul(&step, &X);
	}
	return X;
}

struct inertia lumps_inertia(const struct lumps *x, const struct tree *t, int lump)
{
	const struct body *mover = &t->bodies[x->body[lump]];
	struct placement link = {.R = mover->frame};
	struct inertia_sum s = {0};

	memcpy(link.p, mover->origin, sizeof link.p);
	for (int k = 0; k < t->body_count; k++)
		if (x->of[k] == lump) {
			struct placement X = placed(t, k, x->body[lump]);

			X = placement_mul(&link, &X);
			inertia_add_from(&s, &X, &t->bodies[k].inertia);
		}
	return inertia_total(&s);
}
