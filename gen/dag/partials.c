#include "dag/eval.h"
#include <math.h>

void eval_partials(const struct node *n, const double *v, double *out)
{
	double a = op_arity[n->op] > 0 ? v[n->arg[0].i] : 0, b = op_arity[n->op] > 1 ? v[n->arg[1].i] : 0;

	switch (n->op) {
	case OP_MUL:
	case OP_FMA:
		out[0] = b;
		out[1] = a;
		out[2] = 1;
		break;
	case OP_DIV:
		out[0] = 1 / b;
		out[1] = -a / (b * b);
		break;
	case OP_SQRT:
		out[0] = 0.5 / sqrt(a);
		break;
	case OP_ABS:
		out[0] = a < 0 ? -1 : 1;
		break;
	case OP_SIN:
		out[0] = cos(a);
		break;
	case OP_COS:
		out[0] = -sin(a);
		break;
	default:
		out[0] = n->op == OP_NEG ? -1 : 1;
		if (op_arity[n->op] > 1)
			out[1] = n->op == OP_SUB ? -1 : 1;
	}
}
