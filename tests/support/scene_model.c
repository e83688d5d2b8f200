#define _POSIX_C_SOURCE 200809L
#include "support/scene_model.h"
#include "plan/plan.h"
#include "reference/read.h"
#include <check.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum rneagen_code scene_open(struct scene_model *m, const char *urdf, const struct rneagen_options *o)
{
	struct analysis *a = &m->analysis;

	*m = (struct scene_model){0};
	arena_init(&m->arena, NULL);
	*a = (struct analysis){.options = *o, .arena = &m->arena, .error = &m->error};
	a->options.file = o->file ? o->file : "<input>";
	a->options.strict = 0;
	if (robot_read(&a->robot, urdf, strlen(urdf), "here", &m->arena, &m->error) ||
		analysis_run(a, PASS_SCENE_PARSE, PASS_DAG_FUSE))
		return m->error.code;
	m->robot = a->robot;
	m->tree = a->tree;
	m->dag = a->dag;
	return RNEAGEN_OK;
}

void scene_close(struct scene_model *m)
{
	arena_free(&m->arena);
}

struct reference *scene_reference(const char *urdf, const struct rneagen_options *o)
{
	struct reference_options ro = {.floating = o->base == RNEAGEN_FLOATING,
		.independent = o->mimic == RNEAGEN_MIMIC_INDEPENDENT, .gravity = o->gravity};
	char message[512];
	struct reference *r = reference_open(urdf, strlen(urdf), &ro, message, sizeof message);

	ck_assert_msg(r != NULL, "%s", message);
	ck_assert(r->nq <= ROWS && r->nj <= ROWS);
	return r;
}

void scene_held_init(struct scene_held *h, const struct reference *r)
{
	*h = (struct scene_held){0};
	for (int j = 0; j < r->nj; j++)
		if (r->joints[j].type == REFERENCE_FLOATING)
			h->q[r->joints[j].iq + 6] = 1;
}

/* ---- torques ---- */

struct state {
	double q[ROWS], qd[ROWS], qdd[ROWS];
};

int entry_named(const struct reference *r, const char *name)
{
	for (int j = 0; j < r->nj; j++)
		if (!strcmp(r->joints[j].name, name))
			return j;
	ck_abort_msg("no joint '%s' in the reference", name);
	return -1;
}

void scene_rows(const struct tree *t, const struct reference *r, int *rows)
{
	for (int i = 0; i < t->joint_count; i++)
		for (int k = 0; k < t->joints[i].nv; k++)
			rows[t->joints[i].iv + k] = r->joints[entry_named(r, t->joints[i].name)].iv + k;
}

void scene_settle(const struct tree *t, const struct reference *r, int held, double at, double *q, double *qd, double *qdd,
	real (*left)[ROWS])
{
	if (held >= 0) {
		q[r->joints[held].iq] = at;
		qd[r->joints[held].iv] = qdd[r->joints[held].iv] = 0;
	}
	for (int i = 0; i < t->joint_count; i++) {
		const struct tree_joint *k = &t->joints[i];
		const struct reference_joint *from = &r->joints[entry_named(r, k->name)];

		for (int n = 0; n < k->nq; n++)
			left[0][k->iq + n] = (real)q[from->iq + n];
		for (int n = 0; n < k->nv; n++) {
			left[1][k->iv + n] = (real)qd[from->iv + n];
			left[2][k->iv + n] = (real)qdd[from->iv + n];
		}
	}
}

/* What is held stands still there. */
static void hold(struct state *s, const struct reference *r, const struct scene_held *h)
{
	for (int j = 0; j < r->nj; j++)
		if (h->held[j]) {
			const struct reference_joint *x = &r->joints[j];

			memcpy(s->q + x->iq, h->q + x->iq, (size_t)x->nq * sizeof *s->q);
			memset(s->qd + x->iv, 0, (size_t)x->nv * sizeof *s->qd);
			memset(s->qdd + x->iv, 0, (size_t)x->nv * sizeof *s->qdd);
		}
}

/* The rows that the cut robot still has. */
static void gather(struct state *to, const struct tree *t, const struct reference *r, const struct state *from)
{
	for (int i = 0; i < t->joint_count; i++) {
		const struct tree_joint *k = &t->joints[i];
		const struct reference_joint *x = &r->joints[entry_named(r, k->name)];

		ck_assert_int_eq(k->nq, x->nq);
		memcpy(to->q + k->iq, from->q + x->iq, (size_t)x->nq * sizeof *to->q);
		memcpy(to->qd + k->iv, from->qd + x->iv, (size_t)x->nv * sizeof *to->qd);
		memcpy(to->qdd + k->iv, from->qdd + x->iv, (size_t)x->nv * sizeof *to->qdd);
	}
}

