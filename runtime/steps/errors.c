/* A text computes v + e where v is exact. Of each operation e is a linear function of its operands' e, with the derivatives of
   the exact operation for factors, plus what its own rounding and products of errors leave: its rest. So the output's e is
   exactly the sum over all operations of (the output's derivative by it) times (its rest). */
#include "steps/errors.h"
#include <math.h>

/* Sums of up to 2^20 magnitudes, each a few roundings. */
#define SUMMED (1 + 0x1p-30)
#define MADE (1 + 0x1p-44)

/* Far more than elements of rotations count that the generator takes for zero, or for equal, within the file's decimals. */
#define REPLACED 0x1p-30

static double size_of(const struct errors *x, struct operand p)
{
	return span_size(x->lengths.value[p.form]);
}

static double value_size(const struct errors *x, struct ref a)
{
	return size_of(x, x->forms.value[a.i]);
}

/* What a text reads, beside what is meant. */
static double given(const struct errors *x, const struct node *n, double size, const struct eval_model *m)
{
	real as_text = m->constant ? m->constant(n->value) : (real)(double)n->value, off;

	if (n->op == OP_INPUT)
		return m->input > 0 ? m->input * size + m->tiny : 0;
	off = fabsl(as_text - n->value) + (real)within_error(dag_number(x->d, n));
	return off > 0 ? (double)off * MADE + 2 * m->tiny : 0;
}

/* The largest rounding of a result whose exact value is within `size`, where operands are so much off that it is `more` beyond:
   half a unit in the last place, unit times the power of two at or below it. A pair of floats has no last place. */
static double rounding(const struct eval_model *m, double unit, double size, double more)
{
	double most = (size + more) * MADE;

	return unit * (m->terms > 0 || !(most >= 0x1p-1022 && most < (double)INFINITY) ? size : fmin(size, exp2(ilogb(most))));
}

/* What an operation inherits, linear in the operands' errors, and the rest of it that is not in product and sum. */
struct own {
	double inherited, rest;
};

static struct own own_sum(struct errors *x, uint32_t i, const struct eval_model *m, double inherited, double sizes, double rest)
{
	rest += m->terms * (sizes + inherited + x->product[i] + rest);
	x->sum[i] = rounding(m, m->add, value_size(x, (struct ref){i}), inherited + x->product[i] + rest);
	return (struct own){inherited, rest + m->add * (inherited + x->product[i] + rest) + m->tiny};
}

/* How far the angle is off that a sine or cosine reads: an input is read as it is; what was computed by pairs is read as a
   double. */
static double off_angle(const struct errors *x, uint32_t i, const struct eval_model *m)
{
	struct ref angle = x->d->nodes[i].arg[0];

	if (x->d->nodes[angle.i].op == OP_INPUT)
		return 0;
	return (x->off[angle.i] + (m->input > 0 ? m->store * (value_size(x, angle) + x->off[angle.i]) : 0)) * MADE;
}

/* The point (cos, sin) is moved by at most as much as the angle. */
static struct own own_wave(struct errors *x, uint32_t i, const struct eval_model *m)
{
	const struct node *n = &x->d->nodes[i];
	double off = off_angle(x, i, m);

	x->sum[i] = rounding(m, m->sincos, value_size(x, (struct ref){i}), off) + off;
	if (!(value_size(x, n->arg[0]) + off <= m->angle))
		return (struct own){0, (double)INFINITY};
	return (struct own){0, m->sincos * off + m->tiny + (n->op == OP_SIN ? m->sine : m->cosine)};
}

static struct own own_of(struct errors *x, uint32_t i, const struct eval_model *m)
{
	const struct node *n = &x->d->nodes[i];
	int arity = op_arity[n->op];
	double size[3] = {0}, off[3] = {0}, product, both;

