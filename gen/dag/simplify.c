/* The DAG's constructors with their rules. A sign moves outward through products and into sums, so that it costs
   nothing and x and -x are computed once; constants meet; a product by a negative constant is the negated product. */
#include "dag/dag.h"
#include "tree/spatial.h"

static const struct ref NONE = {0};

/* A copy: nodes move as they grow in number. */
static struct node at(const struct dag *d, struct ref a)
{
	return d->nodes[a.i];
}

static int is_const(const struct dag *d, struct ref a)
{
	return at(d, a).op == OP_CONST;
}

static int is_zero(struct ref a)
{
	return ref_equal(a, NONE);
}

/* A constant that is the same in all lanes, if there are any. */
static int is_number(const struct dag *d, struct ref a)
{
	return is_const(d, a) && !at(d, a).arg[0].i;
}

/* One of which rules may ask what it is. */
static int is_known(const struct dag *d, struct ref a)
{
	const struct node *n = &d->nodes[a.i];

	return is_number(d, a) && (!n->number || d->numbers[n->number - 1].limb <= 0);
}

static int is_value(const struct dag *d, struct ref a, real value)
{
	return is_known(d, a) && at(d, a).value == value;
}

static int is_negative(const struct dag *d, struct ref a)
{
	return is_known(d, a) && at(d, a).value < 0;
}

static int is_neg(const struct dag *d, struct ref a)
{
	return at(d, a).op == OP_NEG;
}

/* Constants first, then the older node: one text for a*b and b*a. */
static int in_order(const struct dag *d, struct ref a, struct ref b)
{
	if (is_const(d, a) != is_const(d, b))
		return is_const(d, a);
	return a.i <= b.i;
}

static struct within number(const struct dag *d, struct ref a)
{
	return dag_number(d, &d->nodes[a.i]);
}

static int are_same(const struct dag_lanes *a, const struct dag_lanes *b)
{
	return a->x[0] == b->x[0] && a->x[1] == b->x[1] && a->x[2] == b->x[2] && a->x[3] == b->x[3] && a->loop == b->loop;
}

/* The value is its place among the DAG's. */
struct ref dag_const_lanes(struct dag *d, struct dag_lanes x)
{
	struct dag_lanes *lanes = arena_grow(d->arena, d->lanes, d->lane_count, &d->lane_capacity, sizeof *lanes);
	int before = d->is_wide;
	struct ref r, place = {1};

	if (!lanes) {
		d->failed = 1;
		return NONE;
	}
	d->lanes = lanes;
	lanes[d->lane_count] = x;
	while (place.i <= d->lane_count && !are_same(&lanes[place.i - 1], &x))
		place.i++;
	d->lane_count += place.i > d->lane_count;
	d->is_wide = 1;
	r = dag_node(d, OP_CONST, place, NONE, NONE, place.i);
	d->is_wide = before;
	return r;
}

struct ref dag_pack(struct dag *d, const struct ref x[DAG_LANES])
{
	struct ref upper;

	if (ref_equal(x[0], x[1]) && (d->width == 2 || (ref_equal(x[0], x[2]) && ref_equal(x[0], x[3]))))
		return x[0];
	if (d->width == 2)
		return dag_node(d, OP_PACK, x[0], x[1], NONE, 0);
	upper = dag_node(d, OP_PAIR, x[2], x[3], NONE, 0);
	return dag_node(d, OP_PACK, dag_node(d, OP_PAIR, x[0], x[1], NONE, 0), upper, NONE, 0);
}

struct ref dag_lane(struct dag *d, struct ref lanes, int lane)
{
	struct node n;

	if (d->failed)
		return NONE;
	n = at(d, lanes);
	if (!n.is_wide)
		return lanes;
	if (n.op == OP_NEG)
		return dag_neg(d, dag_lane(d, n.arg[0], lane));
	return dag_node(d, (enum op)(OP_LANE0 + lane), lanes, NONE, NONE, 0);
}

static struct ref negated(struct dag *d, struct ref a)
{
	struct dag_lanes x;

	if (at(d, a).arg[0].i) {
		x = d->lanes[at(d, a).arg[0].i - 1];
		for (int i = 0; i < DAG_LANES; i++)
			x.x[i] = -x.x[i];
		return dag_const_lanes(d, x);
	}
	return dag_within(d, within_neg(number(d, a)));
}

struct ref dag_input_anew(struct dag *d, int argument, int row, int reading)
{
	struct ref a = {(uint32_t)argument}, r = {(uint32_t)row}, k = {(uint32_t)reading}, x = dag_node(d, OP_INPUT, a, r, k, 0);

	return d->is_wide ? dag_widen(d, x) : x;
}

struct ref dag_input(struct dag *d, int argument, int row)
{
	return dag_input_anew(d, argument, row, 0);
}

