/* Which peaks there are points for, and in which groups: those of one kind that depend on the same rows of q. */
#define _POSIX_C_SOURCE 200809L
#include "peaks/peaks.h"
#include "core/seconds.h"
#include <float.h>
#include <math.h>
#include <string.h>
#ifdef PEAKS_TELL
#include <stdio.h>
#endif

/* Of the time: for second derivatives. Values above LARGEST have squares that doubles may not have. */
#define SHARE_BENDS 0.3
#define LARGEST 0x1p+400

/* Orders of terms, bit k: of order k, where rates are of order 1 and drives of order 2; OTHER: what is no polynomial, or of a row
   of q that is none of p->dims. */
enum { PLAIN = 1, LINEAR = 2, FIELD = 7, OTHER = 1 << 7 };

struct marks {
	const struct peaks *p;
	unsigned char *orders, *is_even; /* is_even: no rate has a range with another middle than 0 */
	uint64_t *dims;
};

/* ---- nodes ---- */

static unsigned orders_of_product(unsigned a, unsigned b)
{
	unsigned orders = 0;

	for (int i = 0; i < 8; i++)
		orders |= a >> i & 1 ? b << i : 0;
	return orders > FIELD ? OTHER : orders;
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
		}
}

static void mark_node(struct marks *m, uint32_t i)
{
	const struct node *n = &m->p->x->d.nodes[i];
	uint32_t a = n->arg[0].i, b = n->arg[1].i;

	m->is_even[i] = 1;
	for (int k = 0; k < op_arity[n->op]; k++) {
		m->dims[i] |= m->dims[n->arg[k].i];
		m->is_even[i] = m->is_even[i] && m->is_even[n->arg[k].i];
	}
	switch (n->op) {
	case OP_CONST:
		m->orders[i] = PLAIN;
		return;
	case OP_INPUT:
		mark_input(m, i);
		return;
	case OP_NEG:
		m->orders[i] = m->orders[a];
		return;
	case OP_ADD:
	case OP_SUB:
		m->orders[i] = m->orders[a] | m->orders[b];
		break;
	case OP_MUL:
		m->orders[i] = (unsigned char)orders_of_product(m->orders[a], m->orders[b]);
		break;
	case OP_SIN:
	case OP_COS:
		m->orders[i] = m->p->x->d.nodes[a].op == OP_INPUT && m->orders[a] == PLAIN ? PLAIN : OTHER;
		break;
	default:
		m->orders[i] = OTHER;
	}
	if (m->orders[i] > FIELD || !(m->p->values->size[i] < LARGEST))
		m->orders[i] = OTHER;
}

/* How far off values are that are computed at points of the box. A constant may be replaced where the file's numbers cannot tell
   it from another. */
static void mark_noise(const struct peaks *p, uint32_t i)
{
	const struct node *n = &p->x->d.nodes[i];
	uint32_t a = n->arg[0].i, b = n->arg[1].i;
	double size = p->values->size[i], noise;

	switch (n->op) {
	case OP_CONST:
		noise = within_error(dag_number(&p->x->d, n)) + 0x1p-50 * size;
		break;
	case OP_INPUT:
		noise = (int)n->arg[0].i == p->position ? 0 : 0x1p-50 * size;
		break;
	case OP_SIN:
	case OP_COS:
		noise = 0x1p-52;
		break;
	case OP_NEG:
		noise = p->noise[a];
		break;
	case OP_MUL:
		noise = p->values->size[a] * p->noise[b] + p->values->size[b] * p->noise[a] + p->noise[a] * p->noise[b];
		noise += 0x1p-52 * (size + noise) + DBL_MIN;
		break;
	default:
		noise = p->noise[a] + p->noise[b];
		noise += 0x1p-52 * (size + noise) + DBL_MIN;
	}
	p->noise[i] = noise * (1 + 0x1p-48);
}

static int marks_make(struct marks *m, const struct peaks *p)
{
	size_t count = p->x->d.count;

	*m = (struct marks){p, arena_alloc(p->arena, count, 1), arena_alloc(p->arena, count, 1),
		arena_alloc(p->arena, count, sizeof *m->dims)};
	if (p->arena->failed)
		return 0;
	for (uint32_t i = 0; i < count; i++) {
		mark_node(m, i);
		mark_noise(p, i);
	}
	return 1;
}

