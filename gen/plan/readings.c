#include "plan/readings.h"

/* A sine and cosine of one angle: some operations. */
enum { SINCOS_OPERATIONS = 24 };

int readings_made(const struct plan *p, const struct line *l, struct ref made[2])
{
	enum op op = p->dag->nodes[l->value.i].op;
	int count = 0;

	if (l->kind == LINE_INPUT || l->kind == LINE_VALUE || l->kind == LINE_FETCH || l->kind == LINE_SINE)
		made[count++] = l->value;
	if (l->kind != LINE_SINCOS)
		return count;
	for (enum op k = OP_SIN;; k = OP_COS) {
		struct ref x = k == op ? l->value : plan_partner(p, l->value, k);

		if (x.i)
			made[count++] = x;
		if (k == OP_COS)
			return count;
	}
}

static void read_value(struct readings *r, struct ref x, uint32_t line);

static void read_operands(struct readings *r, struct ref x, uint32_t line)
{
	const struct node *n = &r->plan->dag->nodes[x.i];

	r->weight[line] += n->op == OP_SIN || n->op == OP_COS ? SINCOS_OPERATIONS : n->op != OP_INPUT;
	for (int k = 0; k < op_arity[n->op]; k++)
		read_value(r, n->arg[k], line);
}

static void read_value(struct readings *r, struct ref x, uint32_t line)
{
	if (r->plan->dag->nodes[x.i].op == OP_CONST)
		return;
	if (!r->plan->names[x.i]) {
		read_operands(r, x, line);
		return;
	}
	for (uint32_t i = r->begin[line]; i < r->begin[line + 1]; i++)
		if (r->list[i].node == x.i)
			return;
	r->list[r->begin[line + 1]++] = (struct reading){x.i, r->last[x.i]};
}

static void read_line(struct readings *r, uint32_t i)
{
	const struct line *l = &r->plan->lines[i];
	struct ref made[2];

	r->begin[i + 1] = r->begin[i];
	if (l->kind == LINE_STORE || l->kind == LINE_KEEP)
		read_value(r, l->value, i);
	else if (l->kind == LINE_VALUE || l->kind == LINE_SINCOS)
		read_operands(r, l->value, i);
	for (uint32_t k = r->begin[i]; k < r->begin[i + 1]; k++)
		r->last[r->list[k].node] = i;
	for (int k = readings_made(r->plan, l, made); k-- > 0;)
		r->made[made[k].i] = r->last[made[k].i] = i;
}

/* An operand is read once by each that has it; what is left for others once more. */
static size_t most_readings(const struct dag *d)
{
	size_t count = d->output_count;

	for (size_t i = 0; i < d->count; i++)
		count += (size_t)op_arity[d->nodes[i].op];
	return count;
}

int readings_make(struct readings *r, const struct plan *p, struct arena *a)
{
	size_t nodes = p->dag->count;

	*r = (struct readings){.plan = p, .begin = arena_alloc(a, p->line_count + 1, sizeof *r->begin),
		.list = arena_take(a, most_readings(p->dag) + p->line_count, sizeof *r->list),
		.made = arena_alloc(a, nodes, sizeof *r->made), .last = arena_alloc(a, nodes, sizeof *r->last),
		.weight = arena_alloc(a, p->line_count, sizeof *r->weight)};
	if (a->failed)
		return 0;
	for (uint32_t i = 0; i < p->line_count; i++)
		read_line(r, i);
	return 1;
}

void readings_free(struct readings *r, struct arena *a)
{
	arena_release(a, r->weight);
	arena_release(a, r->last);
	arena_release(a, r->made);
	arena_release(a, r->list);
	arena_release(a, r->begin);
}

int readings_alive(int *most, const struct plan *p, struct arena *a)
{
	struct readings r;
	int alive = 0;

	*most = 0;
	if (!readings_make(&r, p, a))
		return 0;
	for (uint32_t i = 0; i < p->line_count; i++) {
		struct ref made[2];

		for (int k = readings_made(p, &p->lines[i], made); k-- > 0;)
			alive += r.last[made[k].i] > i;
		*most = alive > *most ? alive : *most;
		for (uint32_t k = r.begin[i]; k < r.begin[i + 1]; k++)
			alive -= r.last[r.list[k].node] == i;
	}
	readings_free(&r, a);
	return 1;
}

const unsigned char *readings_only_angles(const struct plan *p, struct arena *a)
{
	enum { READ_AS_ANGLE = 1, READ_OTHERWISE = 2 };
	unsigned char *how = arena_alloc(a, p->dag->count, 1);
	struct arena spare;
	struct readings r;

	if (!how)
		return NULL;
	arena_init(&spare, &a->allocator);
	if (readings_make(&r, p, &spare)) {
		for (uint32_t i = 0; i < p->line_count; i++)
			for (uint32_t k = r.begin[i]; k < r.begin[i + 1]; k++)
				how[r.list[k].node] |= p->lines[i].kind == LINE_SINCOS ? READ_AS_ANGLE : READ_OTHERWISE;
		for (size_t i = 0; i < p->dag->count; i++)
			how[i] = p->dag->nodes[i].op == OP_INPUT && how[i] == READ_AS_ANGLE;
	}
	a->failed |= spare.failed;
	arena_free(&spare);
	return how;
}

const struct tree_joint *readings_joint(const struct dag *d, const struct node *input, const struct tree *t)
{
	const struct argument *a = input->arg[0].i == DAG_STRUCK ? NULL : &d->arguments[input->arg[0].i];
	int row = (int)input->arg[1].i;

	if (a && a->role == ROLE_JOINT_POSITION)
		return tree_joint_of_q(t, row);
	if (!a || a->per_batch || !(a->rows == t->nv || (a->role == ROLE_VJP && a->rows == 3 * t->nv)))
		return NULL;
	return tree_joint_of_row(t, row % t->nv);
}

void readings_reach(int *reach, const struct dag *d, const struct tree *t)
{
	for (size_t i = 0; i < d->count; i++) {
		const struct node *n = &d->nodes[i];
		const struct tree_joint *j = n->op == OP_INPUT ? readings_joint(d, n, t) : NULL;

		reach[i] = j ? j->iv + j->nv - 1 : -1;
		for (int k = 0; k < op_arity[n->op]; k++)
			if (reach[n->arg[k].i] > reach[i])
				reach[i] = reach[n->arg[k].i];
	}
}
