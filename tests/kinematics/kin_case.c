#define _POSIX_C_SOURCE 200809L
#include "kinematics/kin_case.h"
#include <check.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static int input_named(const struct kin_case *c, const char *name)
{
	static const char *const names[] = {"q", "qd", "qdd", "tau", "jvp_v", "vjp_v"};

	for (int k = 0; k < KIN_INPUTS - 1; k++)
		if (!strcmp(names[k], name))
			return k;
	ck_assert_msg(c->more && !strcmp(c->more, name), "%s: input '%s'", c->what, name);
	return KIN_INPUTS - 1;
}

/* ---- opening ---- */

static struct reference *open_reference(struct kin_case *c, const char *urdf, const struct rneagen_options *o)
{
	struct reference_options ro = {.floating = o->base == RNEAGEN_FLOATING,
		.independent = o->mimic == RNEAGEN_MIMIC_INDEPENDENT, .gravity = o->gravity};
	char message[512];
	struct reference *r = reference_open(urdf, strlen(urdf), &ro, message, sizeof message);

	ck_assert_msg(r != NULL, "%s: reference: %s", c->what, message);
	ck_assert_int_le(r->nq, KIN_ROWS);
	return r;
}

static int is_a_reason(enum rneagen_code code, const char *message)
{
	return code == RNEAGEN_NO_JOINTS || strstr(message, "has a mass") || strstr(message, "M is singular") ||
	       strstr(message, "articulated bodies do not serve") || strstr(message, "cannot stand");
}

int kin_open(struct kin_case *c, const char *urdf, const char *part, const struct rneagen_options *options, uint64_t seed)
{
	struct analysis *a = &c->analysis;
	enum rneagen_code code;

	arena_init(&c->arena, NULL);
	c->rng = rng_seed(seed);
	*a = (struct analysis){.options = *options, .arena = &c->arena, .error = &c->error};
	a->options.file = "<input>";
	code = robot_read(&a->robot, urdf, strlen(urdf), "here", &c->arena, &c->error);
	if (!code)
		code = analysis_run(a, PASS_SCENE_PARSE, PASS_DAG_FUSE);
	ck_assert_msg(!code || is_a_reason(code, c->error.message), "%s: %s", c->what, c->error.message);
	if (code) {
		arena_free(&c->arena);
		return 0;
	}
	c->reference = open_reference(c, part ? part : urdf, options);
	for (int i = 0; i < a->dag.argument_count; i++) {
		c->out[i] = calloc((size_t)a->dag.arguments[i].rows + 1, sizeof **c->out);
		c->size[i] = calloc((size_t)a->dag.arguments[i].rows + 1, sizeof **c->size);
	}
	return 1;
}

void kin_close(struct kin_case *c)
{
	for (int i = 0; i < c->analysis.dag.argument_count; i++) {
		free(c->out[i]);
		free(c->size[i]);
	}
	reference_close(c->reference);
	arena_free(&c->arena);
}

const struct reference_joint *kin_joint(const struct kin_case *c, const char *joint)
{
	for (int j = 0; j < c->reference->nj; j++)
		if (!strcmp(c->reference->joints[j].name, joint))
			return &c->reference->joints[j];
	ck_abort_msg("%s: no joint '%s' in the reference", c->what, joint);
	return NULL;
}

void kin_hold(struct kin_case *c, const char *joint, double q)
{
	const struct reference_joint *j = kin_joint(c, joint);

	ck_assert_int_eq(j->nv, 1);
	c->held[j->iv] = 1;
	c->held_q[j->iq] = q;
}

/* ---- a state ---- */

static void make_units(const struct kin_case *c, wide *q)
{
	for (int i = 0; i < c->reference->nj; i++) {
		wide *u = q + c->reference->joints[i].iq + 3, size = 0;

		for (int k = 0; k < 4 && c->reference->joints[i].nq == 7; k++)
			size += u[k] * u[k];
		for (int k = 0; k < 4 && c->reference->joints[i].nq == 7; k++)
			u[k] /= wide_sqrt(size);
	}
}

void kin_draw(struct kin_case *c)
{
	double q[KIN_ROWS], qd[KIN_ROWS], qdd[KIN_ROWS];

	reference_sample(c->reference, &c->rng, false, q, qd, qdd);
	for (int i = 0; i < c->reference->nq; i++)
		c->q[i] = q[i];
	for (int i = 0; i < c->reference->nv; i++) {
		c->qd[i] = qd[i];
		c->qdd[i] = qdd[i];
	}
	make_units(c, c->q);
	for (int k = 3; k < KIN_INPUTS; k++)
		for (int i = 0; i < (k == 3 ? c->analysis.tree.nv : KIN_ROWS); i++)
			c->in[k][i] = rng_uniform(&c->rng, -5, 5);
	kin_settle(c);
}

