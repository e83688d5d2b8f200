/* What is known of each node: the rows of q that it depends on and of which degree, of which order it is in drives and
   rates, and how far off what is computed of it is. */
#include "peaks/peaks.h"
#include <float.h>
#include <string.h>

/* Values above it have squares that doubles may not have. */
#define LARGEST 0x1p+400

/* Orders of terms, bit k: of order k, where rates are of order 1 and drives of order 2; OTHER: what is no polynomial,
   or of a row of q that is none of p->dims. */
enum { PLAIN = 1, LINEAR = 2, FIELD = 7, OTHER = 1 << 7 };

struct marks {
	struct peaks *p;
	unsigned char *orders, *is_even,
		*is_value; /* is_even: no rate has a range with another middle than 0; is_value: of the output itself */
	unsigned char *degrees; /* [node][dim] */
	uint64_t *dims;
};

/* ---- the box of all angles ---- */

static void find_angles(struct peaks *p)
{
	memset(p->is_angle, 1, (size_t)p->dim_count + 1);
	for (size_t i = 0; i < p->x->d.count; i++) {
		const struct node *n = &p->x->d.nodes[i];

		for (int k = 0; k < op_arity[n->op]; k++) {
			const struct node *q = &p->x->d.nodes[n->arg[k].i];

			for (int l = 0; l < p->dim_count && q->op == OP_INPUT && (int)q->arg[0].i == p->position; l++)
				if (p->dims[l] == (int)q->arg[1].i && n->op != OP_SIN && n->op != OP_COS)
					p->is_angle[l] = 0;
		}
	}
}

static int make_whole(struct peaks *p)
{
	for (int i = 0; i < p->x->d.argument_count; i++) {
		size_t rows = p->rows[i] ? (size_t)p->x->d.arguments[i].rows : 0;

		p->whole_rows[i] = p->rows[i] ? arena_alloc(p->arena, rows + 1, sizeof **p->whole_rows) : NULL;
		if (p->arena->failed)
			return 0;
		if (rows)
			memcpy(p->whole_rows[i], p->rows[i], rows * sizeof **p->whole_rows);
	}
	for (int k = 0; k < p->dim_count; k++)
		if (p->is_angle[k])
			p->whole_rows[p->position][p->dims[k]] = interval_turn();
	if (!norms_values_make(&p->whole, p->norms, p->arena))
		return 0;
	norms_evaluate(p->norms, (const struct interval *const *)p->whole_rows, &p->whole);
	return 1;
}

/* ---- nodes ---- */

static unsigned orders_of_product(unsigned a, unsigned b)
{
	unsigned orders = 0;

	for (int i = 0; i < 8; i++)
		orders |= a >> i & 1 ? b << i : 0;
	return orders > FIELD ? OTHER : orders;
}

static unsigned char *degrees_at(const struct marks *m, uint32_t i)
{
	return m->degrees + (size_t)i * (size_t)(m->p->dim_count + 1);
}

static void mark_input(struct marks *m, uint32_t i)
{
	const struct peaks *p = m->p;
	const struct node *n = &p->x->d.nodes[i];
	struct interval r = p->rows[n->arg[0].i][n->arg[1].i];

	if ((int)n->arg[0].i != p->position) {
		int is_rate = p->x->d.arguments[n->arg[0].i].role == ROLE_JOINT_VELOCITY;

		m->orders[i] = is_rate ? 2 : 4;
		m->is_even[i] = !is_rate || r.lower == -r.upper;
		return;
	}
	m->orders[i] = r.lower == r.upper ? PLAIN : OTHER;
	for (int k = 0; k < p->dim_count && k < PEAKS_DIMS; k++)
		if (p->dims[k] == (int)n->arg[1].i) {
			m->orders[i] = PLAIN;
			m->dims[i] = (uint64_t)1 << k;
			degrees_at(m, i)[k] = p->is_angle[k] ? PEAK_NO_DEGREE : 1;
		}
}

static void mark_degrees(struct marks *m, uint32_t i)
{
	const struct node *n = &m->p->x->d.nodes[i];

	for (int k = 0; k < m->p->dim_count; k++) {
		unsigned a = op_arity[n->op] > 0 ? degrees_at(m, n->arg[0].i)[k] : 0;
		unsigned b = op_arity[n->op] > 1 ? degrees_at(m, n->arg[1].i)[k] : 0;
		unsigned sum = n->op == OP_MUL ? a + b : a > b ? a : b;

		if (n->op == OP_SIN || n->op == OP_COS)
			sum = a == 0 ? 0 : m->p->is_angle[k] ? 1 : PEAK_NO_DEGREE;
		degrees_at(m, i)[k] = (unsigned char)(sum < PEAK_NO_DEGREE ? sum : PEAK_NO_DEGREE);
	}
}

static void mark_operation(struct marks *m, uint32_t i)
{
	const struct node *n = &m->p->x->d.nodes[i];
	uint32_t a = n->arg[0].i, b = n->arg[1].i;

	switch (n->op) {
	case OP_CONST:
		m->orders[i] = PLAIN;
		return;
	case OP_NEG:
		m->orders[i] = m->orders[a];
		return;
	case OP_ADD:
	case OP_SUB:
		m->orders[i] = m->orders[a] | m->orders[b];
		return;
	case OP_MUL:
		m->orders[i] = (unsigned char)orders_of_product(m->orders[a], m->orders[b]);
		return;
	case OP_SIN:
	case OP_COS:
		m->orders[i] = m->p->x->d.nodes[a].op == OP_INPUT && m->orders[a] == PLAIN ? PLAIN : OTHER;
		return;
	default:
		m->orders[i] = OTHER;
	}
}

