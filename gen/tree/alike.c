#include "tree/alike.h"
#include <string.h>

/* The bodies from `body` on that it carries, itself among them: they are numbered depth-first. */
static int count_carried(const struct tree *t, int body)
{
	int end = body + 1;

	while (end < t->body_count && t->bodies[end].parent >= body)
		end++;
	return end - body;
}

static int is_hinge(const struct body *k)
{
	return (k->type == JOINT_REVOLUTE || k->type == JOINT_CONTINUOUS || k->type == JOINT_PRISMATIC) && !k->follower;
}

/* So many bodies, and rows, further on? */
static int is_twin(const struct body *a, const struct body *b, int shift, int is_root)
{
	return is_hinge(a) && is_hinge(b) && a->type == b->type && a->axis == b->axis && a->sign == b->sign &&
		b->iv - a->iv == shift && b->iq - a->iq == shift && b->parent - a->parent == (is_root ? 0 : shift);
}

/* Are the limbs from this body on alike? */
static int are_alike(const struct tree *t, int first, int bodies)
{
	for (int limb = 1; limb < ALIKE_LIMBS; limb++)
		for (int i = first; i < first + bodies; i++) {
			int twin = i + limb * bodies;

			if (twin >= t->body_count || count_carried(t, twin) != count_carried(t, i) ||
				!is_twin(&t->bodies[i], &t->bodies[twin], limb * bodies, i == first))
				return 0;
		}
	return 1;
}

enum { CONSTANTS = 9 + 3 + 1 + 3 + 6 + 1 + 2 };

/* Each of a body's constants. */
static void list_constants(struct body *k, struct within **to)
{
	for (int i = 0; i < 9; i++)
		*to++ = &k->X.R.m[i / 3][i % 3];
	for (int i = 0; i < 3; i++)
		*to++ = &k->X.p[i];
	*to++ = &k->inertia.mass;
	for (int i = 0; i < 3; i++)
		*to++ = &k->inertia.h[i];
	for (int i = 0; i < 6; i++)
		*to++ = &k->inertia.I[i];
	*to++ = &k->multiplier;
	*to++ = &k->ahead.s;
	*to = &k->ahead.c;
}

/* Number i of each limb. */
static struct within *of_limb(struct within *const *list, int count, int limb, int i)
{
	return list[limb * count + i];
}

/* Is number i of each limb its number j, or its negation? 0: neither. */
static int sign_between(struct within *const *list, int count, int i, int j)
{
	int same = 1, opposite = 1;

	for (int limb = 0; limb < ALIKE_LIMBS; limb++) {
		same &= of_limb(list, count, limb, i)->x == of_limb(list, count, limb, j)->x;
		opposite &= of_limb(list, count, limb, i)->x == -of_limb(list, count, limb, j)->x;
	}
	return same ? 1 : opposite ? -1 : 0;
}

static int differs(struct within *const *list, int count, int i)
{
	for (int limb = 1; limb < ALIKE_LIMBS; limb++)
		if (of_limb(list, count, limb, i)->x != of_limb(list, count, 0, i)->x)
			return 1;
	return 0;
}

/* Numbers that differ from limb to limb know their limb. What is the same number in each limb is of one kind. */
static void tell(struct within *const *list, int count)
{
	for (int i = 0; i < count; i++) {
		int j = 0, sign;

		while (!(sign = sign_between(list, count, i, j)))
			j++;
		for (int limb = 0; limb < ALIKE_LIMBS && differs(list, count, i); limb++) {
			struct within *x = of_limb(list, count, limb, i);

			x->limb = limb + 1;
			x->kind = j == i ? (unsigned)i + 1 : of_limb(list, count, limb, j)->kind ^ (sign < 0 ? WITHIN_NEGATED : 0);
		}
	}
}

int tree_alike(struct alike *x, struct tree *told, const struct tree *t, struct arena *a)
{
	struct body *bodies = arena_alloc(a, (size_t)t->body_count, sizeof *bodies);
	struct within **list = arena_alloc(a, (size_t)t->body_count * CONSTANTS, sizeof *list);

	*x = (struct alike){0};
	for (int i = 0; i < t->body_count && !x->bodies; i++) {
		int count = count_carried(t, i);

		if (are_alike(t, i, count))
			*x = (struct alike){i, count, t->bodies[i].iq, t->bodies[i].iv};
	}
	if (!bodies || !list || !x->bodies)
		return 0;
	memcpy(bodies, t->bodies, (size_t)t->body_count * sizeof *bodies);
	*told = *t;
	told->bodies = bodies;
	for (int i = 0; i < ALIKE_LIMBS * x->bodies; i++) {
		struct body *k = &bodies[x->first + i];

		if (!body_is_ahead(k)) /* a twin may be */
			k->ahead = TURN_NONE;
		list_constants(k, list + i * CONSTANTS);
	}
	tell(list, x->bodies * CONSTANTS);
	return 1;
}
