/* The limbs of a base that moves freely meet in the base alone: a vjp takes of each what a hand hands on, sums of a few
   numbers. So the limbs are on two sides, of which one is a hand, and what is left is shorter than the instruction cache, and
   holds less. */
#include "plan/grid/hands/base_sides.h"
#include "plan/grid/base_first.h"
#include "plan/grid/hands/finder.h"
#include "plan/readings.h"
#include <limits.h>
#include <stdlib.h>
#include <string.h>

/* Operations of both sides. H200, ps for each of a million samples, and us of 16384, as one part or whole and in two sides:
   f64, tau and vjp: simple_humanoid, 5479, 925 and 816 (20, 21), anymal_kinova, 5541, 605 and 950 (15, 27), atlas, 7641, 5150
   and 1240 (106, 56), g1_29dof, 8359, 3160 and 1010 (69, 44), romeo, 8562, 3120 and 1160 (68, 47), jvrc1, 10048, 5190 and
   3220 (84, 90); f32: atlas 802 and 578 (18, 20), g1_29dof 507 and 471 (17, 16), jvrc1 1890 and 681 (32, 25). Of the vjp of
   accelerations, the second round in f32: atlas, 7382, 1134 and 1207 (48, 50), g1_29dof, 8129, 1248 and 1244 (51, 48). */
enum { LEAST_DOUBLE = 7000, LEAST_SINGLE = 7500 };

/* What both kernels may take, of what the whole takes. */
static const double MORE = 1.2;

static unsigned operations_of(const struct parts_of *x)
{
	unsigned own = plan_flops(plan_operations_of(x->raw, 0, x->raw->count)), whole = plan_flops(plan_operations(&x->whole->plan));

	return own < whole ? own : whole; /* of a round (found.h), or without what nobody takes */
}

int base_sides_may(const struct parts_of *x)
{
	unsigned least = x->options->precision == RNEAGEN_F32 ? LEAST_SINGLE : LEAST_DOUBLE;

	return x->options->layout == RNEAGEN_SOA && base_is_free(x->tree) && dag_find_role(x->raw, ROLE_VJP, 1) >= 0 &&
		operations_of(x) >= least;
}

/* A row that no kernel writes, that is always zero, that one before has left something in, or that is the base's own. */
void base_sides_bar(struct finder *f)
{
	const struct dag *d = f->x->raw;
	int last = parts_handed(d);

	if (f->x->request->contact_count) /* no row has its own value yet */
		return;
	for (int row = 0; row < finder_rows(d); row++)
		f->rows[row] = 1;
	for (size_t i = 0; i < d->output_count; i++)
		if (d->outputs[i].argument == last && node_is_operation(&d->nodes[d->outputs[i].value.i]))
			f->rows[d->outputs[i].row] = 0;
	for (size_t i = 0; i < d->count; i++)
		if (d->nodes[i].op == OP_INPUT && (int)d->nodes[i].arg[0].i == last)
			f->rows[d->nodes[i].arg[1].i] = 1;
	for (size_t i = 0; i < f->d->output_count && f->is_felt; i++)
		f->rows[f->d->outputs[i].row] = 1;
}

static int is_turn(const struct node *n)
{
	return n->op == OP_SIN || n->op == OP_COS;
}

/* What is made at once of the side's inputs, of sines and cosines of its angles; `meets` of the nodes that angles are made of. */
static void mark_first(struct finder *f)
{
	const struct dag *d = f->d;

	memset(f->meets, 0, d->count);
	for (size_t i = d->count; i-- > 0;)
		for (int k = 0; k < op_arity[d->nodes[i].op]; k++)
			f->meets[d->nodes[i].arg[k].i] |= f->meets[i] || is_turn(&d->nodes[i]);
	for (size_t i = d->count; i-- > 0;) {
		const struct node *n = &d->nodes[i];
		int is_first = 0;

		for (int k = 0; k < op_arity[n->op]; k++) {
			uint32_t of = n->arg[k].i;

			is_first |= f->beyond[of] && (d->nodes[of].op == OP_INPUT || is_turn(&d->nodes[of]) || f->meets[of]);
		}
		f->from[i] = is_first && !is_turn(n) && !f->meets[i];
	}
}

