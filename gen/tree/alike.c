#include "tree/alike.h"
#include <string.h>

struct finder {
	const struct tree *t;
	int limbs, may_turn;
};

/* ---- which limbs are alike ---- */

static int is_hinge(const struct body *k)
{
	return k->type == JOINT_REVOLUTE || k->type == JOINT_CONTINUOUS || k->type == JOINT_PRISMATIC;
}

/* The body whose joint has the row of this follower's to itself. */
static int driver_of(const struct tree *t, int body)
{
	int k = 0;

	while (k < t->body_count && (t->bodies[k].iv != t->bodies[body].iv || t->bodies[k].follower))
		k++;
	return k;
}

/* A follower's angle is the same multiple of that of a twin. */
static int follow_alike(const struct tree *t, int a, int b, int shift)
{
	const struct body *x = &t->bodies[a], *y = &t->bodies[b];

	return x->follower == y->follower && (!x->follower || (x->multiplier.x == y->multiplier.x &&
		driver_of(t, b) - driver_of(t, a) == shift));
}

/* Body `a` of a limb from `root` on, and the one so many further on. */
static int is_twin(const struct finder *f, int root, int a, int shift)
{
	const struct tree *t = f->t;
	const struct body *x = &t->bodies[a], *y = x + shift;

	return is_hinge(x) && x->type == y->type && x->axis == y->axis && (f->may_turn || x->sign == y->sign) &&
		y->parent - x->parent == (a == root ? 0 : shift) && tree_end(t, a + shift) - tree_end(t, a) == shift &&
		follow_alike(t, a, a + shift, shift);
}

/* Is no row of a joint of these bodies another body's too? */
static int has_own_rows(const struct tree *t, int first, int end)
{
	for (int i = first; i < end; i++)
		for (int k = 0; k < t->body_count; k++)
			if ((k < first || k >= end) && t->bodies[k].type != JOINT_FIXED && t->bodies[k].iv == t->bodies[i].iv)
				return 0;
	return 1;
}

static int are_alike(const struct finder *f, int first, int other)
{
	int end = tree_end(f->t, first), shift = other - first;

	if (tree_end(f->t, other) - end != shift)
		return 0;
	for (int i = first; i < end; i++)
		if (!is_twin(f, first, i, shift))
			return 0;
	return has_own_rows(f->t, other, end + shift);
}

/* The limb from this body on, and the next ones that are like it. */
static int find_group(const struct finder *f, int first, const unsigned char *taken, struct alike_group *g)
{
	const struct tree *t = f->t;
	int count = 1, parent = t->bodies[first].parent, end = tree_end(t, first);

	*g = (struct alike_group){end - first, {first}};
	for (int i = end; i < t->body_count && t->bodies[i].parent >= parent && count < f->limbs; i = tree_end(t, i))
		if (!taken[i] && t->bodies[i].parent == parent && are_alike(f, first, i))
			g->first[count++] = i;
	return count == f->limbs && has_own_rows(t, first, end);
}

static void find_groups(const struct finder *f, unsigned char *taken, struct alike *x)
{
	for (int i = 0; i < f->t->body_count && x->group_count < ALIKE_GROUPS; i++) {
		struct alike_group *g = &x->groups[x->group_count];

		if (taken[i] || !find_group(f, i, taken, g))
			continue;
		for (int k = 0; k < f->limbs; k++)
			memset(taken + g->first[k], 1, (size_t)g->bodies);
		x->group_count++;
	}
}

/* ---- frames ---- */

/* Half a turn about an axis, or none: the sign of each coordinate. */
static const signed char TURNS[][3] = {{1, 1, 1}, {1, -1, -1}, {-1, 1, -1}, {-1, -1, 1}};
enum { TURN_COUNT = sizeof TURNS / sizeof *TURNS };

static void turn_number(struct within *x, int sign)
{
	if (sign < 0 && x->x != 0)
		*x = within_neg(*x);
}

