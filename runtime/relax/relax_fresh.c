/* Which parts of a text have inputs of their own. */
#include "relax/friction.h"
#include "relax/relaxing.h"
#include <math.h>

static enum rneagen_code refuse(const struct relaxing *s, const char *what)
{
	return error_set(s->e, RNEAGEN_UNSUPPORTED, "%s: rnearun prove cannot bound %s", s->out->text->options.file, what);
}

static uint32_t add(struct relaxing *s, struct fresh f)
{
	f.joint = -1;
	s->fresh[s->fresh_count++] = f;
	return (uint32_t)s->fresh_count;
}

int relax_turns(const struct tree *t, int row, double factor)
{
	int same = 0, all = 0;

	for (int i = 0; i < t->body_count; i++) {
		const struct body *k = &t->bodies[i];
		int turns = k->type == JOINT_REVOLUTE || k->type == JOINT_CONTINUOUS;

		if (!(turns && k->iq == row) && !(k->type == JOINT_PLANAR && k->iq + 2 == row))
			continue;
		all++;
		same += fabs(fabs((double)k->multiplier.x) - fabs(factor)) <= 1e-9 * fabs(factor);
	}
	return same ? same : all ? all : 1;
}

/* A part of a turn is any angle where the turns are not counted. */
static struct interval angle_range(const struct relaxing *s, const struct seen *x, struct interval r)
{
	const struct interval *of = x->row >= 0 ? &s->given[s->position][x->row] : NULL;

	return of && of->upper - of->lower >= 6.283185307179586 ? interval_turn() : r;
}

static enum rneagen_code take_angle(struct relaxing *s, uint32_t i)
{
	struct seen *x = &s->seen[i];

	if (x->kind != AFFINE)
		return refuse(s, "an angle that no joint has");
	x->is_angle = 1;
	if (s->d->nodes[i].op != OP_INPUT && !s->by_angle[i])
		s->by_angle[i] = add(s, (struct fresh){.of = i, .range = angle_range(s, x, s->plain[i]),
			.row = {relax_turns(&s->out->text->tree, x->row, x->factor), 1, s->position, x->row,
				x->row >= 0 ? x->factor : 0},
			.component = -1});
	return RNEAGEN_OK;
}

static enum rneagen_code take_length(struct relaxing *s, uint32_t i, const unsigned char *is_angle)
{
	const struct seen *x = &s->seen[i];
	const struct interval *of = x->row >= 0 ? &s->given[s->position][x->row] : NULL;
	const struct tree_joint *j = x->row >= 0 ? tree_joint_of_q(&s->out->text->tree, x->row) : NULL;

	if (j && j->type == JOINT_CONTINUOUS && of->upper - of->lower >= 6.283185307179586)
		return refuse(s, "a length that follows an angle without limits: give that a --range");
	if (x->has_offset || (x->row >= 0 && is_angle[x->row]))
		s->by_value[i] = add(s, (struct fresh){.of = i, .range = s->plain[i],
			.row = {0, 1, s->position, x->row, x->row >= 0 ? x->factor : 0}, .component = -1});
	return RNEAGEN_OK;
}

/* Of multiples what they are multiples of. */
static uint32_t without_factor(const struct relaxing *s, uint32_t i)
{
	for (;;) {
		const struct node *n = &s->d->nodes[i];
		int k = 0;

		if (n->op == OP_MUL)
			k = s->seen[n->arg[0].i].kind == CONSTANT;
		if ((n->op != OP_NEG && n->op != OP_MUL) || s->seen[n->arg[k].i].kind != QUATERNION ||
			(n->op == OP_MUL && s->seen[n->arg[!k].i].kind != CONSTANT))
			return i;
		i = n->arg[k].i;
	}
}

static enum rneagen_code take_quaternion(struct relaxing *s, uint32_t of)
{
	uint32_t i = without_factor(s, of);
	struct fresh f = {.of = i, .component = -1};
	struct rotated r;
	double size;
	int row;

	if (s->by_value[i])
		return RNEAGEN_OK;
	if (!quadric_rotated(s->seen[i].quadric, &r))
		return refuse(s, "what reads a quaternion, but for its rotation");
	/* of one that is not quite of length 1: (1 - n) 1 + n R, n the square of its length */
	size = rotated_size(&r) * (1 + 2.01 * RELAXED_QUATERNION);
	f.range = (struct interval){-size, size};
	if (rotated_is_row(&r, &row, f.g))
		f.component = row;
	s->by_value[i] = add(s, f);
	s->fresh[s->fresh_count - 1].joint = s->seen[i].row;
	return RNEAGEN_OK;
}

static int is_parameter(const struct relaxing *s, uint32_t i)
{
	const struct node *n = &s->d->nodes[i];
	enum role role = n->op == OP_INPUT ? s->d->arguments[n->arg[0].i].role : ROLE_UNKNOWN;

	return role == ROLE_LINK_MASS || role == ROLE_LINK_INERTIA || role == ROLE_LINK_PAYLOAD;
}

/* Where another kind of value, or an output, reads node i. */
static enum rneagen_code take_value(struct relaxing *s, uint32_t i, const unsigned char *is_angle)
{
	if (s->by_value[i])
		return RNEAGEN_OK;
	if (s->seen[i].kind == AFFINE)
		return take_length(s, i, is_angle);
	if (s->seen[i].kind == QUATERNION)
		return take_quaternion(s, i);
	if (is_parameter(s, i))
		s->by_value[i] = add(s, (struct fresh){.of = i, .range = s->plain[i],
			.row = {0, 1, (int)s->d->nodes[i].arg[0].i, (int)s->d->nodes[i].arg[1].i, 1}, .component = -1});
	return RNEAGEN_OK;
}

static enum rneagen_code take_node(struct relaxing *s, uint32_t i, const unsigned char *is_angle)
{
	const struct node *n = &s->d->nodes[i];
	struct friction f;

	if (friction_of(s->d, i, &f)) {
		s->by_value[i] = add(s, (struct fresh){.of = i, .range = s->plain[i], .is_drive = 1, .component = -1});
		return RNEAGEN_OK;
	}
	for (int k = 0; k < op_arity[n->op] && s->seen[i].kind == OTHER && n->op != OP_SIN && n->op != OP_COS; k++)
		if (take_value(s, n->arg[k].i, is_angle))
			return s->e->code;
	return RNEAGEN_OK;
}

enum rneagen_code relax_fresh(struct relaxing *s)
{
	unsigned char *is_angle = arena_alloc(s->a, (size_t)s->out->text->tree.nq + 1, 1);

	if (!is_angle)
		return error_memory(s->e);
	for (uint32_t i = 0; i < s->d->count; i++) {
		const struct node *n = &s->d->nodes[i];

		if (!s->uses[i] || (n->op != OP_SIN && n->op != OP_COS))
			continue;
		if (take_angle(s, n->arg[0].i))
			return s->e->code;
		if (s->d->nodes[n->arg[0].i].op == OP_INPUT && s->seen[n->arg[0].i].row >= 0)
			is_angle[s->seen[n->arg[0].i].row] = 1;
	}
	for (uint32_t i = 0; i < s->d->count; i++)
		if (s->uses[i] && take_node(s, i, is_angle))
			return s->e->code;
	for (size_t i = 0; i < s->d->output_count; i++)
		if (take_value(s, s->d->outputs[i].value.i, is_angle))
			return s->e->code;
	return s->a->failed ? error_memory(s->e) : RNEAGEN_OK;
}