	for (int k = 0; k < arity; k++) {
		size[k] = value_size(x, n->arg[k]);
		off[k] = x->off[n->arg[k].i];
	}
	product = size[0] * off[1] + size[1] * off[0];
	both = off[0] * off[1];
	switch (n->op) {
	case OP_CONST:
	case OP_INPUT:
		return (struct own){0, given(x, n, value_size(x, (struct ref){i}), m)};
	case OP_NEG:
	case OP_ANEW:
		return (struct own){off[0], 0};
	case OP_ADD:
	case OP_SUB:
		return own_sum(x, i, m, off[0] + off[1], size[0] + size[1], 0);
	case OP_MUL:
		x->product[i] = rounding(m, m->mul, value_size(x, (struct ref){i}), product + both);
		return (struct own){product, both + m->mul * (product + both) + m->tiny};
	case OP_FMA: /* a product rounded by itself is the worse, where that may be */
		x->product[i] = m->fused ? 0 : rounding(m, m->mul, size[0] * size[1] * MADE, product + both);
		return own_sum(x, i, m, product + off[2], size[0] * size[1] + size[2],
			both + (m->fused ? 0 : m->mul * (product + both) + m->tiny));
	case OP_SIN:
	case OP_COS:
		return own_wave(x, i, m);
	default:
		return (struct own){0, (double)INFINITY};
	}
}

static double slope_size(const struct errors *x, uint32_t i)
{
	return x->forms.slope[i].form ? size_of(x, x->forms.slope[i]) : 0;
}

/* What is saved by bounding twins together. It is taken from a sum that holds both, so it is rounded down. */
static double saved(const struct errors *x, const struct twins *t, const struct eval_model *m)
{
	const double *of = t->factor ? x->product : x->sum;
	double apart = slope_size(x, t->one) * of[t->one] + slope_size(x, t->other) * of[t->other];
	double values = t->factor ? span_size(x->lengths.value[t->factor]) : t->values ? x->lengths.norm[t->values - 1] : 1;
	double unit = t->factor ? m->mul : t->values ? m->add : m->sincos + off_angle(x, t->one, m);
	double together = unit * values * x->lengths.norm[t->slopes - 1] * MADE;

	if (t->factor && !(of[t->one] > 0 && of[t->other] > 0))
		return 0;
	return apart > together && apart < (double)INFINITY ? (apart - together) * (1 - 0x1p-30) : 0;
}

static double error_of(struct errors *x, const struct eval_model *m)
{
	double sum = 0, most;

	for (uint32_t i = 0; i < x->forms.dag_count; i++) {
		struct own own;
		double rest;

		x->product[i] = x->sum[i] = x->off[i] = 0;
		if (i && !x->forms.uses[i])
			continue;
		own = own_of(x, i, m);
		rest = (own.rest + x->product[i] + x->sum[i]) * MADE;
		x->off[i] = (own.inherited + rest) * MADE;
		if (!(value_size(x, (struct ref){i}) + x->off[i] <= m->largest))
			return (double)INFINITY;
		sum += rest > 0 ? slope_size(x, i) * rest : 0;
	}
	sum *= SUMMED;
	for (size_t k = 0; k < x->twin_count; k++)
		sum -= saved(x, &x->twins[k], m);
	sum = fmax(sum, 0);
	most = size_of(x, x->forms.root) + sum;
	if (!(most <= m->store_largest))
		return (double)INFINITY;
	return m->store > 0 ? (sum + m->store * most + m->store_tiny) * SUMMED : sum;
}

void errors_evaluate(struct errors *x, struct span *const *rows, struct box_bound *bound)
{
	double more;

	lengths_evaluate(&x->lengths, rows);
	bound->value = span_signed(x->lengths.value[x->forms.root.form], x->forms.root.is_minus);
	more = REPLACED * span_size(bound->value);
	bound->value = (struct span){out_down(bound->value.lo - more), out_up(bound->value.hi + more)};
	for (int k = 0; k < x->count; k++)
		bound->errors[k] = error_of(x, &x->models[k]);
}

/* ---- twins ---- */

/* A product, of its own or in a sum, with a sine or cosine, and what else is in it. */
static int product_term(const struct errors *x, uint32_t i, struct turn_term *t)
{
	const struct node *n = &x->d->nodes[i];

	return (n->op == OP_MUL || n->op == OP_FMA) && x->forms.slope[i].form &&
	       turn_term(&x->forms, x->forms.value[n->arg[0].i], x->forms.value[n->arg[1].i], t);
}

