#include "bench.h"
#include "all.h"
#include "derivatives.h"
#include "mass.h"
#include "torque.h"

const char *const function_names[FUNCTIONS] = {"tau", "M", "tau,dtau_dq,dtau_dqd", "tau,dtau_dq,dtau_dqd,M"};

const double *bench_q(const struct bench *b, int s)
{
	return b->states + (size_t)s * (size_t)(b->nq + 2 * b->nv);
}

const double *bench_qd(const struct bench *b, int s)
{
	return bench_q(b, s) + b->nq;
}

const double *bench_qdd(const struct bench *b, int s)
{
	return bench_qd(b, s) + b->nv;
}

void call_one(const struct bench *b, enum function f, int s)
{
	const double *q = bench_q(b, s), *qd = bench_qd(b, s), *qdd = bench_qdd(b, s);
	const struct arrays *a = &b->one;

	switch (f) {
	case TAU:
		torque_rnea(q, qd, qdd, a->tau);
		break;
	case MASS:
		mass_rnea(q, a->M);
		break;
	case DERIVATIVES:
		derivatives_rnea(q, qd, qdd, a->tau, a->dq, a->dqd);
		break;
	default:
		all_rnea(q, qd, qdd, a->tau, a->dq, a->dqd, a->M);
	}
}

void call_batch(const struct bench *b, enum function f)
{
	const struct arrays *a = &b->batch;

	switch (f) {
	case TAU:
		torque_rnea_batch(a->q, a->qd, a->qdd, a->tau, STATES);
		break;
	case MASS:
		mass_rnea_batch(a->q, a->M, STATES);
		break;
	case DERIVATIVES:
		derivatives_rnea_batch(a->q, a->qd, a->qdd, a->tau, a->dq, a->dqd, STATES);
		break;
	default:
		all_rnea_batch(a->q, a->qd, a->qdd, a->tau, a->dq, a->dqd, a->M, STATES);
	}
}

void call_peer(const struct bench *b, enum function f, int s)
{
	const double *q = bench_q(b, s);

	if (f == TAU)
		peer_rnea(b->peer, q, bench_qd(b, s), bench_qdd(b, s));
	else if (f != MASS)
		peer_derivatives(b->peer, q, bench_qd(b, s), bench_qdd(b, s));
	else if (b->world)
		peer_crba_world(b->peer, q);
	else
		peer_crba_local(b->peer, q);
}
