/* Reverse mode: the slopes of an output by all values that it is made of come from one sweep back (Linnainmaa, Taylor
   expansion of the accumulated rounding error, BIT 16, 1976). Some outputs are swept at once, over no more than the terms
   that nothing has felt yet and what lies between. */
#include "draw/felt.h"
#include "dag/eval.h"
#include <math.h>

/* Outputs that are swept at once: a power of 2, 4 at least. */
enum { LANES = 16 };

#define NONE UINT32_MAX
#define MINUS 0x80000000u /* beside a factor's index: the factor is negated */

const struct draw_options FELT_SAMPLES = {.seed = 2, .count = 100, .each = 1};

/* What a step's slope gives to another's, times a partial derivative. */
struct edge {
	uint32_t to, by; /* a step, and when all are made its slot; an index of `factors` */
};

/* A value on the way from outputs to terms. Sums of one use have the slope of what uses them, or its negative, and belong to
   its step. */
struct step {
	uint32_t node, slot;
	uint32_t edge, term; /* its first; the next step's are the end */
};

struct finding {
	const struct dag *d;
	double fraction;
	struct drawn inputs;
	unsigned char *unfelt;  /* the result */
	size_t unfelt_count, unfelt_before; /* now, and when the steps were made */
	uint32_t *uses;         /* by node; 0: it is dead */
	uint32_t *derivatives;  /* by node: where its own begin among the factors; 0: it has none */
	double *factors;        /* in one sample: values by node; 1; derivatives that are neither an operand nor 1 or -1 */
	size_t factor_count;
	double *scale;          /* by output: its largest magnitude */
	char *mark;             /* by node: unfelt terms are below */
	uint32_t *owner;        /* by node: the node of its step, with MINUS where its slope is the negative */
	uint32_t *step_of;      /* by node: its step */
	struct step *steps;
	struct edge *edges;
	uint32_t *terms;        /* of sums: node 2 + operand */
	uint32_t *free_slots;
	size_t step_count, slot_count, free_count;
	double (*slope)[LANES]; /* by slot: of some outputs, each over the output's scale */
	char *reached;          /* by slot: it has slopes */
};

/* ---- the way from outputs to terms ---- */

/* The derivative of a node by its operand. */
static uint32_t factor_of(const struct finding *f, size_t node, int operand)
{
	const struct node *n = &f->d->nodes[node];
	uint32_t one = (uint32_t)f->d->count;

	if (n->op == OP_MUL)
		return n->arg[!operand].i;
	if (n->op == OP_NEG || (n->op == OP_SUB && operand == 1))
		return one | MINUS;
	return f->derivatives[node] ? f->derivatives[node] + (uint32_t)operand : one;
}

static void mark_open(struct finding *f)
{
	for (size_t i = 0; i < f->d->count; i++) {
		const struct node *n = &f->d->nodes[i];

		f->mark[i] = f->unfelt[i] != 0;
		for (int k = 0; k < op_arity[n->op]; k++)
			f->mark[i] |= f->uses[i] && f->mark[n->arg[k].i];
	}
}

/* Each node's step: its own, or that of its one user. */
static void find_owners(struct finding *f)
{
	uint32_t one = (uint32_t)f->d->count;

	f->step_count = 0;
	for (size_t i = 0; i < f->d->count; i++)
		f->owner[i] = (uint32_t)i;
	for (size_t i = f->d->count; i-- > 0;)
		for (int k = 0; k < op_arity[f->d->nodes[i].op] && f->mark[i]; k++) {
			uint32_t a = f->d->nodes[i].arg[k].i, by = factor_of(f, i, k);

			if (f->uses[a] == 1 && (by & ~MINUS) == one)
				f->owner[a] = f->owner[i] ^ (by & MINUS);
		}
	for (size_t i = 0; i < f->d->count; i++) {
		f->step_of[i] = NONE;
		if (!f->mark[i] || f->owner[i] != i)
			continue;
		f->step_of[i] = (uint32_t)f->step_count;
		f->steps[f->step_count++] = (struct step){(uint32_t)i, NONE, 0, 0};
	}
	f->steps[f->step_count] = (struct step){0};
}

static struct step *step_at(const struct finding *f, size_t node)
{
	return &f->steps[f->step_of[f->owner[node] & ~MINUS]];
}

/* Does an operand take slopes of its own? */
static int is_edge(const struct finding *f, uint32_t operand)
{
	return f->mark[operand] && f->owner[operand] == operand;
}

static void count_edges(struct finding *f)
{
	for (size_t i = 0; i < f->d->count; i++)
		for (int k = 0; k < op_arity[f->d->nodes[i].op] && f->mark[i]; k++) {
			step_at(f, i)->edge += (uint32_t)is_edge(f, f->d->nodes[i].arg[k].i);
			step_at(f, i)->term += (uint32_t)(f->unfelt[i] >> k & 1);
		}
	for (size_t i = 1; i <= f->step_count; i++) { /* where each ends, from where it is filled */
		f->steps[i].edge += f->steps[i - 1].edge;
		f->steps[i].term += f->steps[i - 1].term;
	}
}

