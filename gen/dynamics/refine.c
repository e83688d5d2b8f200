/* A step of iterative refinement (Wilkinson; Higham, Accuracy and Stability of Numerical Algorithms, 2nd ed., chapter 12): what
   the qdd found leaves of tau is solved for once more, by the factors that are there. With a residual in more bits the error of
   qdd falls to about one rounding, as long as the factors give a digit at all. */
#include "dynamics/want.h"
#include "dynamics/forward.h"

/* tau - ID(q, qd, qdd) in place of qdd, and less the accelerations of contacts in place of their forces, rounded to the text's
   numbers. */
static void residual(struct forward *x, struct build *b, struct joint_inputs in, struct ref *qdd)
{
	struct dag *d = b->d;
	int nv = b->t->nv, found = contacts_found(b);
	struct tour r;

	for (int i = 0; i < found && d->is_wide; i++)
		qdd[i] = dag_widen(d, qdd[i]);
	b->forces = qdd + nv;
	in.offset = b->offset;
	in.qdd = (struct source){.argument = -1, .found = qdd};
	r = want_tour(b, in);
	r.comes_back = 1;
	r.world = want_world;
	r.entered = want_bear;
	r.own_terms = own_terms;
	tour_run(&r);
	for (int i = 0; i < found && !d->failed; i++)
		qdd[i] = dag_narrow(d, i < nv ? dag_sub(d, source_row(d, &x->torques, i), r.tau[i])
					      : dag_neg(d, b->accelerated[i - nv]));
}

void refine_step(struct forward *x, struct joint_inputs in)
{
	struct dag *d = x->b->d;
	int found = contacts_found(x->b);
	struct build wide = *x->b;
	struct ref *more = arena_alloc(d->arena, (size_t)found, sizeof *more);

	dag_section(d, SECTION_RESIDUAL, 0);
	d->is_wide = x->b->k->refine != REFINE_SAME;
	if (!more || !want_constants(&wide)) { /* inputs are read anew, in the numbers of the residual */
		d->failed = 1;
		return;
	}
	for (int i = 0; i < found; i++)
		more[i] = x->qdd[i];
	residual(x, &wide, in, more);
	d->is_wide = 0;
	dag_section(d, SECTION_REFINED, 0);
	forward_solve(x, more);
	for (int i = 0; i < found && !d->failed; i++)
		x->qdd[i] = dag_add(d, x->qdd[i], more[i]);
}