/* What the base feels of a side goes to where that meets what the other limbs make. */
void base_sides_mark(struct finder *f, const unsigned char *own)
{
	const struct dag *d = f->d;

	for (size_t i = 0; i < d->count; i++) {
		int is_input = d->nodes[i].op == OP_INPUT && d->nodes[i].arg[0].i < DAG_ARGUMENTS;
		const struct tree_joint *j = is_input ? readings_joint(d, &d->nodes[i], f->x->tree) : NULL;

		f->beyond[i] = f->from[i];
		f->kind[i] = j && j->body > 0 && !own[j->iv];
		for (int k = 0; k < op_arity[d->nodes[i].op]; k++) {
			f->beyond[i] |= f->beyond[d->nodes[i].arg[k].i];
			f->kind[i] |= f->kind[d->nodes[i].arg[k].i];
		}
		f->to[i] = f->beyond[i] && f->kind[i];
	}
	mark_first(f);
}

/* The limb with which the second side begins, by rows of qd; the body count where there is one limb. */
static int middle(const struct tree *t)
{
	int best = t->body_count, least = t->nv;

	for (int k = tree_end(t, 1); k < t->body_count; k = tree_end(t, k)) {
		int difference = abs(t->nv + 6 - 2 * t->bodies[k].iv); /* rows of it and before, without the base's, and from it on */

		if (difference < least) {
			least = difference;
			best = k;
		}
	}
	return best;
}

/* Operations that the nodes marked in f->to take, up to those marked in f->beyond. */
static unsigned count_taken(struct finder *f)
{
	const struct dag *d = f->d;
	unsigned count = 0;

	for (size_t i = d->count; i-- > 0;) {
		if (!f->to[i] || f->beyond[i])
			continue;
		count += op_arity[d->nodes[i].op] > 0;
		for (int k = 0; k < op_arity[d->nodes[i].op]; k++)
			f->to[d->nodes[i].arg[k].i] = 1;
	}
	return count;
}

/* Of the outputs of the hand, and what it hands on, or of all others, which take that from there. */
static unsigned cone(struct finder *f, const struct hand *m, const unsigned char *own, int is_hands)
{
	const struct dag *d = f->d;

	memset(f->to, 0, d->count);
	memset(f->beyond, 0, d->count);
	for (int i = 0; i < m->cut.count; i++)
		(is_hands ? f->to : f->beyond)[m->cut.nodes[i]] = 1;
	for (size_t i = 0; i < d->output_count; i++)
		f->to[d->outputs[i].value.i] |= finder_owns(f, own, i) == is_hands;
	return count_taken(f);
}

static unsigned whole(struct finder *f)
{
	const struct dag *d = f->d;

	memset(f->to, 0, d->count);
	memset(f->beyond, 0, d->count);
	for (size_t i = 0; i < d->output_count; i++)
		f->to[d->outputs[i].value.i] = 1;
	return count_taken(f);
}

/* What both kernels take with this side for the hand; UINT_MAX where it is none. Returns 0 when memory runs out. */
static int look(unsigned *operations, struct finder *f, int first, int end, unsigned char *own)
{
	struct hand m;

	if (!finder_look(&m, f, 0, first, end, own))
		return 0;
	*operations = m.cut.count ? cone(f, &m, own, 1) + cone(f, &m, own, 0) : UINT_MAX;
	return 1;
}

/* Where the base's sums begin with one side, the other's kernel would make that too: then both take much more than the whole. */
int base_sides_find(struct finder *f, unsigned char *own)
{
	const struct tree *t = f->x->tree;
	int second = middle(t), end = t->body_count;
	unsigned before, beyond;

	if (second == end)
		return 1;
	if (!look(&before, f, 1, second, own) || !look(&beyond, f, second, end, own))
		return 0;
	if ((before < beyond ? before : beyond) > MORE * whole(f))
		return 1;
	return before < beyond ? finder_try(f, 0, 1, second, own) : finder_try(f, 0, second, end, own);
}

/* Rows of the base first, which are written last, and then of joints before the side's own. */
int base_sides_rows(struct finder *f, struct hand *m, const unsigned char *own)
{
	int nv = f->x->tree->nv, count = 0, rows = finder_rows(f->d);

	for (int i = 0; i < nv && (f->is_felt || !own[i]); i++)
		for (int row = i; row < rows && count < m->cut.count; row += nv)
			if (!f->rows[row])
				m->rows[count++] = row;
	return count > 0 && count == m->cut.count;
}
