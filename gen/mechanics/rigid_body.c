#include "mechanics/rigid_body.h"

struct smat motion_rate_matrix(struct dag *d, struct svec w, struct svec dw)
{
	struct smat U;

	for (int i = 0; i < 3; i++) {
		int j = (i + 1) % 3, k = (i + 2) % 3;
		struct ref jk = dag_mul(d, w.x[j], w.x[k]);

		U.m[i][i] = dag_neg(d, dag_add_products(d, w.x[j], w.x[j], w.x[k], w.x[k]));
		U.m[j][k] = dag_sub(d, jk, dw.x[i]);
		U.m[k][j] = dag_add(d, jk, dw.x[i]);
	}
	return U;
}

struct svec motion_slide(struct dag *d, struct svec w, struct svec V, struct svec dV)
{
	struct svec turned = svec_cross(d, w, V);

	return svec_add(d, dV, svec_scale(d, dag_const(d, 2), turned));
}

/* With the products of w that U has already:
   n_i = I_ii dw_i + (I_kk - I_jj) w_j w_k - I_ij U_ki + I_ik U_ji + I_jk (w_j^2 - w_k^2) */
struct svec rigid_body_moment(struct dag *d, const struct inertia *I, const struct motion *x)
{
	struct svec n;

	for (int i = 0; i < 3; i++) {
		int j = (i + 1) % 3, k = (i + 2) % 3;
		struct sum spread = {0};
		struct ref squares = dag_sub_products(d, x->w.x[j], x->w.x[j], x->w.x[k], x->w.x[k]), turning;

		sum_add(&spread, I->I[inertia_index(k, k)]);
		sum_add(&spread, within_neg(I->I[inertia_index(j, j)]));
		turning = dag_mul(d, x->w.x[j], x->w.x[k]);
		turning = dag_mul(d, dag_within(d, sum_total(spread)), turning);
		n.x[i] = dag_add(d, dag_mul(d, dag_within(d, I->I[inertia_index(i, i)]), x->dw.x[i]), turning);
		n.x[i] = dag_sub(d, n.x[i], dag_mul(d, dag_within(d, I->I[inertia_index(i, j)]), x->U.m[k][i]));
		n.x[i] = dag_add(d, n.x[i], dag_mul(d, dag_within(d, I->I[inertia_index(i, k)]), x->U.m[j][i]));
		n.x[i] = dag_add(d, n.x[i], dag_mul(d, dag_within(d, I->I[inertia_index(j, k)]), squares));
	}
	return n;
}

/* I less what the mass makes of it from its centre c = h/m: I_c = I - m (c.c 1 - c c^T), with c in place of h. */
static struct inertia central(const struct inertia *I)
{
	struct inertia J = *I;

	for (int i = 0; i < 3; i++)
		J.h[i] = within_div(I->h[i], I->mass);
	for (int i = 0; i < 3; i++)
		for (int j = i; j < 3; j++) {
			struct sum s = {0};

			sum_add(&s, I->I[inertia_index(i, j)]);
			sum_add(&s, within_mul(I->h[i], J.h[j]));
			for (int k = 0; k < 3 && i == j; k++)
				sum_add(&s, within_neg(within_mul(I->h[k], J.h[k])));
			J.I[inertia_index(i, j)] = sum_total(s);
		}
	return J;
}

static int is_there(struct within c)
{
	return c.x != 0 || c.limb > 0;
}

/* Products that such a moment needs. */
static int moment_products(const struct inertia *I)
{
	int count = 0;

	for (int i = 0; i < 3; i++) {
		struct within other = I->I[inertia_index((i + 1) % 3, (i + 1) % 3)];
		struct sum spread = {0};

		sum_add(&spread, I->I[inertia_index(i, i)]);
		sum_add(&spread, within_neg(other));
		count += is_there(I->I[inertia_index(i, i)]) + is_there(sum_total(spread));
		count += 3 * is_there(I->I[inertia_index(i, (i + 1) % 3)]);
	}
	return count;
}

/* Is the wrench about the centre of mass cheaper? There the long lever arms of a far centre do not cancel; but it takes
   all of f, which a body that turns on the ground need not have. */
static int prefers_centre(const struct body *k, const struct inertia *I)
{
	int grounded = k->parent < 0 && (k->type == JOINT_REVOLUTE || k->type == JOINT_CONTINUOUS);

	return !grounded && moment_products(I) < moment_products(&k->inertia);
}

