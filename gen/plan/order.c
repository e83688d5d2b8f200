/* Another order of the lines, in which fewer values wait. What a sweep over the whole DAG makes, a vjp above all, comes
   after all that it reads: nearly every value of the tour would wait for it. Here the rows of the last joints come
   first, each with what it takes and nothing else, and a line is written as soon as no more values wait after it than
   before. Or the bias comes before the row that takes it, and only then the factors of M: few values are left of the
   bias, and many of the factors. What makes a base's acceleration alone goes joint after joint (grid/base_first.h), and so
   may a jvp: of what it makes of a joint on the way out little is left for the way back. */
#include "plan/order.h"
#include "plan/stage.h"

/* An order is taken in which this much of the values wait, summed over the lines, and in which those that wait at once
   have room in registers or are this much of the DAG's own. H100, 1 M samples, ps, old and new: tau and vjp of atlas
   555, 396, of g1_29dof 790, 422, in f64 19400, 3110; qdd with gradients of hyq 263, 213, f64 540, 491. What is left
   out: Minv of atlas in f64, 174 of 232 at once, 924, 2410. */
static const double FEWER_IN_ALL = 0.8, FEWER_AT_ONCE = 0.6;

/* The same of accelerations, where much is spilled, or nothing. With the bias first, f64: atlas 1235, 970, g1_29dof 3088, 1833,
   jvrc1 4290, 2823; f32: jvrc1 813, 723, atlas 273, 269. What is left out: g1_29dof in f32, 0.61 in all, 311, 323; in f64
   floating atlas, 0.83 spilled, 3639, 3973. */
static const double SPILLS = 0.05, FEWER_SPILLED = 0.6, FEWER_ACCELERATIONS = 0.6;
enum { ROOM_SINGLE = 230, ROOM_DOUBLE = 110 };

/* The same of a part that shares nothing with others, which is to do without segments. H100, 1 M samples, f64, ps: g1_29dof, tau
   and vjp, 0.53 spilled, 3948, 1590; qdd of jvrc1, 0.74, 2766, 2682. */
static const double FEWER_IN_PART = 0.85;

/* Values that wait behind the lines. */
struct waiting {
	size_t most, sum;
	size_t spilled; /* the sum of those for which there is no room */
};

/* Of the plan's own lines where `order` is NULL. */
static struct waiting waiting_in(struct orderer *x, const uint32_t *order, size_t room)
{
	struct waiting w = {0};
	size_t now = 0;

	order_find_left(x);
	for (uint32_t i = 0; i < (order ? x->count : x->p->line_count); i++) {
		uint32_t line = order ? order[i] : i;
		struct ref made[2];

		now += (size_t)readings_made(x->p, &x->p->lines[line], made);
		for (uint32_t k = x->r.begin[line]; k < x->r.begin[line + 1]; k++)
			now -= --x->left[x->r.list[k].node] == 0;
		w.sum += now;
		w.spilled += now > room ? now - room : 0;
		w.most = now > w.most ? now : w.most;
	}
	return w;
}

static int is_better(struct waiting w, struct waiting own, size_t room)
{
	return w.sum < own.sum && (double)w.sum <= FEWER_IN_ALL * (double)own.sum &&
		(w.most <= room || (double)w.most <= FEWER_AT_ONCE * (double)own.most);
}

static int is_better_for_accelerations(struct waiting w, struct waiting own, size_t room)
{
	if ((double)own.spilled > SPILLS * (double)own.sum)
		return (double)w.spilled <= FEWER_SPILLED * (double)own.spilled;
	return (double)w.sum <= FEWER_ACCELERATIONS * (double)own.sum && w.most <= room;
}

static int is_better_for_part(struct waiting w, struct waiting own)
{
	if ((double)own.spilled > SPILLS * (double)own.sum)
		return (double)w.spilled <= FEWER_IN_PART * (double)own.spilled;
	return (double)w.sum <= FEWER_IN_ALL * (double)own.sum;
}

static int is_less(struct waiting a, struct waiting b)
{
	return a.spilled != b.spilled ? a.spilled < b.spilled : a.sum < b.sum;
}

static struct waiting write_as(struct orderer *x, enum order_way way, size_t room)
{
	order_write(x, way);
	return waiting_in(x, x->order, room);
}

/* By rows or in another way: leaves the lines in the order in which fewer values wait. */
static struct waiting write_less(struct orderer *x, enum order_way other, size_t room)
{
	struct waiting rows = write_as(x, ORDER_ROWS, room), w = write_as(x, other, room);

	if (is_less(w, rows))
		return w;
	order_write(x, ORDER_ROWS);
	return rows;
}

/* Where tau has the place of qdd in shared memory: is each joint's qdd read before its torque is stored? The torque of a
   joint that moves no mass does not take it. */
