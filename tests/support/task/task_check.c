/* What the reference makes of a task, and the comparison. */
#include "support/task/task.h"
#include <check.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* ---- by the reference ---- */

/* The scene's additions to the torques: forces from outside, terms of the joints' own. */
static void add_or_leave(struct task_case *c, int added)
{
	static const struct reference_own free_of_terms = {0};
	static const wide none[6] = {0};

	for (int i = 0; i < c->r->nj; i++) {
		reference_set_push(c->r, i, added ? c->push[i] : none, c->in_world);
		reference_set_own(c->r, i, added ? &c->own[i] : &free_of_terms);
	}
}

struct wide_state {
	double q[ROWS];
	wide all[3][ROWS];
};

static void widen(const struct task_case *c, struct wide_state *s)
{
	for (int i = 0; i < c->r->nq; i++) {
		s->all[0][i] = (wide)c->q[i] + (wide)c->offset[i];
		s->q[i] = (double)s->all[0][i];
	}
	for (int i = 0; i < c->r->nv; i++) {
		s->all[1][i] = (wide)c->qd[i];
		s->all[2][i] = (wide)c->qdd[i];
	}
}

/* Leaves the reference's entries as they are at this state; with `magnitudes` those. */
static void run(struct task_case *c, const double *qd, const double *qdd, wide *tau, int magnitudes)
{
	struct wide_state s;
	wide zero[ROWS] = {0};

	widen(c, &s);
	if (magnitudes)
		reference_magnitude(c->r, s.q, qd, qdd, tau);
	else
		reference_rnea_wide(c->r, s.all[0], qd == c->qd ? s.all[1] : zero, qdd == c->qdd ? s.all[2] : zero, tau);
}

/* -g.(m p + R h) of all that moves, and what is summed for it along the way to each link. */
static void expect_potential(struct task_case *c, wide *value, wide *size)
{
	struct link_pose *poses = calloc((size_t)c->r->nj, sizeof *poses);
	wide reach[ROWS] = {0}, *g = c->r->gravity, far = wide_abs(g[0]) + wide_abs(g[1]) + wide_abs(g[2]);
	struct wide_state s;

	widen(c, &s);
	oracle_poses(&c->oracle, s.all[0], poses);
	for (int i = 0; i < c->r->nj; i++) {
		const struct link_pose *x = &poses[i], *up = i ? &poses[c->r->joints[i].parent] : NULL;
		wide p[10];

		reference_inertia(c->r, i, p);
		reach[i] = up ? reach[c->r->joints[i].parent] : 0;
		for (int k = 0; k < 3; k++)
			reach[i] += wide_abs(x->m[k][3] - (up ? up->m[k][3] : 0));
		for (int k = 0; k < 3 && case_moves(c, i); k++) {
			*value -= g[k] * (p[0] * x->m[k][3] + x->m[k][0] * p[1] + x->m[k][1] * p[2] + x->m[k][2] * p[3]);
			*size += far * (wide_abs(p[0]) * reach[i] + wide_abs(p[1]) + wide_abs(p[2]) + wide_abs(p[3]));
		}
	}
	free(poses);
}

static void expect_motion(struct task_case *c, const struct task_out *out, wide *to, int magnitudes)
{
	wide tau[ROWS], g[3] = {c->r->gravity[0], c->r->gravity[1], c->r->gravity[2]};

	for (int i = 0; i < 3; i++)
		c->r->gravity[i] = 0;
	run(c, c->qd, c->qdd, tau, magnitudes);
	for (int i = 0; i < 3; i++)
		c->r->gravity[i] = g[i];
	if (out->kind == TASK_KINETIC)
		*to = reference_kinetic(c->r, magnitudes);
	else
		reference_link(c->r, out->entry, out->kind == TASK_TWIST ? to : NULL, out->kind == TASK_ACCEL ? to : NULL, NULL);
}