void rigid_body_wrench(struct dag *d, const struct body *k, const struct motion *x, struct svec *f, struct svec *n)
{
	struct ref mass = dag_within(d, k->inertia.mass);
	struct svec h = svec_const(d, k->inertia.h);
	struct inertia I_c = {0};

	if (k->inertia.mass.x != 0)
		I_c = central(&k->inertia);
	if (k->inertia.mass.x != 0 && prefers_centre(k, &I_c)) {
		struct svec c = svec_const(d, I_c.h);

		*f = svec_scale(d, mass, svec_add(d, x->a, smat_mul(d, &x->U, c)));
		*n = svec_cross(d, c, *f);
		*n = svec_add(d, rigid_body_moment(d, &I_c, x), *n);
	} else {
		*f = smat_mul(d, &x->U, h);
		*f = svec_add(d, svec_scale(d, mass, x->a), *f);
		*n = svec_cross(d, h, x->a);
		*n = svec_add(d, rigid_body_moment(d, &k->inertia, x), *n);
	}
}

/* ---- parameters that are expressions ---- */

struct parameters rigid_body_parameters(struct dag *d, const struct inertia *I)
{
	struct parameters p = {.mass = dag_within(d, I->mass), .h = svec_const(d, I->h)};

	for (int i = 0; i < 6; i++)
		p.I[i] = dag_within(d, I->I[i]);
	return p;
}

static struct ref plus_multiple(struct dag *d, struct ref sum, struct ref s, struct within c)
{
	return dag_add(d, sum, dag_mul(d, dag_within(d, c), s));
}

void rigid_body_add(struct dag *d, struct parameters *p, struct ref s, const struct inertia *I)
{
	p->mass = plus_multiple(d, p->mass, s, I->mass);
	for (int i = 0; i < 3; i++)
		p->h.x[i] = plus_multiple(d, p->h.x[i], s, I->h[i]);
	for (int i = 0; i < 6; i++)
		p->I[i] = plus_multiple(d, p->I[i], s, I->I[i]);
}

struct smat rigid_body_inertia_matrix(const struct parameters *p)
{
	struct smat I;

	for (int i = 0; i < 3; i++)
		for (int j = 0; j < 3; j++)
			I.m[i][j] = p->I[inertia_index(i < j ? i : j, i < j ? j : i)];
	return I;
}

struct svec rigid_body_inertia_times(struct dag *d, const struct parameters *p, struct svec w)
{
	struct smat I = rigid_body_inertia_matrix(p);

	return smat_mul(d, &I, w);
}

void rigid_body_wrench_free(struct dag *d, const struct parameters *p, const struct motion *x, struct svec *f, struct svec *n)
{
	*f = smat_mul(d, &x->U, p->h);
	*f = svec_add(d, svec_scale(d, p->mass, x->a), *f);
	*n = svec_cross(d, x->w, rigid_body_inertia_times(d, p, x->w));
	*n = svec_add(d, rigid_body_inertia_times(d, p, x->dw), *n);
	*n = svec_add(d, *n, svec_cross(d, p->h, x->a));
}

/* I dw + w x I w, about the axes i, j, k in cyclic order: of a unit of I_ii it is (dw_i, w_k w_i, -w_i w_j), of a unit of I_jk
   (w_j^2 - w_k^2, -U_ij, U_ik). */
static void unit_moments(struct dag *d, const struct motion *x, int i, struct svec *diagonal, struct svec *across)
{
	int j = (i + 1) % 3, k = (i + 2) % 3;

	diagonal->x[i] = x->dw.x[i];
	diagonal->x[j] = dag_mul(d, x->w.x[k], x->w.x[i]);
	diagonal->x[k] = dag_neg(d, dag_mul(d, x->w.x[i], x->w.x[j]));
	across->x[i] = dag_sub_products(d, x->w.x[j], x->w.x[j], x->w.x[k], x->w.x[k]);
	across->x[j] = dag_neg(d, x->U.m[i][j]);
	across->x[k] = x->U.m[i][k];
}

void rigid_body_powers(struct dag *d, const struct motion *x, struct svec V, struct svec W, struct ref *power)
{
	struct svec h = svec_cross(d, x->a, W);

	h = svec_add(d, smat_mul_transposed(d, &x->U, V), h);
	power[0] = svec_dot(d, V, x->a);
	for (int i = 0; i < 3; i++) {
		struct svec diagonal, across;

		unit_moments(d, x, i, &diagonal, &across);
		power[1 + i] = h.x[i];
		power[4 + inertia_index(i, i)] = svec_dot(d, W, diagonal);
		power[4 + (i == 0 ? inertia_index(1, 2) : inertia_index(0, 3 - i))] = svec_dot(d, W, across);
	}
}

struct ref rigid_body_kinetic(struct dag *d, const struct parameters *p, const struct motion *x)
{
	struct ref turning = svec_dot(d, x->w, rigid_body_inertia_times(d, p, x->w));
	struct ref twice = dag_add(d, dag_mul(d, p->mass, svec_dot(d, x->v, x->v)), turning);
	struct ref both = svec_dot(d, x->v, svec_cross(d, x->w, p->h));

	return dag_add(d, dag_mul(d, dag_const(d, 0.5L), twice), both);
}