static void check(const struct tree *t, const struct reference *r, const real *tau, const wide *want, const wide *size,
	real eps, uint64_t seed, const char *what)
{
	for (int i = 0; i < t->joint_count; i++) {
		const struct reference_joint *x = &r->joints[entry_named(r, t->joints[i].name)];

		for (int k = 0; k < x->nv; k++) {
			real off = fabsl(tau[t->joints[i].iv + k] - (real)want[x->iv + k]);

			ck_assert_msg(off <= eps * (real)size[x->iv + k],
				"%s, seed %llu, joint '%s' row %d: %.17Lg, not %.17Lg (%Lg)", what, (unsigned long long)seed,
				x->name, k, tau[t->joints[i].iv + k], (real)want[x->iv + k], eps * (real)size[x->iv + k]);
		}
	}
}

static void torques_real(const struct dag *d, const struct state *s, real *tau)
{
	struct pose p;
	struct torque t;

	for (int i = 0; i < ROWS; i++) {
		p.q[i] = (real)s->q[i];
		p.qd[i] = (real)s->qd[i];
		p.qdd[i] = (real)s->qdd[i];
	}
	torque_of(d, &p, &t);
	memcpy(tau, t.tau, sizeof t.tau);
}

static void torques_f64(const struct dag *d, const struct state *s, real *tau)
{
	double out[ROWS] = {0};

	ck_assert(eval_f64(d, (const double *[]){s->q, s->qd, s->qdd, NULL}, (double *[]){NULL, NULL, NULL, out}, NULL));
	for (int i = 0; i < ROWS; i++)
		tau[i] = (real)out[i];
}

static void torques_f32(const struct dag *d, const struct state *s, real *tau)
{
	float in[3][ROWS], out[ROWS] = {0};

	for (int i = 0; i < ROWS; i++) {
		in[0][i] = (float)s->q[i];
		in[1][i] = (float)s->qd[i];
		in[2][i] = (float)s->qdd[i];
	}
	ck_assert(eval_f32(d, (const float *[]){in[0], in[1], in[2], NULL}, (float *[]){NULL, NULL, NULL, out}, NULL));
	for (int i = 0; i < ROWS; i++)
		tau[i] = (real)out[i];
}

struct sampled {
	struct state part;
	wide want[ROWS], size[ROWS];
};

/* A state of the whole robot, what it needs, and the rows of it that the cut one has. */
static void sample(struct sampled *s, const struct scene_model *m, struct reference *r, const struct scene_held *h, uint64_t seed,
	bool f32)
{
	struct rng rng = rng_seed(seed + 77);
	struct state whole = {{0}, {0}, {0}};

	*s = (struct sampled){0};
	reference_sample(r, &rng, f32, whole.q, whole.qd, whole.qdd);
	hold(&whole, r, h);
	reference_rnea(r, whole.q, whole.qd, whole.qdd, s->want);
	reference_magnitude(r, whole.q, whole.qd, whole.qdd, s->size);
	gather(&s->part, &m->tree, r, &whole);
}

void scene_compare(
	const struct scene_model *m, struct reference *r, const struct scene_held *h, uint64_t seed, const char *what)
{
	struct sampled s;
	real tau[ROWS];

	sample(&s, m, r, h, seed, false);
	torques_real(&m->dag, &s.part, tau);
	check(&m->tree, r, tau, s.want, s.size, 1e-14L, seed, what);
	torques_f64(&m->dag, &s.part, tau);
	check(&m->tree, r, tau, s.want, s.size, 32 * 0x1p-53L, seed, what);
	sample(&s, m, r, h, seed, true);
	torques_f32(&m->dag, &s.part, tau);
	check(&m->tree, r, tau, s.want, s.size, 32 * 0x1p-24L, seed, what);
}

/* ---- the text of a part ---- */

static const char *const AXES[] = {"ixx", "ixy", "ixz", "iyy", "iyz", "izz"};