/* Into a frame turned by `own`, where the parent's is turned by `of`. */
static void turn_body(struct body *k, const signed char *own, const signed char *of)
{
	for (int i = 0; i < 3; i++) {
		turn_number(&k->X.p[i], of[i]);
		turn_number(&k->inertia.h[i], own[i]);
		for (int j = 0; j < 3; j++) {
			turn_number(&k->X.R.m[i][j], of[i] * own[j]);
			turn_number(&k->frame.m[i][j], own[j]);
		}
		for (int j = i; j < 3; j++)
			turn_number(&k->inertia.I[inertia_index(i, j)], own[i] * own[j]);
	}
	k->sign *= own[k->axis];
	turn_number(&k->ahead.s, own[k->axis]);
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

static int count_different(struct body *a, struct body *b)
{
	struct within *x[CONSTANTS], *y[CONSTANTS];
	int count = 0;

	list_constants(a, x);
	list_constants(b, y);
	for (int i = 0; i < CONSTANTS; i++)
		count += x[i]->x != y[i]->x;
	return count;
}

/* The frame in which the joint turns as its twin's does, and most constants are the twin's. */
static const signed char *turn_alike(struct body *k, struct body *twin, const signed char *of)
{
	const struct body was = *k;
	const signed char *best = NULL;
	int least = CONSTANTS + 1;

	for (int i = 0; i < TURN_COUNT; i++) {
		struct body turned = was;
		int different;

		turn_body(&turned, TURNS[i], of);
		different = count_different(&turned, twin);
		if (turned.sign == twin->sign && different < least) {
			best = TURNS[i];
			least = different;
			*k = turned;
		}
	}
	return best;
}

static void turn_limbs(const struct alike *x, const struct alike_group *g, struct body *bodies, const signed char **turns)
{
	for (int limb = 1; limb < x->limbs; limb++)
		for (int i = 0; i < g->bodies; i++) {
			int body = g->first[limb] + i;
			const signed char *of = i > 0 ? turns[bodies[body].parent] : TURNS[0];

			turns[body] = turn_alike(&bodies[body], &bodies[g->first[0] + i], of);
		}
}

/* ---- what differs ---- */

/* The constants of a group, one limb after the other. */
struct constants {
	struct within **list;
	int limbs, count;
};

/* Number i of a limb. */
static struct within *of_limb(const struct constants *x, int limb, int i)
{
	return x->list[limb * x->count + i];
}

/* Is number i of each limb its number j, or its negation? 0: neither. */
static int sign_between(const struct constants *x, int i, int j)
{
	int same = 1, opposite = 1;

	for (int limb = 0; limb < x->limbs; limb++) {
		same &= of_limb(x, limb, i)->x == of_limb(x, limb, j)->x;
		opposite &= of_limb(x, limb, i)->x == -of_limb(x, limb, j)->x;
	}
	return same ? 1 : opposite ? -1 : 0;
}

static int differs(const struct constants *x, int i)
{
	for (int limb = 1; limb < x->limbs; limb++)
		if (of_limb(x, limb, i)->x != of_limb(x, 0, i)->x)
			return 1;
	return 0;
}

/* Numbers that differ from limb to limb know their limb, counted on from `first`. What is the same number in each limb is of one
   kind. */
static void tell(const struct constants *x, int first, unsigned kinds)
{
	for (int i = 0; i < x->count; i++) {
		int j = 0, sign;

		while (!(sign = sign_between(x, i, j)))
			j++;
		for (int limb = 0; limb < x->limbs && differs(x, i); limb++) {
			struct within *to = of_limb(x, limb, i);

			to->limb = first + limb;
			to->kind = j == i ? kinds + (unsigned)i : of_limb(x, limb, j)->kind ^ (sign < 0 ? WITHIN_NEGATED : 0);
		}
	}
}

static void tell_group(const struct alike *x, int group, struct body *bodies, struct within **list)
{
	const struct alike_group *g = &x->groups[group];

	for (int limb = 0; limb < x->limbs; limb++)
		for (int i = 0; i < g->bodies; i++) {
			struct body *k = &bodies[g->first[limb] + i];

			if (!body_is_ahead(k)) /* a twin may be */
				k->ahead = TURN_NONE;
			list_constants(k, list + (limb * g->bodies + i) * CONSTANTS);
		}
	tell(&(struct constants){list, x->limbs, g->bodies * CONSTANTS}, 1 + group * x->limbs,
		1 + (unsigned)(g->first[0] * CONSTANTS));
}

int tree_alike(struct alike *x, struct tree *told, const struct tree *t, int limbs, int may_turn, struct arena *a)
{
	size_t count = (size_t)t->body_count;
	struct finder f = {t, limbs, may_turn};
	struct body *bodies = arena_alloc(a, count, sizeof *bodies);
	struct within **list = arena_alloc(a, count * CONSTANTS, sizeof *list);
	const signed char **turns = arena_alloc(a, count, sizeof *turns);
	unsigned char *taken = arena_alloc(a, count, 1);

	*x = (struct alike){.limbs = limbs};
	if (a->failed)
		return 0;
	find_groups(&f, taken, x);
	memcpy(bodies, t->bodies, count * sizeof *bodies);
	*told = *t;
	told->bodies = bodies;
	for (int i = 0; i < x->group_count; i++) {
		if (may_turn)
			turn_limbs(x, &x->groups[i], bodies, turns);
		tell_group(x, i, bodies, list);
	}
	return x->group_count > 0;
}

/* Which body of the limb, from 0, has the row; -1: none has. */
static int body_with(const struct tree *t, int first, int bodies, int is_q, int row)
{
	for (int i = 0; i < bodies; i++) {
		const struct body *k = &t->bodies[first + i];

		if (!k->follower && (is_q ? k->iq : k->iv) == row)
			return i;
	}
	return -1;
}

int alike_limb(const struct alike *x, const struct tree *t, int is_q, int row, int *place)
{
	for (int group = 0; group < x->group_count; group++)
		for (int limb = 0; limb < x->limbs; limb++) {
			const struct alike_group *g = &x->groups[group];
			int i = body_with(t, g->first[limb], g->bodies, is_q, row);

			*place = g->first[0] + i;
			if (i >= 0)
				return 1 + group * x->limbs + limb;
		}
	return 0;
}
