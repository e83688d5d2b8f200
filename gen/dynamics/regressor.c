/* tau = Y pi: the torques of rigid bodies are linear in the ten inertial parameters of each (Atkeson, An, Hollerbach, Estimation
   of inertial parameters of manipulator loads and links, 1986). With (V, W) the twist that a unit rate of coordinate j makes of
   body i, element (j, 10 i + k) is its power V.f + W.n on the wrench (f, n) that the motion of body i takes with parameter k one
   and all others zero.

   Twists are carried out to the bodies: that takes a rotation and a lever arm of one twist, where carrying the ten wrenches
   back would take those of ten. So no block waits for others, and nothing comes back. */
#include "dynamics/regressor.h"
#include <string.h>

/* ---- twists ---- */

/* W = R'W_p, V = R'(V_p + W_p x p) */
static struct carried_twist carry(struct dag *d, const struct body *k, const struct joint_pose *at,
	const struct carried_twist *from)
{
	struct svec V = svec_add(d, from->V, svec_cross(d, from->W, at->p));

	return (struct carried_twist){.row = from->row,
		.V = joint_into(d, k, at, smat_mul_transposed(d, &at->R, V)),
		.W = joint_into(d, k, at, smat_mul_transposed(d, &at->R, from->W))};
}

/* Of all coordinates from the base to the body's own. */
static int carry_all(struct regressor *x, int body)
{
	struct dag *d = x->r->d;
	const struct body *k = &x->r->t->bodies[body];
	const struct joint_pose *at = &x->r->frames[body + 1].pose;
	struct body_twists none = {0}, *from = k->parent < 0 ? &none : &x->twists[k->parent], *to = &x->twists[body];

	to->of = arena_alloc(d->arena, (size_t)(from->count + joint_nv(k->type)), sizeof *to->of);
	if (d->arena->failed)
		return 0;
	for (int i = 0; i < from->count; i++)
		to->of[to->count++] = carry(d, k, at, &from->of[i]);
	for (int i = 0; i < joint_nv(k->type); i++) {
		struct carried_twist *own = &to->of[to->count++];

		own->row = k->iv + i;
		joint_unit_twist(d, k, at, i, &own->V, &own->W);
	}
	return 1;
}

/* ---- in the frame that the parameters are in: x_urdf = A x + o ---- */

/* Where its origin is in the body's frame: -A'o. */
static struct svec link_origin(struct dag *d, const struct body *k)
{
	struct rotation back = rotation_transpose(&k->frame);
	struct within p[3];

	rotation_apply(&back, k->origin, p);
	for (int i = 0; i < 3; i++)
		p[i] = within_neg(p[i]);
	return svec_const(d, p);
}

static struct motion motion_of_link(struct dag *d, const struct body *k, const struct motion *x)
{
	struct smat A = smat_const(d, &k->frame);
	struct motion to = {.w = smat_mul(d, &A, x->w), .dw = smat_mul(d, &A, x->dw),
		.a = smat_mul(d, &A, svec_add(d, x->a, smat_mul(d, &x->U, link_origin(d, k))))};

	to.U = motion_rate_matrix(d, to.w, to.dw);
	return to;
}

static struct carried_twist twist_of_link(struct dag *d, const struct body *k, const struct carried_twist *x)
{
	struct smat A = smat_const(d, &k->frame);

	return (struct carried_twist){.row = x->row, .W = smat_mul(d, &A, x->W),
		.V = smat_mul(d, &A, svec_add(d, x->V, svec_cross(d, x->W, link_origin(d, k))))};
}

/* ---- elements ---- */

/* The columns of a lump: a follower's are added to its driver's. */
static void fill(struct regressor *x, int body)
{
	struct dag *d = x->r->d;
	const struct body *k = &x->r->t->bodies[body];
	struct motion motion = motion_of_link(d, k, &x->r->frames[body + 1].motion);

	memset(x->element, 0, (size_t)x->r->t->nv * sizeof *x->element);
	for (int i = 0; i < x->twists[body].count; i++) {
		struct carried_twist twist = twist_of_link(d, k, &x->twists[body].of[i]);
		struct ref power[LUMP_PARAMETERS];

		rigid_body_powers(d, &motion, twist.V, twist.W, power);
		for (int c = 0; c < LUMP_PARAMETERS; c++)
			x->element[twist.row][c] = dag_add(d, x->element[twist.row][c], power[c]);
	}
}

static void write(const struct regressor *x, int lump)
{
	for (int i = 0; i < x->r->t->nv; i++)
		for (int c = 0; c < LUMP_PARAMETERS; c++) {
			int row = x->p.row[i * x->p.cols + LUMP_PARAMETERS * lump + c];

			if (row >= 0)
				dag_output(x->r->d, x->argument, row, x->element[i][c]);
		}
}

void regressor_enter(struct regressor *x, int body)
{
	int lump = x->lumps.of[body];

	dag_section(x->r->d, SECTION_REGRESSOR, body);
	if (!carry_all(x, body)) {
		x->r->d->failed = 1;
		return;
	}
	if (lump < 0 || x->lumps.body[lump] != body)
		return;
	fill(x, body);
	write(x, lump);
}

void regressor_begin(struct regressor *x, const struct tour *r, int argument)
{
	struct arena *a = r->d->arena;

	*x = (struct regressor){.r = r, .argument = argument};
	x->twists = arena_alloc(a, (size_t)r->t->body_count, sizeof *x->twists);
	x->element = arena_alloc(a, (size_t)r->t->nv, sizeof *x->element);
	if (!x->twists || !x->element || !lumps_make(&x->lumps, r->t, a) || !pattern_lumps(&x->p, r->t, r->request->dense, a)) {
		r->d->failed = 1;
		x->r = NULL;
	}
}