static int reads_first(const struct orderer *x, struct arena *a)
{
	const struct dag *d = x->p->dag;
	int tau = dag_find_role(d, ROLE_JOINT_TORQUE, 1), qdd = stage_place(d, tau);
	unsigned char *is_stored = arena_alloc(a, (size_t)x->t->nv + 1, 1); /* by row */

	for (uint32_t i = 0; i < x->count && is_stored && qdd != tau; i++) {
		const struct line *l = &x->p->lines[x->order[i]];
		const struct node *n = &d->nodes[l->value.i];

		if (l->kind == LINE_STORE && d->outputs[l->index].argument == tau)
			is_stored[d->outputs[l->index].row] = 1;
		else if (l->kind == LINE_INPUT && n->arg[0].i == (uint32_t)qdd && is_stored[n->arg[1].i])
			return 0;
	}
	return is_stored != NULL;
}

/* ---- the DAG in that order ---- */

static void copy_node(struct dag *out, const struct dag *d, uint32_t i, struct ref *map)
{
	const struct node *n = &d->nodes[i];
	struct ref arg[3] = {{0}};

	if (i == 0 || map[i].i)
		return;
	for (int k = 0; k < op_arity[n->op]; k++) {
		copy_node(out, d, n->arg[k].i, map);
		arg[k] = map[n->arg[k].i];
	}
	out->is_wide = n->is_wide;
	map[i] = op_arity[n->op] ? dag_node(out, n->op, arg[0], arg[1], arg[2], 0) : dag_copy_leaf(out, d, i);
	if (n->tag.quantity[0])
		dag_tag(out, map[i], n->tag.quantity, n->tag.body, n->tag.component);
}

static void copy_line(const struct orderer *x, const struct line *l, struct dag *out, struct ref *map)
{
	const struct dag *d = x->p->dag;
	struct ref made[2];

	for (int k = 0, values = readings_made(x->p, l, made); k < values; k++)
		copy_node(out, d, made[k].i, map);
	if (l->kind != LINE_STORE)
		return;
	copy_node(out, d, l->value.i, map);
	dag_output(out, d->outputs[l->index].argument, d->outputs[l->index].row, map[l->value.i]);
}

/* With a section for the rows of each joint, or for what its inputs are enough for. */
static void copy_all(const struct orderer *x, struct dag *out, struct ref *map)
{
	const enum section_kind kind = x->way == ORDER_INPUTS ? SECTION_INPUTS : SECTION_ROWS;
	int body = -1;

	out->width = x->p->dag->width;
	out->is_each = x->p->dag->is_each;
	for (int i = 0; i < x->p->dag->argument_count; i++)
		dag_argument_of(out, x->p->dag->arguments[i]);
	for (uint32_t i = 0; i < x->count; i++) {
		int next = tree_joint_of_row(x->t, x->row_at[i])->body;

		if (next != body)
			dag_section(out, kind, next);
		body = next;
		copy_line(x, &x->p->lines[x->order[i]], out, map);
	}
	out->is_wide = 0;
}

static int takes_over(const struct orderer *x, struct function *p, enum plan_ordered what, struct arena *a, struct arena *spare)
{
	struct ref *map = arena_alloc(spare, p->dag.count, sizeof *map);
	struct dag out;

	if (!map)
		return 0;
	dag_init(&out, a);
	copy_all(x, &out, map);
	if (out.failed)
		return 0;
	p->dag = out;
	return (what == ORDERED_BASE ? plan_build_by_joints : plan_build)(&p->plan, &p->dag, x->t, a);
}

/* Accelerations, and no matrix. */
static int is_acceleration(const struct request *k)
{
	return k->is_forward && !request_wants_derivative(k) && !request_wants(k, WANT_MINV);
}

static struct waiting write_lines(struct orderer *x, const struct request *k, enum plan_ordered what, size_t room)
{
	if (what == ORDERED_BASE)
		return write_as(x, ORDER_INPUTS, room);
	if (is_acceleration(k))
		return write_less(x, ORDER_BIAS, room);
	return request_wants(k, WANT_JVP) ? write_less(x, ORDER_INPUTS, room) : write_as(x, ORDER_ROWS, room);
}

static int takes(struct waiting w, struct waiting own, size_t room, const struct request *k, enum plan_ordered what)
{
	if (what == ORDERED_LOOPS)
		return 1;
	if (what == ORDERED_BASE)
		return is_less(w, own);
	if (what == ORDERED_PART)
		return is_better_for_part(w, own);
	return is_acceleration(k) ? is_better_for_accelerations(w, own, room) : is_better(w, own, room);
}

int plan_order(struct function *p, const struct tree *t, const struct request *k, const struct rneagen_options *o,
	enum plan_ordered what, struct arena *a)
{
	struct plan by_joints;
	struct orderer x = {.p = what == ORDERED_BASE ? &by_joints : &p->plan, .t = t};
	size_t room = o->precision == RNEAGEN_F32 ? ROOM_SINGLE : ROOM_DOUBLE;
	struct arena spare;
	int done;

	arena_init(&spare, &a->allocator);
	done = (what != ORDERED_BASE || plan_build_by_joints(&by_joints, &p->dag, t, &spare)) && order_begin(&x, &spare);
	if (done) {
		struct waiting own = waiting_in(&x, NULL, room);
		struct waiting w = write_lines(&x, k, what, room);

		if (takes(w, own, room, k, what) && reads_first(&x, &spare))
			done = takes_over(&x, p, what, a, &spare);
		done = done && !spare.failed;
	}
	arena_free(&spare);
	return done;
}
