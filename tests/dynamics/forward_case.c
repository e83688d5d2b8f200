#define _POSIX_C_SOURCE 200809L
#include "test_forward.h"
#include "reference/differences.h"
#include "tree/pattern.h"
#include <check.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const char *const NAMES[OUTS] = {"qdd", "Minv", "dqdd_dq", "dqdd_dqd", "jvp", "vjp", "dtau_dq", "dtau_dqd"};

/* ---- the scene ---- */

/* Torques that take the drawn qdd, rounded; some are given. */
static void draw_torques(struct forward_case *f, struct task_expected *x)
{
	struct task_case *c = f->c;
	const struct task_out tau = {.word = "tau", .kind = TASK_TAU};

	case_expect(c, &tau, x);
	for (int j = 0; j < c->r->nj; j++) {
		const struct reference_joint *k = &c->r->joints[j];
		int is_given = case_has_rows(c, j) && rng_chance(&c->rng, 0.2);

		if (is_given)
			case_say(c, "fold tau.%s=", case_joint(c, j));
		for (int i = k->iv; i < k->iv + k->nv; i++) {
			f->tau[i] = (wide)(double)x->value[i];
			if (is_given && rng_chance(&c->rng, 0.5))
				f->tau[i] = 0;
			f->tau_given[i] = (char)is_given;
			if (is_given)
				case_say(c, "%s%.17g", i > k->iv ? "," : "", (double)f->tau[i]);
		}
		if (is_given)
			case_say(c, "\n");
	}
}

static void draw_scene(struct forward_case *f)
{
	struct task_case *c = f->c;

	if (rng_chance(&c->rng, 0.3))
		case_draw_locks(c);
	if (rng_chance(&c->rng, 0.2))
		case_draw_tips(c);
	if (rng_chance(&c->rng, 0.3))
		case_gravity(c);
	if (rng_chance(&c->rng, 0.5))
		case_draw_frees(c, 1);
	if (rng_chance(&c->rng, 0.4))
		case_draw_pushes(c);
	if (rng_chance(&c->rng, 0.5))
		case_draw_own(c);
}

static void ask(struct forward_case *f, const char *text)
{
	struct task_case *c = f->c;

	case_say(c, "%s", text);
	case_say(c, "dense\njvp qdd\nvjp qdd\nwant qdd,Minv,dqdd_dq,dqdd_dqd,dtau_dq,dtau_dqd\n");
	for (int i = 0; i < c->in_count; i++)
		if (!c->in[i].is_push)
			case_say(c, "want dqdd_d%s\n", c->in[i].word);
}

struct forward_case *forward_case_random(uint64_t seed, int links, const char *text, const char *what)
{
	struct forward_case *f = calloc(1, sizeof *f);
	struct task_expected *x = calloc(1, sizeof *x);

	ck_assert(f && x);
	f->what = what;
	f->c = case_random(seed, links, NO_ODD_NAMES);
	if (f->c && f->c->r->nv <= MOST) {
		draw_scene(f);
		draw_torques(f, x);
		ask(f, text);
		for (int i = 0; i < 3 * MOST; i++)
			f->v[i] = rng_uniform(&f->c->rng, -1, 1);
		for (int i = 0; i < MOST; i++)
			f->lambda[i] = rng_uniform(&f->c->rng, -1, 1);
	} else {
		forward_case_close(f);
		f = NULL;
	}
	free(x);
	return f;
}

void forward_case_close(struct forward_case *f)
{
	free(f->X);
	if (f->c)
		case_close(f->c);
	free(f);
}

/* ---- evaluated ---- */

static void feed_state(const struct forward_case *f, const char *name, real *to)
{
	const struct task_case *c = f->c;
	int is_q = !strcmp(name, "q"), is_tau = !strcmp(name, "tau");

	for (int i = 0; i < f->m.tree.joint_count; i++) {
		const struct tree_joint *k = &f->m.tree.joints[i];
		const struct reference_joint *x = &c->r->joints[entry_named(c->r, k->name)];

		for (int r = 0; r < (is_q ? k->nq : k->nv); r++)
			to[is_q ? k->iq + r : k->iv + r] = is_q ? (real)c->q[x->iq + r] : !is_tau ? (real)c->qd[x->iv + r] :
				f->tau_given[x->iv + r] ? (real)NAN : (real)f->tau[x->iv + r];
	}
}

/* Frees, then pushes, as they were said. */
static void feed_others(const struct forward_case *f, int first, real (*in)[ROWS])
{
	double value[ROWS];

	for (int pushes = 0; pushes < 2; pushes++)
		for (int i = 0; i < f->c->in_count; i++)
			if (f->c->in[i].is_push == pushes) {
				case_feed_in(f->c, &f->c->in[i], &f->m.tree, value);
				for (int k = 0; k < f->c->in[i].rows; k++)
					in[first][k] = (real)value[k];
				first++;
			}
}