static void expect_forces(struct task_case *c, const struct task_out *out, wide *to, int magnitudes)
{
	static const double zero[ROWS];
	wide tau[ROWS];

	add_or_leave(c, out->kind != TASK_GRAVITY && out->kind != TASK_BIAS);
	run(c, out->kind == TASK_GRAVITY ? zero : c->qd,
		out->kind == TASK_GRAVITY || out->kind == TASK_BIAS ? zero : c->qdd, tau, magnitudes);
	if (out->kind == TASK_WRENCH)
		reference_link(c->r, out->entry, NULL, NULL, to);
	else if (out->kind == TASK_POWER)
		for (int i = 0; i < c->r->nv; i++)
			*to += magnitudes ? tau[i] * wide_abs((wide)c->qd[i]) : tau[i] * (wide)c->qd[i];
	else
		memcpy(to, tau, (size_t)c->r->nv * sizeof *to);
}

/* A body's axes may be turned against its link's: the rounding of one component is in all three. */
static void share_size(struct task_expected *x)
{
	for (int part = 0; part < x->rows; part += 3) {
		wide sum = x->size[part] + x->size[part + 1] + x->size[part + 2];

		for (int i = part; i < part + 3; i++)
			x->size[i] = sum;
	}
}

void case_expect(struct task_case *c, const struct task_out *out, struct task_expected *x)
{
	static const int rows[TASK_KINDS] = {0, 0, 0, 6, 6, 6, 1, 1, 1};

	*x = (struct task_expected){.rows = rows[out->kind]};
	if (out->kind == TASK_POTENTIAL) {
		expect_potential(c, x->value, x->size);
		return;
	}
	for (int magnitudes = 0; magnitudes < 2; magnitudes++) {
		wide *to = magnitudes ? x->size : x->value;

		if (out->kind == TASK_TWIST || out->kind == TASK_ACCEL || out->kind == TASK_KINETIC)
			expect_motion(c, out, to, magnitudes);
		else
			expect_forces(c, out, to, magnitudes);
	}
	if (x->rows == 6)
		share_size(x);
}

/* ---- arguments ---- */

/* Rows of q (`which` 0), qd or qdd that the text has are those of joints that are not held. */
static void feed_rows(const struct task_case *c, const struct tree *t, int which, double *to)
{
	const double *const from[] = {c->q, c->qd, c->qdd};
	const char *const given[] = {c->q_given, c->qd_given, c->qdd_given};

	for (int i = 0; i < t->joint_count; i++) {
		const struct tree_joint *k = &t->joints[i];
		const struct reference_joint *x = &c->r->joints[entry_named(c->r, k->name)];
		int first = which ? x->iv : x->iq, at = which ? k->iv : k->iq;

		ck_assert_int_eq(k->nq, x->nq);
		for (int r = 0; r < (which ? x->nv : x->nq); r++)
			to[at + r] = given[which][first + r] ? (double)NAN : from[which][first + r];
	}
}

void case_feed_in(const struct task_case *c, const struct task_in *in, const struct tree *t, double *to)
{
	memcpy(to, in->value, sizeof in->value);
	for (int i = 0; i < t->joint_count && in->is_of_all; i++)
		for (int r = 0; r < t->joints[i].nv; r++)
			to[t->joints[i].iv + r] = in->value[c->r->joints[entry_named(c->r, t->joints[i].name)].iv + r];
}

void case_feed(const struct task_case *c, const struct scene_model *m, struct task_arrays *x)
{
	static const char *const names[] = {"q", "qd", "qdd"};
	const struct dag *d = &m->dag;
	int k = 0;

	memset(x, 0, sizeof *x);
	for (int which = 0; which < 3; which++)
		if (k < d->argument_count && !strcmp(d->arguments[k].name, names[which]))
			feed_rows(c, &m->tree, which, x->in[k++]);
	ck_assert_int_eq(d->argument_count, k + c->in_count + (c->out_count ? c->out_count : 1));
	for (int pushes = 0; pushes < 2; pushes++)
		for (int i = 0; i < c->in_count; i++)
			if (c->in[i].is_push == pushes) {
				ck_assert_msg(d->arguments[k].rows == c->in[i].rows &&
					d->arguments[k].per_batch == c->in[i].per_batch,
					"%s: %s has %d rows, per batch %d", c->in[i].word, d->arguments[k].name,
					d->arguments[k].rows, d->arguments[k].per_batch);
				case_feed_in(c, &c->in[i], &m->tree, x->in[k++]);
			}
}

/* ---- evaluated ---- */

