#include "certify/left_out.h"
#include <stdlib.h>
#include <string.h>

void left_out_reads(const struct dag *d, size_t output, unsigned char *live)
{
	uint32_t root = d->outputs[output].value.i;

	memset(live, 0, d->count);
	live[root] = 1;
	dag_mark_operands(d, (size_t)root + 1, live);
}

static const struct node *position_of(const struct dag *d, uint32_t i)
{
	const struct node *n = &d->nodes[i];

	return n->op == OP_INPUT && d->arguments[n->arg[0].i].role == ROLE_JOINT_POSITION ? n : NULL;
}

/* A row of q that stands for every angle. */
static int is_turn(const struct tree *t, int row)
{
	const struct tree_joint *j = tree_joint_of_q(t, row);

	return j && (j->type == JOINT_CONTINUOUS || (j->type == JOINT_PLANAR && row == j->iq + 2));
}

static const char *why_input(const struct analysis *x, const struct node *n)
{
	enum role role = x->dag.arguments[n->arg[0].i].role;
	const struct tree_joint *j = role == ROLE_JOINT_POSITION ? tree_joint_of_q(&x->tree, (int)n->arg[1].i) : NULL;

	if (role == ROLE_LINK_INERTIA || role == ROLE_LINK_PAYLOAD)
		return "it reads the ten numbers of a freed inertia or payload";
	return j && j->type == JOINT_FLOATING ? "it reads the position of a floating base or joint" : NULL;
}

/* Its range stands for every angle, so what is made of it beside sine and cosine has none. */
static const char *why_operand(const struct analysis *x, const struct node *n)
{
	for (int k = 0; k < op_arity[n->op]; k++) {
		const struct node *q = position_of(&x->dag, n->arg[k].i);

		if (q && is_turn(&x->tree, (int)q->arg[1].i))
			return "it reads a length or an angle that follows a continuous joint, or has its freed offset";
	}
	return NULL;
}

static const char *why_node(const struct analysis *x, uint32_t i)
{
	const struct node *n = &x->dag.nodes[i];

	switch (n->op) {
	case OP_INPUT:
		return why_input(x, n);
	case OP_SIN:
	case OP_COS:
		return NULL;
	case OP_SQRT:
	case OP_DIV:
		return "it has a quotient or a root, as friction has";
	default:
		return why_operand(x, n);
	}
}

const char *left_out(const struct analysis *x, size_t output)
{
	unsigned char *live = malloc(x->dag.count);
	const char *why = live ? NULL : "there was no memory to look at it";

	if (live)
		left_out_reads(&x->dag, output, live);
	for (uint32_t i = 0; i < x->dag.count && !why; i++)
		if (live[i])
			why = why_node(x, i);
	free(live);
	return why;
}
