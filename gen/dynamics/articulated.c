#include "dynamics/articulated.h"

/* A wrench, or an acceleration of a body: about its origin, and of it. */
struct pair {
	struct svec angular, linear;
};

static const struct svec NOTHING;

int articulated_serves(const struct tree *t)
{
	return t->mimic_count == 0;
}

/* Factors take d^2 operations for a row with d rows on its path from the ground. */
int articulated_is_shorter(const struct tree *t)
{
	enum { FOR_A_ROW = 2000 };
	long long squares = 0;

	for (int b = 0; b < t->body_count; b++) {
		long long d = 0;

		for (int k = b; k >= 0; k = t->bodies[k].parent)
			d += joint_nv(t->bodies[k].type);
		squares += joint_nv(t->bodies[b].type) * d * d;
	}
	return articulated_serves(t) && squares > (long long)FOR_A_ROW * t->nv;
}

static struct ref armature(const struct tour *r, int body)
{
	return own_term(r, OWN_ARMATURE, body, within_exact(1));
}

static struct smat smat_sum(struct dag *d, const struct smat *S, const struct smat *T)
{
	struct smat out;

	for (int i = 0; i < 3; i++)
		for (int j = 0; j < 3; j++)
			out.m[i][j] = dag_add(d, S->m[i][j], T->m[i][j]);
	return out;
}

/* S + [p]x T */
static struct smat plus_crossed(struct dag *d, const struct smat *S, struct svec p, const struct smat *T)
{
	struct smat out;

	for (int j = 0; j < 3; j++)
		smat_set_column(&out, j, svec_add_cross(d, smat_column(S, j), p, smat_column(T, j)));
	return out;
}

/* One triangle serves for both. */
static void mirror(struct smat *T)
{
	for (int i = 0; i < 3; i++)
		for (int j = 0; j < i; j++)
			T->m[i][j] = T->m[j][i];
}

/* ---- joints ---- */

/* The unit acceleration of a row of the joint, in the body's frame. */
static struct pair unit(const struct tour *r, int body, int row)
{
	struct dag *d = r->d;
	const struct body *k = &r->t->bodies[body];
	struct joint_rates x = joint_unit(d, k, row);

	return (struct pair){x.W, svec_add(d, joint_into(d, k, &r->frames[body + 1].pose, x.V0), x.V)};
}

static void project(const struct tour *r, int body, struct pair w, struct ref *tau)
{
	const struct body *k = &r->t->bodies[body];

	joint_project(r->d, k, w.linear, w.angular, joint_out_of(r->d, k, &r->frames[body + 1].pose, w.linear), tau);
}

/* ---- back: what a parent feels of its child ---- */

static struct pair wrench_of(struct dag *d, const struct articulated_body *x, struct pair a)
{
	struct smat Bt = smat_transposed(&x->B);

	return (struct pair){smat_add_mul(d, smat_mul(d, &x->A, a.angular), &x->B, a.linear),
		smat_add_mul(d, smat_mul(d, &Bt, a.angular), &x->C, a.linear)};
}

/* U = I S, D = S^T U, with the rotor's inertia in D. */
static void free_joint(struct articulated *x, int body, int *singular)
{
	const struct tour *r = x->r;
	const struct body *k = &r->t->bodies[body];
	struct articulated_body *y = &x->bodies[body];
	struct ref D[36], felt[6];
	int n = joint_nv(k->type);

	for (int i = 0; i < n; i++) {
		struct pair U = wrench_of(r->d, y, unit(r, body, i));

		y->Un[i] = U.angular;
		y->Uf[i] = U.linear;
		project(r, body, U, felt);
		for (int j = 0; j < n; j++)
			D[j * n + i] = felt[j];
	}
	if (n == 1)
		D[0] = dag_add(r->d, D[0], armature(r, body));
	if (!factor_make(&y->D, r->d, n, NULL, D, singular) && *singular < 0)
		r->d->failed = 1;
	else if (*singular >= 0)
		*singular += k->iv;
}