static void add_twins(struct errors *x, uint32_t i, uint32_t k, uint32_t factor, uint32_t values)
{
	uint32_t slopes = lengths_pair(&x->lengths, x->forms.slope[i].form, x->forms.slope[k].form);

	if (slopes)
		x->twins[x->twin_count++] = (struct twins){.one = i, .other = k, .factor = factor, .values = values, .slopes = slopes};
}

/* A node whose value is a turn, and is rounded as a sum. */
static const struct form *turn_at(const struct errors *x, uint32_t i)
{
	const struct form *f = &x->forms.list[x->forms.value[i].form];
	enum op op = x->d->nodes[i].op;

	return f->kind == FORM_TURN && x->forms.slope[i].form && (op == OP_FMA || op == OP_ADD || op == OP_SUB) ? f : NULL;
}

static int are_products(const struct errors *x, uint32_t i, uint32_t k, uint32_t *factor)
{
	struct turn_term p, q;

	if (!product_term(x, i, &p) || !product_term(x, k, &q) || p.angle != q.angle || p.is_sine == q.is_sine ||
		p.other.form != q.other.form)
		return 0;
	*factor = p.other.form;
	return *factor > FORM_ONE;
}

static int are_turns(const struct errors *x, uint32_t i, uint32_t k)
{
	const struct form *f = turn_at(x, i), *g = turn_at(x, k);

	return f && g && f->cosine == g->cosine && f->sine == g->sine && f->a.form == g->b.form && f->b.form == g->a.form;
}

static int are_waves(const struct errors *x, uint32_t i, uint32_t k)
{
	const struct node *n = &x->d->nodes[i], *m = &x->d->nodes[k];

	return n->op == OP_COS && m->op == OP_SIN && n->arg[0].i == m->arg[0].i && x->forms.slope[i].form && x->forms.slope[k].form;
}

/* Each rounding is in one pair at most: that of a product, and that of a sum. */
static void find_twins(struct errors *x, unsigned char *taken)
{
	uint32_t factor;

	for (uint32_t i = 1; i < x->forms.dag_count; i++)
		for (uint32_t k = 1; k < x->forms.dag_count; k++) {
			if (!x->forms.uses[i] || !x->forms.uses[k])
				continue;
			if (i < k && !((taken[i] | taken[k]) & 1) && are_products(x, i, k, &factor)) {
				taken[i] |= 1;
				taken[k] |= 1;
				add_twins(x, i, k, factor, 0);
			}
			if (i < k && !((taken[i] | taken[k]) & 2) && are_turns(x, i, k)) {
				uint32_t values = lengths_pair(&x->lengths, x->forms.value[i].form, x->forms.value[k].form);

				taken[i] |= 2;
				taken[k] |= 2;
				if (values)
					add_twins(x, i, k, 0, values);
			}
			if (are_waves(x, i, k))
				add_twins(x, i, k, 0, 0);
		}
}

int errors_make(struct errors *x, const struct dag *d, size_t output, const struct eval_model *models, int count, struct arena *a)
{
	unsigned char *taken;

	*x = (struct errors){.d = d, .models = models, .count = count};
	if (!forms_make(&x->forms, d, output, count > 0, a) || !lengths_make(&x->lengths, &x->forms, a))
		return 0;
	taken = arena_alloc(a, x->forms.dag_count, 1);
	x->twins = arena_alloc(a, 2 * (size_t)x->forms.dag_count, sizeof *x->twins);
	x->off = arena_alloc(a, x->forms.dag_count, sizeof *x->off);
	x->product = arena_alloc(a, x->forms.dag_count, sizeof *x->product);
	x->sum = arena_alloc(a, x->forms.dag_count, sizeof *x->sum);
	if (a->failed)
		return 0;
	if (count)
		find_twins(x, taken);
	return lengths_close(&x->lengths, a);
}