static void fill_edges(struct finding *f)
{
	for (size_t i = f->d->count; i-- > 0;)
		for (int k = 0; k < op_arity[f->d->nodes[i].op] && f->mark[i]; k++) {
			uint32_t a = f->d->nodes[i].arg[k].i, sign = f->owner[i] & MINUS;
			struct step *s = step_at(f, i);

			if (is_edge(f, a))
				f->edges[--s->edge] = (struct edge){f->step_of[a], factor_of(f, i, k) ^ sign};
			if (f->unfelt[i] >> k & 1)
				f->terms[--s->term] = (uint32_t)(2 * i + (size_t)k);
		}
}

static void take_slot(struct finding *f, struct step *s)
{
	if (s->slot == NONE)
		s->slot = f->free_count ? f->free_slots[--f->free_count] : (uint32_t)f->slot_count++;
}

/* From the last step to the first: one needs its slot from the first that gives to it until it has given itself. */
static void share_slots(struct finding *f)
{
	f->slot_count = f->free_count = 0;
	for (size_t i = 0; i < f->d->output_count; i++)
		if (f->step_of[f->d->outputs[i].value.i] != NONE)
			take_slot(f, &f->steps[f->step_of[f->d->outputs[i].value.i]]);
	for (size_t i = f->step_count; i-- > 0;) {
		for (uint32_t k = f->steps[i].edge; k < f->steps[i + 1].edge; k++) {
			take_slot(f, &f->steps[f->edges[k].to]);
			f->edges[k].to = f->steps[f->edges[k].to].slot;
		}
		f->free_slots[f->free_count++] = f->steps[i].slot;
	}
}

static void make_steps(struct finding *f)
{
	mark_open(f);
	find_owners(f);
	count_edges(f);
	fill_edges(f);
	share_slots(f);
	f->unfelt_before = f->unfelt_count;
}

/* ---- one sample ---- */

/* What is not drawn is no number, so that its terms stay. */
static double input_of(const struct finding *f, const struct node *n, size_t sample)
{
	const double *rows;

	if ((int)n->arg[0].i >= f->d->argument_count)
		return 0; /* nothing that is said depends on it */
	rows = draw_rows(&f->inputs, &f->d->arguments[n->arg[0].i], sample);
	return rows ? rows[n->arg[1].i] : (double)NAN;
}

static void evaluate(struct finding *f, size_t sample)
{
	double *v = f->factors;

	for (size_t i = 0; i < f->d->count; i++) {
		const struct node *n = &f->d->nodes[i];

		v[i] = n->op == OP_INPUT ? input_of(f, n, sample) : eval_node(n, v);
		if (f->derivatives[i])
			eval_partials(n, v, v + f->derivatives[i]);
	}
}

static void note_scales(struct finding *f)
{
	for (size_t i = 0; i < f->d->output_count; i++) {
		double size = fabs(f->factors[f->d->outputs[i].value.i]);

		f->scale[i] = isfinite(size) ? fmax(f->scale[i], size) : (double)INFINITY;
	}
}

/* ---- some outputs ---- */

static void give(struct finding *f, uint32_t to, const double *restrict slope, double by)
{
	double *restrict x = f->slope[to];

	if (f->reached[to]) {
		for (int lane = 0; lane < LANES; lane++)
			x[lane] += slope[lane] * by;
		return;
	}
	f->reached[to] = 1;
	for (int lane = 0; lane < LANES; lane++)
		x[lane] = slope[lane] * by;
}

/* The magnitudes together, of which no lane has more. */
static double total(const double *slope)
{
	double part[LANES / 2];

	for (int lane = 0; lane < LANES / 2; lane++)
		part[lane] = fabs(slope[lane]) + fabs(slope[lane + LANES / 2]);
	for (int lane = 1; lane < LANES / 2; lane++)
		part[0] += part[lane];
	return part[0];
}

/* Is a term's part of an output ever the fraction of its scale? What is no number is. */
static int is_felt(const struct finding *f, const double *slope, double value)
{
	for (int lane = 0; lane < LANES; lane++)
		if (!(fabs(slope[lane] * value) < f->fraction))
			return 1;
	return 0;
}

static void note(struct finding *f, const struct step *s, const double *slope)
{
	double sum = total(slope);

	for (uint32_t i = s->term; i < s[1].term; i++) {
		uint32_t node = f->terms[i] / 2, k = f->terms[i] % 2;
		double value = f->factors[f->d->nodes[node].arg[k].i];

		if (sum * fabs(value) < f->fraction || !(f->unfelt[node] >> k & 1) || !is_felt(f, slope, value))
			continue;
		f->unfelt[node] &= (unsigned char)~(1 << k);
		f->unfelt_count--;
	}
}

