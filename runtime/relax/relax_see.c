#include "relax/relaxing.h"

struct seeing {
	const struct dag *d;
	const struct tree *t;
	struct arena *a;
	struct seen *seen;
};

static struct quadric *keep(struct seeing *s, struct quadric q)
{
	struct quadric *kept = arena_alloc(s->a, 1, sizeof *kept);

	if (kept)
		*kept = q;
	return kept;
}

static struct seen see_input(struct seeing *s, const struct node *n)
{
	enum role role = s->d->arguments[n->arg[0].i].role;
	int row = (int)n->arg[1].i;
	const struct tree_joint *j = role == ROLE_JOINT_POSITION ? tree_joint_of_q(s->t, row) : NULL;

	if (role == ROLE_JOINT_OFFSET)
		return (struct seen){.kind = AFFINE, .has_offset = 1, .row = -1};
	if (!j)
		return (struct seen){.kind = OTHER};
	if (j->type == JOINT_FLOATING && row >= j->iq + 3)
		return (struct seen){.kind = QUATERNION, .row = j->iq + 3, .quadric = keep(s, quadric_input(row - j->iq - 3))};
	return (struct seen){.kind = AFFINE, .row = row, .factor = 1};
}

static struct quadric quadric_of(const struct seeing *s, uint32_t i)
{
	return s->seen[i].quadric ? *s->seen[i].quadric : quadric_const(s->d->nodes[i].value);
}

/* Of quaternions: a polynomial of degree 2, or it is OTHER. */
static struct seen see_quadric(struct seeing *s, const struct node *n, struct seen x)
{
	struct quadric a = quadric_of(s, n->arg[0].i), q = a;
	int done = 1;

	if (n->op == OP_MUL || n->op == OP_FMA)
		done = quadric_mul(&q, a, quadric_of(s, n->arg[1].i));
	if (n->op == OP_FMA)
		q = quadric_add(q, quadric_of(s, n->arg[2].i), 1);
	if (n->op == OP_ADD || n->op == OP_SUB)
		q = quadric_add(a, quadric_of(s, n->arg[1].i), n->op == OP_SUB ? -1 : 1);
	if (n->op == OP_NEG)
		q = quadric_add(quadric_const(0), a, -1);
	if (!done)
		return (struct seen){.kind = OTHER};
	x.quadric = keep(s, q);
	return x;
}

static int is_linear(enum op op)
{
	return op == OP_NEG || op == OP_ADD || op == OP_SUB || op == OP_MUL || op == OP_FMA || op == OP_ANEW;
}

/* a + sign b of two that are affine, or constant */
static struct seen affine_sum(struct seen a, struct seen b, double sign)
{
	if (a.kind == CONSTANT)
		return (struct seen){b.kind, b.has_offset, 0, b.row, sign * b.factor, NULL};
	if (b.kind == CONSTANT)
		return a;
	if (a.row >= 0 && b.row >= 0 && a.row != b.row)
		return (struct seen){.kind = OTHER};
	a.has_offset |= b.has_offset;
	a.row = a.row >= 0 ? a.row : b.row;
	a.factor += sign * b.factor;
	return a;
}

static struct seen affine_product(const struct seeing *s, const struct node *n)
{
	struct seen a = s->seen[n->arg[0].i], b = s->seen[n->arg[1].i];
	int first = a.kind == CONSTANT;

	if (a.kind != CONSTANT && b.kind != CONSTANT)
		return (struct seen){.kind = OTHER};
	if (a.kind == CONSTANT && b.kind == CONSTANT)
		return a;
	b = first ? b : a;
	b.factor *= (double)s->d->nodes[n->arg[!first].i].value;
	return b;
}

static struct seen see_affine(const struct seeing *s, const struct node *n)
{
	struct seen a = s->seen[n->arg[0].i], zero = {.kind = CONSTANT};

	switch (n->op) {
	case OP_NEG:
		return affine_sum(zero, a, -1);
	case OP_ADD:
		return affine_sum(a, s->seen[n->arg[1].i], 1);
	case OP_SUB:
		return affine_sum(a, s->seen[n->arg[1].i], -1);
	case OP_MUL:
		return affine_product(s, n);
	case OP_FMA:
		a = affine_product(s, n);
		return a.kind == OTHER ? a : affine_sum(a, s->seen[n->arg[2].i], 1);
	default:
		return a;
	}
}

static struct seen see(struct seeing *s, uint32_t i)
{
	const struct node *n = &s->d->nodes[i];
	struct seen most = {.kind = CONSTANT};

	if (n->op == OP_INPUT)
		return see_input(s, n);
	for (int k = 0; k < op_arity[n->op]; k++) {
		const struct seen *of = &s->seen[n->arg[k].i];

		if (of->kind == QUATERNION && most.kind == QUATERNION && of->row != most.row)
			return (struct seen){.kind = OTHER};
		if (of->kind != CONSTANT && most.kind != CONSTANT && of->kind != most.kind)
			return (struct seen){.kind = OTHER};
		most = of->kind > most.kind ? *of : most;
	}
	if (most.kind != CONSTANT && !is_linear(n->op))
		return (struct seen){.kind = OTHER};
	return most.kind == QUATERNION ? see_quadric(s, n, most) : most.kind == AFFINE ? see_affine(s, n) : most;
}

struct seen *relax_see(const struct dag *d, const struct tree *t, const uint32_t *uses, struct arena *a)
{
	struct seeing s = {d, t, a, arena_alloc(a, d->count, sizeof(struct seen))};

	for (uint32_t i = 0; i < d->count && !a->failed; i++)
		if (i && uses[i])
			s.seen[i] = see(&s, i);
	return a->failed ? NULL : s.seen;
}