struct ref dag_input_each(struct dag *d, int argument, int row, int loop)
{
	return dag_input_anew(d, argument, row, DAG_EACH * loop);
}

/* The same constant in another type. */
static struct ref converted(struct dag *d, struct ref a, int is_wide)
{
	int before = d->is_wide;
	struct ref x;

	d->is_wide = is_wide;
	x = dag_within(d, number(d, a));
	d->is_wide = before;
	return x;
}

struct ref dag_widen(struct dag *d, struct ref a)
{
	if (d->failed || at(d, a).is_wide)
		return a;
	if (is_const(d, a))
		return converted(d, a, 1);
	return is_neg(d, a) ? dag_neg(d, dag_widen(d, at(d, a).arg[0])) : dag_node(d, OP_WIDEN, a, NONE, NONE, 0);
}

struct ref dag_narrow(struct dag *d, struct ref a)
{
	if (d->failed || !at(d, a).is_wide)
		return a;
	if (is_const(d, a))
		return converted(d, a, 0);
	if (is_neg(d, a))
		return dag_neg(d, dag_narrow(d, at(d, a).arg[0]));
	return at(d, a).op == OP_WIDEN ? at(d, a).arg[0] : dag_node(d, OP_NARROW, a, NONE, NONE, 0);
}

struct ref dag_neg(struct dag *d, struct ref a)
{
	struct ref swapped;

	if (d->failed)
		return NONE;
	if (is_const(d, a))
		return negated(d, a);
	if (is_neg(d, a))
		return at(d, a).arg[0];
	if (at(d, a).op == OP_SUB) {
		swapped = dag_find(d, OP_SUB, at(d, a).arg[1], at(d, a).arg[0], NONE, 0);
		if (swapped.i)
			return swapped;
	}
	return dag_node(d, OP_NEG, a, NONE, NONE, 0);
}

/* The sum of two constants, zero where it is only the rounding of the URDF's numbers. */
static struct ref const_sum(struct dag *d, struct within a, struct within b)
{
	struct sum s = {0};

	sum_add(&s, a);
	sum_add(&s, b);
	return dag_within(d, sum_total(s));
}

struct ref dag_add(struct dag *d, struct ref a, struct ref b)
{
	if (d->failed)
		return NONE;
	if (is_zero(a) || is_zero(b))
		return is_zero(a) ? b : a;
	if (is_number(d, a) && is_number(d, b))
		return const_sum(d, number(d, a), number(d, b));
	if (is_value(d, a, 0))
		return b;
	if (is_value(d, b, 0))
		return a;
	if (is_neg(d, a) && is_neg(d, b))
		return dag_neg(d, dag_add(d, at(d, a).arg[0], at(d, b).arg[0]));
	if (is_neg(d, b))
		return dag_sub(d, a, at(d, b).arg[0]);
	if (is_neg(d, a))
		return dag_sub(d, b, at(d, a).arg[0]);
	if (is_negative(d, a))
		return dag_sub(d, b, negated(d, a));
	if (is_negative(d, b))
		return dag_sub(d, a, negated(d, b));
	return in_order(d, a, b) ? dag_node(d, OP_ADD, a, b, NONE, 0) : dag_node(d, OP_ADD, b, a, NONE, 0);
}

struct ref dag_sub(struct dag *d, struct ref a, struct ref b)
{
	struct ref swapped;

	if (d->failed || ref_equal(a, b))
		return NONE;
	if (is_zero(a) || is_zero(b))
		return is_zero(a) ? dag_neg(d, b) : a;
	if (is_number(d, a) && is_number(d, b))
		return const_sum(d, number(d, a), within_neg(number(d, b)));
	if (is_value(d, a, 0))
		return dag_neg(d, b);
	if (is_value(d, b, 0))
		return a;
	if (is_neg(d, b))
		return dag_add(d, a, at(d, b).arg[0]);
	if (is_neg(d, a))
		return dag_neg(d, dag_add(d, at(d, a).arg[0], b));
	if (is_negative(d, b))
		return dag_add(d, a, negated(d, b));
	swapped = dag_find(d, OP_SUB, b, a, NONE, 0);
	return swapped.i ? dag_neg(d, swapped) : dag_node(d, OP_SUB, a, b, NONE, 0);
}