/* U D^-1 U^T off the inertia. Along the axis of a joint with one row nothing is left but the rotor's part. */
static void let_go(const struct articulated *x, int body)
{
	struct dag *d = x->r->d;
	struct articulated_body *y = &x->bodies[body];
	int n = joint_nv(x->r->t->bodies[body].type);

	for (int i = 0; i < 6; i++) {
		struct ref row[6] = {{0}};

		for (int k = 0; k < n; k++)
			row[k] = i < 3 ? y->Un[k].x[i] : y->Uf[k].x[i - 3];
		factor_solve(&y->D, row);
		for (int j = 0; j < 6; j++) {
			struct ref *e = i < 3 ? (j < 3 ? &y->A.m[i][j] : &y->B.m[i][j - 3])
				: (j < 3 ? NULL : &y->C.m[i - 3][j - 3]);

			for (int k = 0; k < n && e; k++)
				*e = dag_sub(d, *e, dag_mul(d, row[k], j < 3 ? y->Un[k].x[j] : y->Uf[k].x[j - 3]));
		}
	}
	mirror(&y->A);
	mirror(&y->C);
}

/* What is exactly zero then: the acceleration of the joint takes no wrench. */
static void clear_axis(const struct articulated *x, int body)
{
	const struct body *k = &x->r->t->bodies[body];
	struct articulated_body *y = &x->bodies[body];
	const struct ref zero = {0};
	int a = k->axis;

	if (joint_nv(k->type) != 1 || armature(x->r, body).i)
		return;
	for (int i = 0; i < 3; i++) {
		if (k->type == JOINT_PRISMATIC)
			y->B.m[i][a] = y->C.m[i][a] = y->C.m[a][i] = zero;
		else
			y->B.m[a][i] = y->A.m[i][a] = y->A.m[a][i] = zero;
	}
}

/* B' = B + [p]x C, A' = A + [p]x B^T + ([p]x B'^T)^T, C' = C, all turned into the parent's axes. */
static void add_to_parent(const struct articulated *x, int body)
{
	const struct tour *r = x->r;
	struct dag *d = r->d;
	const struct body *k = &r->t->bodies[body];
	const struct joint_pose *at = &r->frames[body + 1].pose;
	struct articulated_body *to = &x->bodies[k->parent];
	struct smat A = joint_turn(d, k, at, &x->bodies[body].A), B = joint_turn(d, k, at, &x->bodies[body].B);
	struct smat C = joint_turn(d, k, at, &x->bodies[body].C), moved, T;

	mirror(&A);
	mirror(&C);
	moved = plus_crossed(d, &B, at->p, &C);
	T = smat_transposed(&B);
	A = plus_crossed(d, &A, at->p, &T);
	A = smat_transposed(&A);
	T = smat_transposed(&moved);
	A = plus_crossed(d, &A, at->p, &T);
	A = smat_transposed(&A);
	mirror(&A);
	to->A = smat_sum(d, &to->A, &A);
	to->B = smat_sum(d, &to->B, &moved);
	to->C = smat_sum(d, &to->C, &C);
}

/* [h]x and m 1 */
static void add_own(const struct articulated *x, int body)
{
	const struct tour *r = x->r;
	struct dag *d = r->d;
	struct parameters known = rigid_body_parameters(d, &r->t->bodies[body].inertia);
	const struct parameters *p = r->parameters && r->parameters[body] ? r->parameters[body] : &known;
	struct articulated_body *y = &x->bodies[body];
	struct smat I = rigid_body_inertia_matrix(p);

	y->A = smat_sum(d, &y->A, &I);
	for (int i = 0; i < 3; i++) {
		int j = (i + 1) % 3, k = (i + 2) % 3;

		y->B.m[j][i] = dag_add(d, y->B.m[j][i], p->h.x[k]);
		y->B.m[i][j] = dag_sub(d, y->B.m[i][j], p->h.x[k]);
		y->C.m[i][i] = dag_add(d, y->C.m[i][i], p->mass);
	}
}