static int kind_of(const struct marks *m, const struct peak *k)
{
	unsigned orders = m->orders[k->nodes[0]] | m->orders[k->nodes[1]];

	if (orders == PLAIN)
		return PEAK_PLAIN;
	if (orders == LINEAR && m->is_even[k->nodes[0]] && m->is_even[k->nodes[1]])
		return PEAK_LINEAR;
	return orders <= FIELD && isfinite(m->p->noise[k->nodes[0]] + m->p->noise[k->nodes[1]]) ? PEAK_FULL : PEAK_UNKNOWN;
}

/* ---- groups ---- */

static struct peaks_group *group_of(struct peaks_group *groups, size_t *count, const struct peak *k)
{
	for (size_t i = 0; i < *count; i++)
		if (groups[i].kind == k->kind && groups[i].dims == k->dims)
			return &groups[i];
	groups[*count] = (struct peaks_group){.kind = k->kind, .dims = k->dims};
	return &groups[(*count)++];
}

/* Those whose second derivatives are known. */
static int is_bounded(const struct peaks *p, const struct peak *k)
{
	if (k->kind == PEAK_UNKNOWN || !(k->weight > 0))
		return 0;
	for (int i = 0; i < p->dim_count; i++)
		if (!isfinite(k->bends[i]))
			return 0;
	return 1;
}

static struct peaks_group *groups_make(const struct peaks *p, size_t *count)
{
	struct peaks_group *groups = arena_alloc(p->arena, p->count + 1, sizeof *groups), *g;

	*count = 0;
	for (size_t i = 0; i < p->count && groups; i++)
		if (is_bounded(p, &p->list[i])) {
			g = group_of(groups, count, &p->list[i]);
			g->count++;
			g->weight += p->list[i].weight;
		}
	for (size_t i = 0; i < *count; i++) {
		groups[i].members = arena_alloc(p->arena, groups[i].count, sizeof *groups[i].members);
		groups[i].count = 0;
	}
	for (size_t i = 0; i < p->count && groups && !p->arena->failed; i++)
		if (is_bounded(p, &p->list[i])) {
			g = group_of(groups, count, &p->list[i]);
			g->members[g->count++] = i;
		}
	return p->arena->failed ? NULL : groups;
}

/* More rows of q take more points. */
static double share_of(const struct peaks_group *g)
{
	double n = __builtin_popcountll(g->dims);

	return g->weight * n * n;
}

static int sample_all(struct peaks *p)
{
	size_t count;
	struct peaks_group *groups = groups_make(p, &count);
	double sum = 0;
	int done = groups != NULL;

	for (size_t i = 0; i < count; i++)
		sum += share_of(&groups[i]);
	for (size_t i = 0; i < count && done && seconds_now() < p->deadline; i++) {
		double share = share_of(&groups[i]), now = seconds_now();

		done = peaks_sample(p, &groups[i], now + (p->deadline - now) * (sum > 0 ? fmin(1, share / sum) : 1));
		sum -= share;
#ifdef PEAKS_TELL
		{ double r = 0, w = 0; for (size_t q = 0; q < groups[i].count; q++) { struct peak *k = &p->list[groups[i].members[q]]; double was = k->pair ? norms_of_pair(p->norms, p->values, k->pair) : p->values->size[k->nodes[0]]; r += k->weight * k->most / was; w += k->weight; }
		fprintf(stderr, "kind %d dims %llx members %zu weight %g ratio %.3f time %.3f\n", groups[i].kind, (unsigned long long)groups[i].dims, groups[i].count, groups[i].weight, r / w, seconds_now() - now); }
#endif
	}
	return done;
}

static int make(struct peaks *p)
{
	struct marks m;

	p->noise = arena_alloc(p->arena, p->x->d.count, sizeof *p->noise);
	if (!p->noise || !marks_make(&m, p))
		return 0;
	for (size_t i = 0; i < p->count; i++) {
		struct peak *k = &p->list[i];

		k->nodes[1] = k->pair ? k->nodes[1] : k->nodes[0];
		k->kind = kind_of(&m, k);
		k->dims = m.dims[k->nodes[0]] | m.dims[k->nodes[1]];
		if (!(k->bends = arena_alloc(p->arena, (size_t)p->dim_count + 1, sizeof *k->bends)))
			return 0;
	}
	return 1;
}

int peaks_find(struct peaks *p)
{
	double now = seconds_now();

#ifdef PEAKS_TELL
	int ok = make(p) && peaks_bends(p, now + SHARE_BENDS * (p->deadline - now));
	fprintf(stderr, "bends %g s, %zu peaks\n", seconds_now() - now, p->count);
	return ok && sample_all(p);
#endif
	return make(p) && peaks_bends(p, now + SHARE_BENDS * (p->deadline - now)) && sample_all(p);
}
