/* The mass matrix by composite bodies (Walker and Orin 1982; Featherstone 2008, table 6.2): the inertia of a subtree, as one
   rigid body, times a joint's axis is the wrench that a unit acceleration of the joint takes; each joint on the way to the
   base feels its part of it. */
#include "tour.h"

struct composite {
	struct joint_pose pose;
	struct parameters p; /* of the subtree, about the body's origin, in its frame */
};

struct crba {
	struct dag *d;
	const struct tree *t;
	struct composite *bodies;
	struct ref *M; /* [nv][nv] */
};

/* R(q) u of the whole joint: from the body's frame into its parent's */
static struct svec out_of(const struct crba *x, int body, struct svec u)
{
	const struct composite *c = &x->bodies[body];

	return smat_mul(x->d, &c->pose.R, joint_out_of(x->d, &x->t->bodies[body], &c->pose, u));
}

/* A I A^T for the symmetric I and the joint's rotation A */
static struct smat turned(const struct crba *x, int body, const struct parameters *p)
{
	struct svec B[3], column;
	struct smat out;

	for (int j = 0; j < 3; j++) {
		for (int i = 0; i < 3; i++)
			column.x[i] = p->I[inertia_index(i < j ? i : j, i < j ? j : i)];
		B[j] = out_of(x, body, column);
	}
	for (int i = 0; i < 3; i++) {
		column = out_of(x, body, (struct svec){{B[0].x[i], B[1].x[i], B[2].x[i]}});
		for (int j = 0; j < 3; j++)
			out.m[j][i] = column.x[j];
	}
	return out;
}

/* m' = m, h' = R h + m p, I' = R I R^T + (2 p.Rh + m p.p) 1 - (Rh p^T + p (Rh)^T + m p p^T); with w = Rh + m p/2, that is
   2 p.w 1 - w p^T - p w^T */
static void add_to_parent(const struct crba *x, int body)
{
	struct dag *d = x->d;
	const struct composite *c = &x->bodies[body];
	struct parameters *to = &x->bodies[x->t->bodies[body].parent].p;
	struct svec p = c->pose.p, h = out_of(x, body, c->p.h), w;
	struct smat I = turned(x, body, &c->p);
	struct ref twice;

	w = svec_add(d, h, svec_scale(d, dag_mul(d, dag_const(d, 0.5L), c->p.mass), p));
	twice = dag_mul(d, dag_const(d, 2), svec_dot(d, p, w));
	for (int i = 0; i < 3; i++)
		for (int j = i; j < 3; j++) {
			int at = inertia_index(i, j);
			struct ref e = dag_sub(d, I.m[i][j], dag_add(d, dag_mul(d, w.x[i], p.x[j]), dag_mul(d, p.x[i], w.x[j])));

			to->I[at] = dag_add(d, to->I[at], i == j ? dag_add(d, e, twice) : e);
		}
	to->h = svec_add(d, to->h, svec_add(d, h, svec_scale(d, c->p.mass, p)));
	to->mass = dag_add(d, to->mass, c->p.mass);
}

/* f = m v + w x h, n = I w + h x v for the twist of a unit rate of the joint's coordinate `row` */
static void unit_wrench(const struct crba *x, int body, int row, struct svec *f, struct svec *n)
{
	struct dag *d = x->d;
	const struct body *k = &x->t->bodies[body];
	const struct parameters *p = &x->bodies[body].p;
	struct joint_rates unit = joint_unit(d, k, row);
	struct svec v = svec_add(d, joint_into(d, k, &x->bodies[body].pose, unit.V0), unit.V), w = unit.W;

	*f = svec_add(d, svec_scale(d, p->mass, v), svec_cross(d, w, p->h));
	*n = svec_add(d, load_inertia_times(d, p, w), svec_cross(d, p->h, v));
}

/* M_ij += what the joint of `here` feels of a unit rate in row `column` of another or itself; of a joint's own rows one
   half is made, and stands for both */
static void feel(const struct crba *x, int here, int body, int column, struct svec f, struct svec n)
{
	struct dag *d = x->d;
	const struct body *k = &x->t->bodies[here];
	int nv = x->t->nv, own = here == body ? column - k->iv : 0;
	struct ref s[6];

	joint_project(d, k, f, n, joint_out_of(d, k, &x->bodies[here].pose, f), s);
	for (int i = own; i < joint_nv(k->type); i++) {
		struct ref *e = &x->M[(k->iv + i) * nv + column], *mirror = &x->M[column * nv + k->iv + i];

		*e = dag_add(d, *e, s[i]);
		if (here != body || i > own)
			*mirror = e == mirror ? dag_add(d, *e, s[i]) : dag_add(d, *mirror, s[i]);
	}
}

static void column_of(const struct crba *x, int body, int row)
{
	struct dag *d = x->d;
	struct svec f, n;

	unit_wrench(x, body, row, &f, &n);
	for (int here = body;;) {
		feel(x, here, body, x->t->bodies[body].iv + row, f, n);
		if (x->t->bodies[here].parent < 0)
			return;
		f = out_of(x, here, f);
		n = svec_add(d, out_of(x, here, n), svec_cross(d, x->bodies[here].pose.p, f));
		here = x->t->bodies[here].parent;
	}
}

void crba_build(struct dag *d, const struct tree *t, struct joint_inputs in, struct parameters *const *parameters, struct ref *M)
{
	struct crba x = {d, t, arena_alloc(d->arena, (size_t)t->body_count, sizeof *x.bodies), M};

	if (!x.bodies) {
		d->failed = 1;
		return;
	}
	for (int k = 0; k < t->body_count; k++) {
		dag_section(d, SECTION_OUT, k);
		x.bodies[k].pose = joint_place(d, &t->bodies[k], in);
		x.bodies[k].p = parameters[k] ? *parameters[k] : load_parameters(d, &t->bodies[k].inertia);
	}
	for (int k = t->body_count - 1; k >= 0; k--) {
		dag_section(d, SECTION_MASS, k);
		for (int row = 0; row < joint_nv(t->bodies[k].type); row++)
			column_of(&x, k, row);
		if (t->bodies[k].parent >= 0)
			add_to_parent(&x, k);
	}
}
