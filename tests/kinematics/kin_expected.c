/* What the reference says of each want, in the shape of what the DAG gives. */
#include "kinematics/kin_case.h"
#include <check.h>
#include <string.h>

struct reference_frame kin_frame(const struct kin_case *c, const char *name)
{
	struct reference_frame f;
	wide at[6];

	for (int i = 0; i < c->added_count; i++)
		if (!strcmp(c->added[i].name, name)) {
			f = reference_frame_named(c->reference, c->added[i].link);
			for (int k = 0; k < 6; k++)
				at[k] = c->added[i].at[k];
			f.at = reference_origin(at, at + 3);
			return f;
		}
	f = reference_frame_named(c->reference, name);
	ck_assert_msg(f.entry >= 0, "%s: no link or joint '%s' in the reference", c->what, name);
	return f;
}

/* The reference's columns in the places of what is modelled. */
static struct kin_matrix modelled(const struct kin_case *c, int lines, const wide *J)
{
	const struct tree *t = &c->analysis.tree;
	struct kin_matrix m = kin_matrix_new(lines, t->nv);

	for (int i = 0; i < t->joint_count; i++) {
		int from = kin_joint(c, t->joints[i].name)->iv;

		for (int k = 0; k < t->joints[i].nv; k++)
			for (int l = 0; l < lines; l++)
				m.x[l * t->nv + t->joints[i].iv + k] = J[l * c->reference->nv + from + k];
	}
	return m;
}

/* p and the quaternion of R with w > 0 (Shepperd 1978); what was found may be the other one. */
static void quaternion(const struct reference_pose *t, wide *u)
{
	const wide trace = t->m[0][0] + t->m[1][1] + t->m[2][2];
	int most = 3;
	wide largest = trace;

	for (int i = 0; i < 3; i++)
		if (t->m[i][i] > largest) {
			most = i;
			largest = t->m[i][i];
		}
	for (int i = 0; i < 3; i++) {
		const int j = (i + 1) % 3, k = (i + 2) % 3;

		if (most == 3)
			u[i] = t->m[k][j] - t->m[j][k];
		else
			u[i] = i == most ? 1 - trace + 2 * t->m[i][i] : t->m[i][most] + t->m[most][i];
	}
	const int j = (most + 1) % 3, k = (most + 2) % 3;
	wide square = 0;

	u[3] = most == 3 ? 1 + trace : t->m[k][j] - t->m[j][k];
	for (int i = 0; i < 4; i++)
		square += u[i] * u[i];
	for (int i = 0; i < 4; i++)
		u[i] /= wide_sqrt(square);
}

static struct kin_matrix expected_pose(struct kin_case *c, const struct reference_frame *f)
{
	const struct reference_pose t = reference_pose(c->reference, f, c->q);
	const int is_rows = c->analysis.request.pose == POSE_ROWS;
	struct kin_matrix m = is_rows ? kin_matrix_new(3, 4) : kin_matrix_new(7, 1);

	if (is_rows) {
		memcpy(m.x, t.m, 12 * sizeof(wide));
		return m;
	}
	for (int i = 0; i < 3; i++)
		m.x[i] = t.m[i][3];
	quaternion(&t, m.x + 3);
	return m;
}

enum reference_axes kin_axes(const struct kin_case *c)
{
	static const enum reference_axes axes[] = {[FRAME_LINK] = REFERENCE_LINK, [FRAME_WORLD] = REFERENCE_WORLD,
		[FRAME_WORLD_ALIGNED] = REFERENCE_ALIGNED};

	return axes[c->analysis.request.frame];
}

static struct kin_matrix expected_of_link(struct kin_case *c, const struct want *w)
{
	static const wide none[KIN_ROWS];
	const struct reference_frame f = kin_frame(c, strchr(w->word, '.') + 1);
	struct kin_matrix m = kin_matrix_new(6, 1), all;

	switch (w->kind) {
	case WANT_POSE:
		kin_matrix_free(&m);
		return expected_pose(c, &f);
	case WANT_JACOBIAN:
		kin_matrix_free(&m);
		all = kin_matrix_new(6, c->reference->nv);
		reference_jacobian(c->reference, &f, kin_axes(c), c->q, all.x);
		m = modelled(c, 6, all.x);
		kin_matrix_free(&all);
		return m;
	case WANT_DJACOBIAN:
		reference_acceleration(c->reference, &f, kin_axes(c), c->q, c->qd, none, m.x);
		return m;
	default:
		break;
	}
	m.lines = 0;
	return m;
}

static void times(const struct kin_case *c, int lines, const wide *J, wide *out)
{
	for (int i = 0; i < lines * c->reference->nv; i++)
		out[i / c->reference->nv] += J[i] * c->qd[i % c->reference->nv];
}

struct kin_matrix kin_expected(struct kin_case *c, const struct want *w)
{
	struct reference *r = c->reference;
	struct kin_matrix m, J = kin_matrix_new(6, r->nv);

	if (want_is(w->kind, OF_LINK) && w->kind != WANT_TWIST && w->kind != WANT_ACCEL) {
		kin_matrix_free(&J);
		return expected_of_link(c, w);
	}
	m = kin_matrix_new(w->kind == WANT_COM || w->kind == WANT_VCOM ? 3 : 6, 1);
	if (w->kind == WANT_COM)
		reference_com(r, c->held, c->q, m.x);
	else if (w->kind == WANT_VCOM || w->kind == WANT_COM_JACOBIAN)
		reference_com_jacobian(r, c->held, c->q, J.x);
	else if (w->kind == WANT_MOMENTUM || w->kind == WANT_MOMENTUM_MATRIX)
		reference_momentum_matrix(r, c->held, c->q, J.x);
	else if (w->kind == WANT_DMOMENTUM)
		reference_momentum_rate(r, c->held, c->q, c->qd, c->qdd, m.x);
	else
		m.lines = 0;
	if (w->kind == WANT_VCOM || w->kind == WANT_MOMENTUM)
		times(c, m.lines, J.x, m.x);
	if (w->kind == WANT_COM_JACOBIAN || w->kind == WANT_MOMENTUM_MATRIX) {
		kin_matrix_free(&m);
		m = modelled(c, w->kind == WANT_COM_JACOBIAN ? 3 : 6, J.x);
	}
	kin_matrix_free(&J);
	return m;
}