void articulated_begin(struct articulated *x, const struct tour *r)
{
	x->r = r;
	x->bodies = arena_alloc(r->d->arena, (size_t)r->t->body_count, sizeof *x->bodies);
	if (!x->bodies)
		r->d->failed = 1;
}

void articulated_leave(struct articulated *x, int body, int *singular)
{
	const struct body *k = &x->r->t->bodies[body];

	add_own(x, body);
	if (joint_nv(k->type))
		free_joint(x, body, singular);
	if (x->r->d->failed || *singular >= 0 || k->parent < 0 || k->type == JOINT_FLOATING)
		return;
	if (joint_nv(k->type)) {
		let_go(x, body);
		clear_axis(x, body);
	}
	add_to_parent(x, body);
}

/* ---- solving ---- */

static struct pair scaled(struct dag *d, const struct articulated_body *y, const struct ref *s, int n)
{
	struct pair sum = {NOTHING, NOTHING};

	for (int k = 0; k < n; k++) {
		sum.angular = svec_add(d, sum.angular, svec_scale(d, s[k], y->Un[k]));
		sum.linear = svec_add(d, sum.linear, svec_scale(d, s[k], y->Uf[k]));
	}
	return sum;
}

/* u = b - S^T p; the parent feels p + U D^-1 u. `b` becomes D^-1 u, and `half`, where it is not NULL, u halfway
   through D. */
static void solve_back(const struct articulated *x, int body, struct pair *p, struct ref *b, struct ref *half)
{
	const struct tour *r = x->r;
	struct dag *d = r->d;
	const struct body *k = &r->t->bodies[body];
	const struct joint_pose *at = &r->frames[body + 1].pose;
	const struct articulated_body *y = &x->bodies[body];
	struct pair own, *to;
	struct ref felt[6];
	int n = joint_nv(k->type);

	project(r, body, p[body], felt);
	for (int i = 0; i < n; i++)
		b[k->iv + i] = dag_sub(d, b[k->iv + i], felt[i]);
	for (int i = 0; i < n && half; i++)
		half[k->iv + i] = b[k->iv + i];
	if (n && half)
		factor_reduce(&y->D, half + k->iv);
	if (n)
		factor_solve(&y->D, b + k->iv);
	if (k->parent < 0)
		return;
	own = scaled(d, y, b + k->iv, n);
	own.angular = joint_to_parent(d, k, at, svec_add(d, p[body].angular, own.angular));
	own.linear = joint_to_parent(d, k, at, svec_add(d, p[body].linear, own.linear));
	to = &p[k->parent];
	to->linear = svec_add(d, to->linear, own.linear);
	to->angular = svec_add(d, to->angular, svec_add_cross(d, own.angular, at->p, own.linear));
}

/* Of a body, or the world, -1, and all beyond it, limb after limb as the tour goes: of one nothing but its sum waits when the
   next one begins. */
static void solve_beyond(const struct articulated *x, int body, struct pair *p, struct ref *b, struct ref *half)
{
	const struct tree *t = x->r->t;
	int end = body < 0 ? t->body_count : tree_end(t, body);

	for (int k = body + 1; k < end; k++)
		if (t->bodies[k].parent == body)
			solve_beyond(x, k, p, b, half);
	if (body >= 0)
		solve_back(x, body, p, b, half);
}

/* The parent's acceleration at the body's origin, in the body's frame. */
static struct pair into(const struct tour *r, int body, const struct pair *from)
{
	struct dag *d = r->d;
	const struct body *k = &r->t->bodies[body];
	const struct joint_pose *at = &r->frames[body + 1].pose;
	struct svec linear = svec_add_cross(d, from->linear, from->angular, at->p);

	return (struct pair){joint_into(d, k, at, smat_mul_transposed(d, &at->R, from->angular)),
		joint_into(d, k, at, smat_mul_transposed(d, &at->R, linear))};
}