static real *room_of(struct forward_case *f, const struct argument *a)
{
	for (int i = 0; i < OUTS; i++)
		if (!strcmp(a->name, NAMES[i]))
			return f->out[i];
	for (int i = 0; i < f->c->in_count; i++)
		if (a->role == ROLE_DQDD_DFREED && !strcmp(a->of, f->c->in[i].word))
			return f->freed[i];
	ck_abort_msg("%s: what is '%s'?", f->what, a->name);
	return NULL;
}

static void evaluate(struct forward_case *f)
{
	const struct dag *d = &f->m.dag;
	real (*in)[ROWS] = calloc(DAG_ARGUMENTS, sizeof *in), *out[DAG_ARGUMENTS] = {NULL};
	const real *ins[DAG_ARGUMENTS];
	int has_tau = dag_find_argument(d, "tau") == 2;

	ck_assert(in != NULL);
	ck_assert_str_eq(d->arguments[0].name, "q");
	ck_assert_str_eq(d->arguments[1].name, "qd");
	for (int k = 0; k < 2 + has_tau; k++)
		feed_state(f, d->arguments[k].name, in[k]);
	feed_others(f, 2 + has_tau, in);
	for (int k = 0; k < d->argument_count; k++) {
		for (int i = 0; i < 3 * f->nv && !strcmp(d->arguments[k].name, "jvp_v"); i++)
			in[k][i] = (real)f->v[i];
		for (int i = 0; i < f->nv && !strcmp(d->arguments[k].name, "vjp_v"); i++)
			in[k][i] = (real)f->lambda[i];
		ins[k] = in[k];
		out[k] = d->arguments[k].is_output ? room_of(f, &d->arguments[k]) : NULL;
	}
	ck_assert(eval_real(d, ins, out, NULL));
	free(in);
}

enum rneagen_code forward_case_evaluate(struct forward_case *f)
{
	enum rneagen_code code = scene_open(&f->m, f->c->urdf, &f->c->options);

	if (code)
		return code;
	f->nv = f->m.tree.nv;
	for (int i = 0; i < f->m.tree.joint_count; i++)
		for (int k = 0; k < f->m.tree.joints[i].nv; k++)
			f->from[f->m.tree.joints[i].iv + k] = f->c->r->joints[entry_named(f->c->r, f->m.tree.joints[i].name)].iv +
				k;
	evaluate(f);
	return code;
}

/* ---- the reference's ---- */

static void held_rows(const struct task_case *c, char *held)
{
	for (int j = 0; j < c->r->nj; j++)
		memset(held + c->r->joints[j].iv, c->held[j], (size_t)c->r->joints[j].nv);
}

static void refer_derivatives(struct forward_case *f, const char *held)
{
	struct task_case *c = f->c;
	size_t n = (size_t)c->r->nv * (size_t)c->r->nv;
	wide *work = calloc(n + REFERENCE_WORK(c->r), sizeof *work);
	double q[ROWS], qdd[ROWS];

	ck_assert(work != NULL);
	reference_forward_differences(c->r, held, f->q, f->qd, f->tau, f->D[0], f->D[1]);
	for (int i = 0; i < c->r->nq; i++)
		q[i] = (double)f->q[i];
	for (int i = 0; i < c->r->nv; i++)
		qdd[i] = (double)f->qdd[i];
	reference_differences(c->r, q, c->qd, qdd, f->D[2], f->D[3], work, work + n);
	free(work);
}

void forward_case_refer(struct forward_case *f, int derivatives)
{
	struct task_case *c = f->c;
	size_t n = (size_t)c->r->nv * (size_t)c->r->nv;
	char held[ROWS] = {0};

	f->X = calloc(5 * n, sizeof *f->X);
	ck_assert(f->X != NULL);
	for (int i = 0; i < 4; i++)
		f->D[i] = f->X + (size_t)(i + 1) * n;
	held_rows(c, held);
	for (int i = 0; i < c->r->nq; i++)
		f->q[i] = (wide)c->q[i] + (wide)c->offset[i];
	for (int i = 0; i < c->r->nv; i++)
		f->qd[i] = (wide)c->qd[i];
	f->pivot = reference_inverse(c->r, held, f->q, f->X);
	if (f->pivot <= 0)
		return;
	reference_forward(c->r, f->X, f->q, f->qd, f->tau, f->qdd);
	if (derivatives)
		refer_derivatives(f, held);
}

int forward_case_left_out(struct forward_case *f)
{
	struct pattern p;
	int count = 0;

	ck_assert(pattern_coupled(&p, &f->m.tree, 0, 0, &f->m.arena));
	for (int i = 0; i < f->nv * f->nv; i++) {
		count += p.row[i] < 0;
		ck_assert_msg(p.row[i] >= 0 || (f->out[OUT_DQ][i] == 0 && f->out[OUT_DQD][i] == 0 && f->out[OUT_MINV][i] == 0),
			"%s: element %d is left out, and not zero; scene:\n%s", f->what, i, f->c->scene);
	}
	return count;
}

wide forward_case_at(const struct forward_case *f, const wide *matrix, int i, int j)
{
	return matrix[f->from[i] * f->c->r->nv + f->from[j]];
}
