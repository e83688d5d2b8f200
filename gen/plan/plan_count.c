/* Operations of a plan, and the values that are alive at once. */
#include "plan/plan.h"

struct operation_count plan_operations_of(const struct dag *d, size_t first, size_t end)
{
	struct operation_count n = {0};

	for (size_t i = first; i < end; i++) {
		enum op op = d->nodes[i].op;
		unsigned before = plan_flops(n);

		n.mul += op == OP_MUL || op == OP_DIV || op == OP_SQRT;
		n.add += op == OP_ADD;
		n.sub += op == OP_SUB;
		n.neg += op == OP_NEG;
		n.fma += op == OP_FMA;
		n.wide += d->nodes[i].is_wide ? plan_flops(n) - before : 0;
	}
	return n;
}

unsigned plan_sincos(const struct plan *p)
{
	unsigned count = 0;

	for (size_t i = 0; i < p->line_count; i++)
		count += p->lines[i].kind == LINE_SINCOS;
	return count;
}

struct operation_count plan_operations(const struct plan *p)
{
	struct operation_count n = plan_operations_of(p->dag, 0, p->dag->count);

	n.sincos = plan_sincos(p);
	return n;
}

void plan_add_operations(struct operation_count *sum, struct operation_count n, unsigned times)
{
	sum->mul += n.mul * times;
	sum->add += n.add * times;
	sum->sub += n.sub * times;
	sum->neg += n.neg * times;
	sum->fma += n.fma * times;
	sum->sincos += n.sincos * times;
	sum->wide += n.wide * times;
}

unsigned plan_instructions(struct operation_count n)
{
	return n.mul + n.add + n.sub + n.fma;
}

unsigned plan_flops(struct operation_count n)
{
	return plan_instructions(n) + n.fma;
}

struct waits plan_waits(const struct plan *p, int room, struct arena *a)
{
	const struct dag *d = p->dag;
	uint32_t *last = arena_alloc(a, d->count, sizeof *last);
	struct waits w = {0};
	int alive = 0;

	for (uint32_t i = 0; last && i < d->count; i++)
		for (int k = 0; k < op_arity[d->nodes[i].op]; k++)
			last[d->nodes[i].arg[k].i] = i;
	for (uint32_t i = 0; last && i < d->count; i++) {
		const struct node *n = &d->nodes[i];

		alive += n->op != OP_CONST && last[i] > i;
		w.most = alive > w.most ? alive : w.most;
		w.beyond += alive > room ? (size_t)(alive - room) : 0;
		for (int k = 0; k < op_arity[n->op]; k++) {
			uint32_t x = n->arg[k].i;

			if (last[x] == i && d->nodes[x].op != OP_CONST) {
				alive--;
				last[x] = 0;
			}
		}
	}
	arena_release(a, last);
	return w;
}

int plan_alive(const struct plan *p, struct arena *a)
{
	return plan_waits(p, 0, a).most;
}