/* x = D^-1 u - D^-1 U^T a, and the body's acceleration is a + S x. */
static void solve_out(const struct articulated *x, int body, struct pair *a, struct ref *b)
{
	const struct tour *r = x->r;
	struct dag *d = r->d;
	const struct body *k = &r->t->bodies[body];
	const struct articulated_body *y = &x->bodies[body];
	struct pair *to = &a[body];
	struct ref less[6] = {{0}};
	int n = joint_nv(k->type);

	if (k->parent >= 0)
		*to = into(r, body, &a[k->parent]);
	for (int i = 0; i < n; i++)
		less[i] = svec_add_dot(d, svec_dot(d, y->Un[i], to->angular), y->Uf[i], to->linear);
	if (n)
		factor_solve(&y->D, less);
	for (int i = 0; i < n; i++) {
		struct pair s = unit(r, body, i);

		b[k->iv + i] = dag_sub(d, b[k->iv + i], less[i]);
		to->angular = svec_add(d, to->angular, svec_scale(d, b[k->iv + i], s.angular));
		to->linear = svec_add(d, to->linear, svec_scale(d, b[k->iv + i], s.linear));
	}
}

void articulated_solve(const struct articulated *x, struct ref *b, const struct svec *f, const struct svec *n)
{
	const struct tree *t = x->r->t;
	struct pair *p = arena_alloc(x->r->d->arena, 2 * (size_t)t->body_count, sizeof *p), *a = p + t->body_count;

	if (!p) {
		x->r->d->failed = 1;
		return;
	}
	for (int k = 0; k < t->body_count && f; k++)
		p[k] = (struct pair){n[k], f[k]};
	solve_beyond(x, -1, p, b, NULL);
	for (int k = 0; k < t->body_count; k++)
		solve_out(x, k, a, b);
}

void articulated_halve(const struct articulated *x, const struct ref *b, struct ref *y)
{
	const struct tree *t = x->r->t;
	struct pair *p = arena_alloc(x->r->d->arena, (size_t)t->body_count, sizeof *p);
	struct ref *copy = arena_alloc(x->r->d->arena, (size_t)t->nv, sizeof *copy);

	if (!p || !copy) {
		x->r->d->failed = 1;
		return;
	}
	for (int i = 0; i < t->nv; i++)
		copy[i] = b[i];
	solve_beyond(x, -1, p, copy, y);
}

/* p - U D^-1 u; nothing of it is along the axis of a joint that moves freely. */
static struct pair let_through(const struct articulated *x, int body, struct pair p, struct ref *u)
{
	struct dag *d = x->r->d;
	const struct body *k = &x->r->t->bodies[body];
	struct pair less;

	factor_solve(&x->bodies[body].D, u);
	less = scaled(d, &x->bodies[body], u, joint_nv(k->type));
	p = (struct pair){svec_sub(d, p.angular, less.angular), svec_sub(d, p.linear, less.linear)};
	if (joint_nv(k->type) == 1 && !armature(x->r, body).i)
		(k->type == JOINT_PRISMATIC ? &p.linear : &p.angular)->x[k->axis] = (struct ref){0};
	return p;
}

void articulated_reduce(const struct articulated *x, int body, struct svec *f, struct svec *n, struct ref *y)
{
	struct dag *d = x->r->d;
	const struct body *k = &x->r->t->bodies[body];
	const struct joint_pose *at = &x->r->frames[body + 1].pose;
	struct pair p = {*n, *f};
	struct ref u[6];
	int rows = joint_nv(k->type);

	project(x->r, body, p, u);
	for (int i = 0; i < rows; i++)
		y[i] = u[i];
	if (rows)
		factor_reduce(&x->bodies[body].D, y);
	if (k->parent < 0)
		return;
	if (rows)
		p = let_through(x, body, p, u);
	*f = joint_to_parent(d, k, at, p.linear);
	*n = svec_add_cross(d, joint_to_parent(d, k, at, p.angular), at->p, *f);
}