static void put_link(FILE *f, const struct raw_link *l)
{
	fprintf(f,
		"<link name='%s'><inertial><origin xyz='%.17Lg %.17Lg %.17Lg' rpy='%.17Lg %.17Lg %.17Lg'/><mass value='%.17Lg'/><inertia",
		l->name, l->xyz[0], l->xyz[1], l->xyz[2], l->rpy[0], l->rpy[1], l->rpy[2], l->mass);
	for (int i = 0; i < 6; i++)
		fprintf(f, " %s='%.17Lg'", AXES[i], l->inertia[i]);
	fprintf(f, "/></inertial></link>\n");
}

static void put_joint(FILE *f, const struct raw_joint *j)
{
	fprintf(f, "<joint name='%s' type='%s'><parent link='%s'/><child link='%s'/>"
		   "<origin xyz='%.17Lg %.17Lg %.17Lg' rpy='%.17Lg %.17Lg %.17Lg'/><axis xyz='%.17Lg %.17Lg %.17Lg'/>"
		   "<limit effort='1' velocity='1' lower='%.17Lg' upper='%.17Lg'/>",
		j->name, j->type, j->parent, j->child, j->xyz[0], j->xyz[1], j->xyz[2], j->rpy[0], j->rpy[1],
		j->rpy[2], j->axis[0], j->axis[1], j->axis[2], j->lower, j->upper);
	if (j->mimic)
		fprintf(f, "<mimic joint='%s' multiplier='%.17Lg' offset='%.17Lg'/>", j->mimic, j->multiplier, j->offset);
	fprintf(f, "</joint>\n");
}

/* Is a link among those that `in` names? */
static int among(const struct raw_robot *raw, const char *in, const char *link)
{
	for (int i = 0; i < raw->nlinks; i++)
		if (in[i] && !strcmp(raw->links[i].name, link))
			return 1;
	return 0;
}

static int named(const char *name, const char *const *names, int count)
{
	for (int i = 0; i < count; i++)
		if (!strcmp(names[i], name))
			return 1;
	return 0;
}

static void reach(const struct raw_robot *raw, const char *const *gone, int count, char *links, char *joints)
{
	for (int again = 1; again;) {
		again = 0;
		for (int j = 0; j < raw->njoints; j++)
			if (!joints[j] && !named(raw->joints[j].name, gone, count) && among(raw, links, raw->joints[j].parent)) {
				joints[j] = 1;
				again = 1;
				for (int i = 0; i < raw->nlinks; i++)
					links[i] |= !strcmp(raw->links[i].name, raw->joints[j].child);
			}
	}
}

/* Every joint that is there follows one that is. */
static int drivers_there(const struct raw_robot *raw, const char *joints)
{
	for (int j = 0; j < raw->njoints; j++) {
		int there = !joints[j] || !raw->joints[j].mimic;

		for (int i = 0; i < raw->njoints && !there; i++)
			there = joints[i] && !strcmp(raw->joints[i].name, raw->joints[j].mimic);
		if (!there)
			return 0;
	}
	return 1;
}

char *scene_urdf(const char *urdf, const char *root, const char *const *gone, int count)
{
	struct raw_robot raw;
	char message[256], links[ROWS] = {0}, joints[ROWS] = {0}, *text = NULL;
	size_t length;
	FILE *f;

	ck_assert_msg(raw_read(&raw, urdf, strlen(urdf), false, message, sizeof message), "%s", message);
	ck_assert(raw.nlinks <= ROWS);
	for (int i = 0; i < raw.nlinks; i++)
		links[i] = !strcmp(raw.links[i].name, root);
	reach(&raw, gone, count, links, joints);
	f = open_memstream(&text, &length);
	fprintf(f, "<robot name='part'>\n");
	for (int i = 0; i < raw.nlinks; i++)
		if (links[i])
			put_link(f, &raw.links[i]);
	for (int j = 0; j < raw.njoints; j++)
		if (joints[j])
			put_joint(f, &raw.joints[j]);
	fprintf(f, "</robot>\n");
	fclose(f);
	if (!drivers_there(&raw, joints)) {
		free(text);
		text = NULL;
	}
	raw_free(&raw);
	return text;
}

size_t operation_total(const struct scene_model *m)
{
	struct plan p;
	struct operation_count n;

	ck_assert(plan_build(&p, &m->dag, &m->tree, (struct arena *)&m->arena));
	n = plan_operations(&p);
	return (size_t)n.mul + n.add + n.sub + 2 * (size_t)n.fma + n.sincos;
}