#define EVALUATE(name, type)                                                                                           \
	static void evaluate_##name(const struct dag *d, struct task_arrays *x)                                        \
	{                                                                                                              \
		static type in[DAG_ARGUMENTS][ROWS], out[DAG_ARGUMENTS][ROWS];                                         \
		const type *ins[DAG_ARGUMENTS];                                                                        \
		type *outs[DAG_ARGUMENTS];                                                                             \
                                                                                                                       \
		for (int k = 0; k < d->argument_count; k++) {                                                          \
			int is_output = d->arguments[k].is_output;                                                     \
                                                                                                                       \
			for (int i = 0; i < d->arguments[k].rows; i++) {                                               \
				in[k][i] = (type)x->in[k][i];                                                          \
				out[k][i] = (type)NAN;                                                                 \
			}                                                                                              \
			ins[k] = is_output ? NULL : in[k];                                                             \
			outs[k] = is_output ? out[k] : NULL;                                                           \
		}                                                                                                      \
		ck_assert(eval_##name(d, ins, outs, NULL));                                                            \
		for (int k = 0; k < d->argument_count; k++)                                                            \
			for (int i = 0; i < d->arguments[k].rows; i++)                                                 \
				x->out[k][i] = (real)out[k][i];                                                        \
	}
EVALUATE(real, real)
EVALUATE(f64, double)
EVALUATE(f32, float)

void case_evaluate(const struct dag *d, enum task_precision p, struct task_arrays *x)
{
	(p == TASK_REAL ? evaluate_real : p == TASK_F64 ? evaluate_f64 : evaluate_f32)(d, x);
}

/* ---- compared ---- */

/* Torques of joints that are held are not in the text. */
static void pick_rows(const struct task_case *c, const struct tree *t, const struct task_expected *all, struct task_expected *x)
{
	*x = *all;
	if (all->rows)
		return;
	x->rows = t->nv;
	for (int i = 0; i < t->joint_count; i++)
		for (int k = 0; k < t->joints[i].nv; k++) {
			int from = c->r->joints[entry_named(c->r, t->joints[i].name)].iv + k, to = t->joints[i].iv + k;

			x->value[to] = all->value[from];
			x->size[to] = all->size[from];
		}
}

static void compare(struct task_case *c, const struct dag *d, const struct task_out *out, int argument,
	const struct task_expected *x, struct task_arrays *arrays, const char *what)
{
	static const struct {
		const char *name;
		real eps;
	} precisions[] = {{"real", 1e-14L}, {"f64", 32 * 0x1p-53L}, {"f32", 32 * 0x1p-24L}};

	ck_assert_msg(d->arguments[argument].rows == x->rows, "%s, %s: %d rows of %s, not %d", what, out->word,
		d->arguments[argument].rows, d->arguments[argument].name, x->rows);
	for (int p = 0; p < 3; p++) {
		case_evaluate(d, (enum task_precision)p, arrays);
		for (int i = 0; i < x->rows; i++) {
			real got = arrays->out[argument][i], off = fabsl(got - (real)x->value[i]);

			ck_assert_msg(off <= precisions[p].eps * (real)x->size[i],
				"%s, %s row %d in %s: %.17Lg, not %.17Lg (%.3Lg eps); scene:\n%s", what, out->word, i,
				precisions[p].name, got, (real)x->value[i], off / (precisions[p].eps * (real)x->size[i]),
				c->scene);
		}
	}
}

void case_check(struct task_case *c, struct scene_model *m, const char *what)
{
	static const struct task_out tau = {.word = "tau", .kind = TASK_TAU};
	static struct task_arrays arrays;
	struct task_expected all, x;
	int count = c->out_count ? c->out_count : 1;

	ck_assert_msg(!scene_open(m, c->urdf, &c->options), "%s: %s; scene:\n%s", what, m->error.message, c->scene);
	case_feed(c, m, &arrays);
	for (int i = 0; i < count; i++) {
		const struct task_out *out = c->out_count ? &c->out[i] : &tau;

		case_expect(c, out, &all);
		pick_rows(c, &m->tree, &all, &x);
		compare(c, &m->dag, out, m->dag.argument_count - count + i, &x, &arrays, what);
	}
}

size_t case_checked(struct task_case *c, const char *what)
{
	struct scene_model m;
	size_t n;

	case_check(c, &m, what);
	n = operation_total(&m);
	scene_close(&m);
	return n;
}
