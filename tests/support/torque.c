#include "support/torque.h"
#include "support/merged.h"
#include "support/random_robot.h"
#include <check.h>
#include <stdlib.h>

void pose_random(struct pose *p, const struct reference *r, struct rng *rng)
{
	double q[ROWS], qd[ROWS], qdd[ROWS];

	ck_assert(r->nq <= ROWS);
	reference_sample(r, rng, false, q, qd, qdd);
	p->nq = r->nq;
	p->nv = r->nv;
	for (int i = 0; i < r->nq; i++)
		p->q[i] = q[i];
	for (int i = 0; i < r->nv; i++) {
		p->qd[i] = qd[i];
		p->qdd[i] = qdd[i];
	}
}

void torque_of(const struct dag *d, const struct pose *p, struct torque *t)
{
	const real *in[] = {p->q, p->qd, p->qdd, NULL};
	double size[ROWS];

	ck_assert(d->output_count <= ROWS);
	ck_assert(eval_real(d, in, (real *[]){NULL, NULL, NULL, t->tau}, &(struct eval_terms){.size = size}));
	for (size_t i = 0; i < d->output_count; i++)
		t->size[d->outputs[i].row] = size[i];
}

char *torque_robot(uint64_t seed, int links, int flags)
{
	struct random_robot_knobs knobs = random_robot_knobs(seed, links);

	if (flags & NO_FLOATING)
		knobs.floating = 0;
	if (flags & NO_ODD_NAMES)
		knobs.odd_names = 0;
	if (flags & ALWAYS_MIMIC)
		knobs.mimic = 0.4;
	return random_robot(seed, &knobs);
}

int torque_dag(struct dag *d, struct tree *t, const struct robot *r, const struct rneagen_options *o, struct arena *a)
{
	struct rneagen_error e = {0};
	struct request k;
	struct dag raw;

	if (merged_tree(t, &k, r, o, a, &e))
		return 0;
	dag_init(&raw, a);
	algorithm_rnea.build(&raw, t, &k);
	dag_init(d, a);
	dag_fuse(d, &raw, 0);
	ck_assert(!d->failed);
	return 1;
}
