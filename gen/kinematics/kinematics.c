/* Poses on the way out: R = R_p X R(q), p = p_p + R_p x (Featherstone 2008, 4.1; Craig 2.45). */
#include "kinematics/centroid.h"
#include <string.h>

/* A R(q), R(q) the joint's variable turn: row by row, (R' a)' */
static struct smat turned(struct dag *d, const struct body *k, const struct joint_pose *at, const struct smat *A)
{
	struct smat out;

	if (k->type == JOINT_FLOATING)
		return smat_product(d, A, &at->Q);
	for (int i = 0; i < 3; i++)
		smat_set_row(&out, i, joint_into(d, k, at, smat_row(A, i)));
	return out;
}

static void place(const struct kinematics *x, int body)
{
	struct dag *d = x->d;
	const struct body *k = &x->t->bodies[body];
	struct placed *to = &x->bodies[body];
	const struct placed *from = k->parent >= 0 ? &x->bodies[k->parent] : NULL;

	dag_section(d, SECTION_PLACE, body);
	to->pose = joint_place(d, k, x->in);
	to->is_unit = k->type != JOINT_FLOATING && (!from || from->is_unit);
	to->A = from ? smat_product(d, &from->R, &to->pose.R) : to->pose.R;
	if (x->k->pose == POSE_QUATERNION)
		quaternion_place(x, body);
	to->R = x->in.by_halves && to->is_unit ? quaternion_turn(x, body) : turned(d, k, &to->pose, &to->A);
	to->step = svec_add(d, kinematics_from_point(x, k->parent, x->points[body].offset), to->pose.slide);
	to->from = from ? from->from : to->step;
	if (from)
		to->point = svec_add(d, from->point, smat_mul(d, &from->R, to->step));
	to->p = svec_add(d, to->point, smat_mul(d, &to->R, kinematics_from_point(x, body, (struct within[3]){{0}})));
	for (int j = 0; j < 3; j++)
		svec_tag(d, smat_column(&to->R, j), (const char *[]){"rx", "ry", "rz"}[j], k->number);
	svec_tag(d, to->point, "p", k->number);
}

void kinematics_frame(const struct kinematics *x, int body, const struct placement *X, struct smat *R, struct svec *p)
{
	const struct placed *at = &x->bodies[body];
	struct smat turn = smat_const(x->d, &X->R);

	*R = smat_product(x->d, &at->R, &turn);
	*p = svec_add(x->d, at->point, smat_mul(x->d, &at->R, kinematics_from_point(x, body, X->p)));
}

/* Is the Jacobian of the same frame wanted, so that the way back is there? */
static int has_jacobian_in_link(const struct request *k, const struct want *w)
{
	for (int i = 0; i < k->want_count && k->frame == FRAME_LINK; i++)
		if (k->wants[i].kind == WANT_JACOBIAN && !strcmp(strchr(k->wants[i].word, '.'), strchr(w->word, '.')))
			return 1;
	return 0;
}

static void output_pose(const struct kinematics *x, const struct want *w, int argument)
{
	struct dag *d = x->d;
	struct smat R;
	struct svec p;
	struct ref quaternion[4];

	if (has_jacobian_in_link(x->k, w))
		jacobian_frame(x, w, &R, &p);
	else
		kinematics_frame(x, w->body, &w->X, &R, &p);
	p = svec_add(d, x->bodies[w->body].from, p);
	if (x->k->pose == POSE_QUATERNION)
		quaternion_of(x, w->body, &w->X, quaternion);
	for (int i = 0; i < 3; i++)
		for (int j = 0; j < 3 && x->k->pose == POSE_ROWS; j++)
			dag_output(d, argument, 4 * i + j, R.m[i][j]);
	for (int i = 0; i < 3; i++)
		dag_output(d, argument, x->k->pose == POSE_ROWS ? 4 * i + 3 : i, p.x[i]);
	for (int i = 0; i < 4 && x->k->pose == POSE_QUATERNION; i++)
		dag_output(d, argument, 3 + i, quaternion[i]);
}

static void output_jacobian(const struct kinematics *x, const struct want *w, int argument)
{
	int nv = x->t->nv;
	struct ref *J = arena_alloc(x->d->arena, 6 * (size_t)nv, sizeof *J);
	struct pattern p;

	if (!J || !request_pattern(&p, x->t, w, x->k->dense, x->d->arena)) {
		x->d->failed = 1;
		return;
	}
	dag_section(x->d, SECTION_JACOBIAN, w->body);
	jacobian_columns(x, w, J);
	for (int e = 0; e < 6 * nv; e++)
		if (p.row[e] >= 0)
			dag_output(x->d, argument, p.row[e], J[e]);
}

static void output_links(const struct kinematics *x, int body)
{
	for (int i = 0; i < x->k->want_count; i++)
		if (x->k->wants[i].kind == WANT_POSE && x->k->wants[i].body == body)
			output_pose(x, &x->k->wants[i], x->outputs[i]);
	for (int i = 0; i < x->k->want_count; i++)
		if (x->k->wants[i].kind == WANT_JACOBIAN && x->k->wants[i].body == body)
			output_jacobian(x, &x->k->wants[i], x->outputs[i]);
}

/* A tour of the tree, as that of tour.h: out to a body, through its children, back from it. */
void kinematics_run(struct kinematics *x)
{
	const struct body *bodies = x->t->bodies;
	struct centroid c;
	int here = -1;

	x->bodies = arena_alloc(x->d->arena, (size_t)x->t->body_count, sizeof *x->bodies);
	if (!x->bodies || !kinematics_slide(x)) {
		x->d->failed = 1;
		return;
	}
	centroid_begin(&c, x);
	for (int k = 0; k < x->t->body_count; here = k++) {
		for (; here != bodies[k].parent; here = bodies[here].parent)
			centroid_leave(&c, here);
		place(x, k);
		output_links(x, k);
		centroid_enter(&c, k);
	}
	for (; here >= 0; here = bodies[here].parent)
		centroid_leave(&c, here);
	centroid_end(&c);
}