void kin_settle(struct kin_case *c)
{
	const struct tree *t = &c->analysis.tree;

	for (int j = 0; j < c->reference->nj; j++) {
		const struct reference_joint *x = &c->reference->joints[j];

		if (x->nv && c->held[x->iv]) {
			c->q[x->iq] = c->held_q[x->iq];
			c->qd[x->iv] = c->qdd[x->iv] = 0;
		}
	}
	for (int i = 0; i < t->joint_count; i++) {
		const struct tree_joint *k = &t->joints[i];
		const struct reference_joint *from = kin_joint(c, k->name);

		ck_assert_int_eq(k->nq, from->nq);
		memcpy(c->in[0] + k->iq, c->q + from->iq, (size_t)k->nq * sizeof(wide));
		memcpy(c->in[1] + k->iv, c->qd + from->iv, (size_t)k->nv * sizeof(wide));
		memcpy(c->in[2] + k->iv, c->qdd + from->iv, (size_t)k->nv * sizeof(wide));
	}
}

/* A qdd that was found is that of the whole. */
static void take_qdd(struct kin_case *c, const wide *qdd)
{
	const struct tree *t = &c->analysis.tree;

	for (int i = 0; i < t->joint_count; i++)
		memcpy(c->qdd + kin_joint(c, t->joints[i].name)->iv, qdd + t->joints[i].iv,
			(size_t)t->joints[i].nv * sizeof(wide));
}

void kin_evaluate(struct kin_case *c)
{
	const struct dag *d = &c->analysis.dag;
	const wide *in[DAG_ARGUMENTS] = {NULL};
	wide *out[DAG_ARGUMENTS] = {NULL};
	double *size = calloc(d->output_count + 1, sizeof *size);

	for (int a = 0; a < d->argument_count; a++) {
		out[a] = d->arguments[a].is_output ? c->out[a] : NULL;
		in[a] = out[a] ? NULL : c->in[input_named(c, d->arguments[a].name)];
	}
	ck_assert(eval_quad(d, in, out, &(struct eval_terms){.size = size}));
	for (size_t i = 0; i < d->output_count; i++)
		c->size[d->outputs[i].argument][d->outputs[i].row] = size[i];
	for (int a = 0; a < d->argument_count; a++)
		if (out[a] && !strcmp(d->arguments[a].name, "qdd"))
			take_qdd(c, out[a]);
	free(size);
}

void kin_round(struct kin_case *c, int is_f32)
{
	wide *all[] = {c->q, c->qd, c->qdd, c->in[3]};

	for (int a = 0; a < 4; a++)
		for (int i = 0; i < KIN_ROWS; i++)
			all[a][i] = is_f32 ? (wide)(float)all[a][i] : (wide)(double)all[a][i];
	kin_settle(c);
}

static void *numbers(int rows, int is_f32)
{
	return calloc((size_t)rows + 1, is_f32 ? sizeof(float) : sizeof(double));
}

void kin_evaluate_rounded(struct kin_case *c, int is_f32)
{
	const struct dag *d = &c->analysis.dag;
	void *in[DAG_ARGUMENTS] = {NULL}, *out[DAG_ARGUMENTS] = {NULL};

	for (int a = 0; a < d->argument_count; a++) {
		const int rows = d->arguments[a].rows;
		int k;

		if (d->arguments[a].is_output) {
			out[a] = numbers(rows, is_f32);
			continue;
		}
		k = input_named(c, d->arguments[a].name);
		in[a] = numbers(rows, is_f32);
		for (int i = 0; i < rows && is_f32; i++)
			((float *)in[a])[i] = (float)c->in[k][i];
		for (int i = 0; i < rows && !is_f32; i++)
			((double *)in[a])[i] = (double)c->in[k][i];
	}
	ck_assert(is_f32 ? eval_f32(d, (const float *const *)in, (float *const *)out, NULL) :
			   eval_f64(d, (const double *const *)in, (double *const *)out, NULL));
	for (int a = 0; a < d->argument_count; a++) {
		for (int i = 0; i < d->arguments[a].rows && out[a]; i++)
			c->out[a][i] = is_f32 ? (wide)((float *)out[a])[i] : (wide)((double *)out[a])[i];
		free(in[a]);
		free(out[a]);
	}
}

/* ---- matrices ---- */