/* How far off values are that are computed at points. A constant may be replaced where the file's numbers cannot tell
   it from another. */
static double noise_of(const struct peaks *p, const struct node *n, double size)
{
	uint32_t a = n->arg[0].i, b = n->arg[1].i;
	double noise;

	switch (n->op) {
	case OP_CONST:
		return within_error(dag_number(&p->x->d, n)) + 0x1p-50 * size;
	case OP_INPUT:
		return (int)n->arg[0].i == p->position ? 0 : 0x1p-50 * size;
	case OP_SIN:
	case OP_COS:
		return 0x1p-52;
	case OP_NEG:
		return p->noise[a];
	case OP_MUL:
		noise = p->whole.size[a] * p->noise[b] + p->whole.size[b] * p->noise[a] + p->noise[a] * p->noise[b];
		break;
	default:
		noise = p->noise[a] + p->noise[b];
	}
	return (noise + 0x1p-52 * (size + noise)) * (1 + 0x1p-48) + DBL_MIN;
}

static void mark_node(struct marks *m, uint32_t i)
{
	struct peaks *p = m->p;
	const struct node *n = &p->x->d.nodes[i];

	m->is_even[i] = 1;
	for (int k = 0; k < op_arity[n->op]; k++) {
		m->dims[i] |= m->dims[n->arg[k].i];
		m->is_even[i] = m->is_even[i] && m->is_even[n->arg[k].i];
	}
	mark_degrees(m, i);
	if (n->op == OP_INPUT)
		mark_input(m, i);
	else
		mark_operation(m, i);
	p->noise[i] = noise_of(p, n, p->whole.size[i]);
	if (m->orders[i] > FIELD || !(p->whole.size[i] + p->noise[i] < LARGEST))
		m->orders[i] = OTHER;
}

static int marks_make(struct marks *m, struct peaks *p)
{
	size_t count = p->x->d.count;

	*m = (struct marks){p, arena_alloc(p->arena, count, 1), arena_alloc(p->arena, count, 1),
		arena_alloc(p->arena, count, 1), arena_alloc(p->arena, count * (size_t)(p->dim_count + 1), 1),
		arena_alloc(p->arena, count, sizeof *m->dims)};
	if (p->arena->failed)
		return 0;
	p->reads = m->dims;
	for (uint32_t i = 0; i < count; i++)
		mark_node(m, i);
	m->is_value[p->x->root.i] = 1;
	dag_mark_operands(&p->x->d, count, m->is_value);
	return 1;
}

/* ---- peaks ---- */

/* Derivatives with terms of rates' products are too many for what they gain. */
static int kind_of(const struct marks *m, const struct peak *k)
{
	unsigned orders = m->orders[k->nodes[0]] | m->orders[k->nodes[1]];

	if (orders == PLAIN)
		return PEAK_PLAIN;
	if (orders == LINEAR && m->is_even[k->nodes[0]] && m->is_even[k->nodes[1]])
		return PEAK_LINEAR;
	return orders <= FIELD && m->is_value[k->nodes[0]] && m->is_value[k->nodes[1]] ? PEAK_FULL : PEAK_UNKNOWN;
}

static int mark_peak(const struct marks *m, struct peak *k)
{
	struct peaks *p = m->p;
	size_t count = (size_t)p->dim_count + 1;

	k->nodes[1] = k->pair ? k->nodes[1] : k->nodes[0];
	k->kind = kind_of(m, k);
	k->dims = m->dims[k->nodes[0]] | m->dims[k->nodes[1]];
	k->whole = k->pair ? norms_of_pair(p->norms, &p->whole, k->pair) : p->whole.size[k->nodes[0]];
	k->tilts = arena_alloc(p->arena, count, sizeof *k->tilts);
	k->bends = arena_alloc(p->arena, count, sizeof *k->bends);
	k->near = arena_alloc(p->arena, count, sizeof *k->near);
	k->degrees = arena_alloc(p->arena, count, 1);
	for (size_t i = 0; i + 1 < count && k->degrees; i++) {
		unsigned char a = degrees_at(m, k->nodes[0])[i], b = degrees_at(m, k->nodes[1])[i];

		k->degrees[i] = a > b ? a : b;
		if (p->is_angle[i] && k->degrees[i] == PEAK_NO_DEGREE) /* the angle itself */
			k->kind = PEAK_UNKNOWN;
	}
	return !p->arena->failed;
}

int peaks_mark(struct peaks *p)
{
	struct marks m;
	int done;

	p->noise = arena_alloc(p->arena, p->x->d.count, sizeof *p->noise);
	p->is_angle = arena_alloc(p->arena, (size_t)p->dim_count + 1, 1);
	if (p->arena->failed)
		return 0;
	find_angles(p);
	done = make_whole(p) && marks_make(&m, p);
	for (size_t i = 0; i < p->count && done; i++)
		done = mark_peak(&m, &p->list[i]);
	return done;
}