struct ref dag_mul(struct dag *d, struct ref a, struct ref b)
{
	if (d->failed || is_zero(a) || is_zero(b))
		return NONE;
	if (!in_order(d, a, b))
		return dag_mul(d, b, a);
	if (is_neg(d, a))
		return dag_neg(d, dag_mul(d, at(d, a).arg[0], b));
	if (is_neg(d, b))
		return dag_neg(d, dag_mul(d, a, at(d, b).arg[0]));
	if (is_number(d, a)) {
		if (is_number(d, b))
			return dag_within(d, within_mul(number(d, a), number(d, b)));
		if (is_value(d, a, 0))
			return NONE;
		if (is_negative(d, a))
			return dag_neg(d, dag_mul(d, negated(d, a), b));
		if (is_value(d, a, 1) && (!at(d, a).number || within_meets(number(d, a), within_exact(1))))
			return b;
		if (at(d, b).op == OP_MUL && is_number(d, at(d, b).arg[0]))
			return dag_mul(d, dag_mul(d, a, at(d, b).arg[0]), at(d, b).arg[1]);
	}
	return dag_node(d, OP_MUL, a, b, NONE, 0);
}

struct ref dag_sin(struct dag *d, struct ref a)
{
	if (d->failed)
		return NONE;
	if (is_number(d, a))
		return dag_within(d, within_sin(number(d, a)));
	if (is_neg(d, a))
		return dag_neg(d, dag_sin(d, at(d, a).arg[0]));
	return dag_node(d, OP_SIN, a, NONE, NONE, 0);
}

struct ref dag_cos(struct dag *d, struct ref a)
{
	if (d->failed)
		return NONE;
	if (is_number(d, a))
		return dag_within(d, within_cos(number(d, a)));
	if (is_neg(d, a))
		return dag_cos(d, at(d, a).arg[0]);
	return dag_node(d, OP_COS, a, NONE, NONE, 0);
}

/* A sign moves outward. */
struct ref dag_div(struct dag *d, struct ref a, struct ref b)
{
	if (d->failed)
		return NONE;
	if (is_value(d, a, 0))
		return a;
	if (is_number(d, a) && is_number(d, b))
		return dag_within(d, within_div(number(d, a), number(d, b)));
	if (is_neg(d, a))
		return dag_neg(d, dag_div(d, at(d, a).arg[0], b));
	return is_neg(d, b) ? dag_neg(d, dag_div(d, a, at(d, b).arg[0])) : dag_node(d, OP_DIV, a, b, NONE, 0);
}

struct ref dag_sqrt(struct dag *d, struct ref a)
{
	if (d->failed)
		return NONE;
	return is_number(d, a) ? dag_within(d, within_sqrt(number(d, a))) : dag_node(d, OP_SQRT, a, NONE, NONE, 0);
}

/* Squares and roots have no sign. */
struct ref dag_abs(struct dag *d, struct ref a)
{
	struct node n;

	if (d->failed)
		return NONE;
	n = at(d, a);
	if (is_known(d, a))
		return is_negative(d, a) ? negated(d, a) : a;
	if (n.op == OP_NEG)
		return dag_abs(d, n.arg[0]);
	if (n.op == OP_ABS || n.op == OP_SQRT || (n.op == OP_MUL && ref_equal(n.arg[0], n.arg[1])))
		return a;
	return dag_node(d, OP_ABS, a, NONE, NONE, 0);
}

struct ref dag_anew(struct dag *d, struct ref a)
{
	if (d->failed)
		return NONE;
	return is_const(d, a) || at(d, a).op == OP_ANEW ? a : dag_node(d, OP_ANEW, a, NONE, NONE, 0);
}

struct ref dag_fma(struct dag *d, struct ref a, struct ref b, struct ref c)
{
	if (d->failed)
		return NONE;
	return in_order(d, a, b) ? dag_node(d, OP_FMA, a, b, c, 0) : dag_node(d, OP_FMA, b, a, c, 0);
}

struct ref dag_operation(struct dag *d, enum op op, struct ref a, struct ref b, struct ref c)
{
	switch (op) {
	case OP_NEG:
		return dag_neg(d, a);
	case OP_ADD:
		return dag_add(d, a, b);
	case OP_SUB:
		return dag_sub(d, a, b);
	case OP_MUL:
		return dag_mul(d, a, b);
	case OP_FMA:
		return dag_fma(d, a, b, c);
	case OP_DIV:
		return dag_div(d, a, b);
	case OP_SQRT:
		return dag_sqrt(d, a);
	case OP_ABS:
		return dag_abs(d, a);
	case OP_ANEW:
		return dag_anew(d, a);
	case OP_WIDEN:
		return dag_widen(d, a);
	case OP_NARROW:
		return dag_narrow(d, a);
	case OP_SIN:
		return dag_sin(d, a);
	case OP_COS:
		return dag_cos(d, a);
	case OP_PAIR:
	case OP_PACK:
	case OP_LANE0:
	case OP_LANE1:
	case OP_LANE2:
	case OP_LANE3:
		return d->failed ? NONE : dag_node(d, op, a, b, c, 0);
	case OP_CONST:
	case OP_INPUT:
	case OP_COUNT:
		break;
	}
	d->failed = 1;
	return NONE;
}