struct kin_matrix kin_matrix_new(int lines, int cols)
{
	size_t count = (size_t)lines * (size_t)cols + 1;

	return (struct kin_matrix){lines, cols, calloc(count, sizeof(wide)), calloc(count, sizeof(double))};
}

void kin_matrix_free(struct kin_matrix *m)
{
	free(m->x);
	free(m->size);
}

/* The argument of the DAG that a want is stored in. */
static int argument_of(const struct kin_case *c, const struct want *w)
{
	const struct dag *d = &c->analysis.dag;

	for (int a = 0; a < d->argument_count; a++)
		if (d->arguments[a].is_output && !strcmp(d->arguments[a].name, w->argument))
			return a;
	ck_abort_msg("%s: no output '%s'", c->what, w->argument);
	return -1;
}

struct kin_matrix kin_found(struct kin_case *c, const struct want *w, wide *const *out)
{
	const struct request *k = &c->analysis.request;
	int a = argument_of(c, w), rows = c->analysis.dag.arguments[a].rows;
	struct kin_matrix m;
	struct pattern p;

	if (!request_is_matrix(k, w)) {
		m = kin_matrix_new(rows, 1);
		memcpy(m.x, out[a], (size_t)rows * sizeof *m.x);
		memcpy(m.size, c->size[a], (size_t)rows * sizeof *m.size);
		return m;
	}
	ck_assert(request_pattern(&p, &c->analysis.tree, w, k->dense, &c->arena));
	ck_assert_int_eq(p.rows, rows);
	m = kin_matrix_new(p.lines, p.cols);
	for (int i = 0; i < p.lines * p.cols; i++) {
		int at = p.row[i];

		if (at < 0 && want_is(w->kind, IS_SYMMETRIC))
			at = p.row[i % p.cols * p.cols + i / p.cols];
		m.x[i] = at < 0 ? 0 : out[a][at];
		m.size[i] = at < 0 ? 0 : c->size[a][at];
	}
	return m;
}

/* ---- comparing ---- */

/* What differences in quad precision may be off where the rate is zero. */
static const wide DIFFERENCES = WIDE_C(1e-20);

void kin_expect(struct kin_case *c, const char *what, int i, int j, wide found, wide want, wide limit)
{
	const wide off = wide_abs(found - want);

	ck_assert_msg(off <= limit, "%s: %s, element %d,%d is %.17g, not %.17g; off by %.3g of %.3g; scene:\n%s", c->what, what, i, j,
		(double)found, (double)want, (double)off, (double)limit, c->analysis.options.scene ? c->analysis.options.scene : "");
	if (limit > 0 && (double)(off / limit) > c->worst)
		c->worst = (double)(off / limit);
}

/* The quaternion of the other sign is the same rotation. */
static void turn_sign(struct kin_matrix *m, const struct kin_matrix *to)
{
	wide along = 0;

	for (int i = 3; i < 7; i++)
		along += m->x[i] * to->x[i];
	for (int i = 3; i < 7 && along < 0; i++)
		m->x[i] = -m->x[i];
}

static void compare_want(struct kin_case *c, const struct want *w, wide *const *out, double noise)
{
	struct kin_matrix found = kin_found(c, w, out), want = kin_expected(c, w);
	wide largest = 0;

	if (w->kind == WANT_POSE && want.lines == 7)
		turn_sign(&want, &found);
	ck_assert_msg(found.lines == want.lines && found.cols == want.cols, "%s: %s is %d x %d, not %d x %d", c->what,
		w->word, found.lines, found.cols, want.lines, want.cols);
	for (int i = 0; i < want.lines * want.cols; i++)
		largest = wide_abs(want.x[i]) > largest ? wide_abs(want.x[i]) : largest;
	for (int i = 0; i < want.lines * want.cols; i++) {
		const wide limit = noise * ((c->is_by_largest ? 0 : (wide)found.size[i]) + largest) + DIFFERENCES;

		kin_expect(c, w->word, i / want.cols, i % want.cols, found.x[i], want.x[i], limit);
	}
	kin_matrix_free(&found);
	kin_matrix_free(&want);
}

int kin_compare(struct kin_case *c, double noise)
{
	const struct request *k = &c->analysis.request;
	int count = 0;

	for (int i = 0; i < k->want_count; i++) {
		struct kin_matrix want = kin_expected(c, &k->wants[i]);
		const int is_known = want.lines > 0;

		kin_matrix_free(&want);
		if (is_known)
			compare_want(c, &k->wants[i], c->out, noise);
		count += is_known ? 1 : kin_check(c, &k->wants[i], c->out, noise);
	}
	return count;
}