/* The slopes of outputs first, first + 1, ... by themselves; returns the last step and 1. */
static size_t start(struct finding *f, size_t first)
{
	size_t top = 0;

	for (size_t i = first; i < first + LANES && i < f->d->output_count; i++) {
		double one[LANES] = {0};
		uint32_t step = f->step_of[f->d->outputs[i].value.i];

		if (f->scale[i] == 0 || step == NONE)
			continue;
		one[i - first] = isfinite(f->scale[i]) ? 1 / f->scale[i] : (double)INFINITY;
		give(f, f->steps[step].slot, one, 1);
		top = step >= top ? step + 1 : top;
	}
	return top;
}

static void sweep(struct finding *f, size_t first)
{
	for (size_t i = start(f, first); i-- > 0;) {
		const struct step *s = &f->steps[i];
		const double *slope = f->slope[s->slot];

		if (!f->reached[s->slot])
			continue;
		f->reached[s->slot] = 0;
		if (s->term < s[1].term)
			note(f, s, slope);
		for (uint32_t k = s->edge; k < s[1].edge; k++) {
			double by = f->factors[f->edges[k].by & ~MINUS];

			give(f, f->edges[k].to, slope, f->edges[k].by & MINUS ? -by : by);
		}
	}
}

/* Steps are made anew where much fewer are needed. */
static void examine(struct finding *f)
{
	for (size_t k = 0; k < f->inputs.samples; k++) {
		evaluate(f, k);
		note_scales(f);
	}
	for (size_t k = 0; k < f->inputs.samples; k++) {
		evaluate(f, k);
		for (size_t i = 0; i < f->d->output_count; i += LANES) {
			if (i == 0 ? f->unfelt_count < f->unfelt_before : f->unfelt_count < f->unfelt_before / 8 * 7)
				make_steps(f);
			sweep(f, i);
		}
	}
}

/* ---- the whole ---- */

/* All operands of sums at first, but v^2 + width^2 under a root is not v^2, however small the width is beside the drawn v:
   the terms of what a root or quotient is taken of keep it from 0. */
static void begin(struct finding *f)
{
	dag_uses(f->d, f->uses);
	for (size_t i = f->d->count; i-- > 0;) {
		const struct node *n = &f->d->nodes[i];

		if (n->op == OP_SQRT || n->op == OP_DIV)
			f->mark[n->arg[n->op == OP_DIV].i] = 1;
		for (int k = 0; k < op_arity[n->op] && f->mark[i]; k++)
			f->mark[n->arg[k].i] = 1;
		if (!f->uses[i] || f->mark[i] || (n->op != OP_ADD && n->op != OP_SUB))
			continue;
		f->unfelt[i] = 3;
		f->unfelt_count += 2;
	}
}

/* Derivatives that need a place among the factors. */
static void list_derivatives(struct finding *f)
{
	f->factor_count = f->d->count + 1;
	for (size_t i = 0; i < f->d->count; i++) {
		enum op op = f->d->nodes[i].op;

		if (op_arity[op] == 0 || op == OP_NEG || op == OP_ADD || op == OP_SUB || op == OP_MUL)
			continue;
		f->derivatives[i] = (uint32_t)f->factor_count;
		f->factor_count += op_arity[op];
	}
}

static int alloc(struct finding *f, const struct tree *t, const struct request *k, struct arena *a)
{
	size_t count = f->d->count;

	f->uses = arena_alloc(a, count, sizeof *f->uses);
	f->derivatives = arena_alloc(a, count, sizeof *f->derivatives);
	f->scale = arena_alloc(a, f->d->output_count, sizeof *f->scale);
	f->mark = arena_alloc(a, count, 1);
	f->owner = arena_alloc(a, count, sizeof *f->owner);
	f->step_of = arena_alloc(a, count, sizeof *f->step_of);
	f->steps = arena_alloc(a, count + 1, sizeof *f->steps);
	f->edges = arena_alloc(a, 3 * count, sizeof *f->edges);
	f->terms = arena_alloc(a, 2 * count, sizeof *f->terms);
	f->free_slots = arena_alloc(a, count, sizeof *f->free_slots);
	if (a->failed || !draw_inputs(&f->inputs, t, k, &FELT_SAMPLES, a))
		return 0;
	list_derivatives(f);
	begin(f);
	make_steps(f);
	f->factors = arena_alloc(a, f->factor_count, sizeof *f->factors);
	f->slope = arena_alloc(a, f->slot_count, sizeof *f->slope);
	f->reached = arena_alloc(a, f->slot_count, 1);
	if (a->failed)
		return 0;
	f->factors[count] = 1;
	return 1;
}

unsigned char *felt_find(const struct dag *d, const struct tree *t, const struct request *k, double fraction, struct arena *a)
{
	struct finding f = {.d = d, .fraction = fraction, .unfelt = arena_alloc(a, d->count, 1)};
	struct arena spare;
	int done;

	if (!f.unfelt)
		return NULL;
	arena_init(&spare, &a->allocator);
	done = alloc(&f, t, k, &spare);
	if (done)
		examine(&f);
	arena_free(&spare);
	return done ? f.unfelt : NULL;
}
