#include "operations.h"
#include "passes/analysis.h"
#include "emit/emit.h"
#include "base/identifier.h"
#include "urdf/robot.h"
#include "dag/svec.h"

const char *const OPERATION_NAMES[OPERATION_COUNT] = {"cross_operator", "mxS", "vxIv"};

/* A twist: linear and angular part. */
struct motion {
	struct svec v, w;
};

static struct motion input_motion(struct dag *d)
{
	int v = dag_argument_of(d, (struct argument){.name = "v", .rows = 6, .role = ROLE_LINK_TWIST});

	dag_section(d, SECTION_OUT, 0); /* all of it is one section */
	return (struct motion){svec_input(d, v, 0), svec_input(d, v, 3)};
}

static void output_pair(struct dag *d, int argument, struct svec linear, struct svec angular)
{
	for (int i = 0; i < 3; i++)
		dag_output(d, argument, i, linear.x[i]);
	for (int i = 0; i < 3; i++)
		dag_output(d, argument, 3 + i, angular.x[i]);
}

/* The last body whose joint has an axis, or NULL. */
static const struct body *chosen(const struct tree *t)
{
	for (int i = t->body_count - 1; i >= 0; i--) {
		const struct body *k = &t->bodies[i];

		if (k->type == JOINT_REVOLUTE || k->type == JOINT_CONTINUOUS || k->type == JOINT_PRISMATIC)
			return k;
	}
	return NULL;
}

/* [u] at (row, column) of the 6x6 matrix */
static void put_cross(struct ref m[6][6], struct dag *d, struct svec u, int row, int column)
{
	for (int i = 0; i < 3; i++) {
		int j = (i + 1) % 3, k = (i + 2) % 3;

		m[row + k][column + j] = u.x[i];
		m[row + j][column + k] = dag_neg(d, u.x[i]);
	}
}

/* crm(v) = [[w], [v]; 0, [w]] */
static void build_cross_operator(struct dag *d, const struct tree *t, const struct request *request)
{
	struct motion x = input_motion(d);
	int crm = dag_argument(d, "crm", 36, 1);
	struct ref m[6][6] = {{{0}}}; /* node 0 is zero */

	(void)t;
	(void)request;
	put_cross(m, d, x.w, 0, 0);
	put_cross(m, d, x.v, 0, 3);
	put_cross(m, d, x.w, 3, 3);
	for (int i = 0; i < 36; i++)
		dag_output(d, crm, i, m[i / 6][i % 6]);
}

/* v x S qd: for an axis u that turns [v x u qd; w x u qd], for one that slides [w x u qd; 0] */
static void build_mxs(struct dag *d, const struct tree *t, const struct request *request)
{
	const struct body *k = chosen(t);
	struct motion x = input_motion(d);
	int qd = dag_argument_of(d, (struct argument){.name = "qd", .rows = 1, .role = ROLE_JOINT_VELOCITY});
	int a = dag_argument(d, "a", 6, 1);
	struct svec u, zero = {{{0}}};
	struct within axis[3];

	(void)request;
	if (!k) {
		d->failed = 1;
		return;
	}
	for (int i = 0; i < 3; i++)
		axis[i] = k->sign < 0 ? within_neg(k->frame.m[i][k->axis]) : k->frame.m[i][k->axis];
	u = svec_scale(d, dag_input(d, qd, 0), svec_const(d, axis));
	if (k->type == JOINT_PRISMATIC)
		output_pair(d, a, svec_cross(d, x.w, u), zero);
	else
		output_pair(d, a, svec_cross(d, x.v, u), svec_cross(d, x.w, u));
}

/* The rotational part of the inertia times w */
static struct svec inertia_times(struct dag *d, const struct inertia *I, struct svec w)
{
	struct smat m;

	for (int i = 0; i < 3; i++)
		for (int j = 0; j < 3; j++)
			m.m[i][j] = dag_within(d, I->I[inertia_index(i, j)]);
	return smat_mul(d, &m, w);
}

/* v x* I v, with p = m v + w x h and L = I w + h x v: [w x p; v x p + w x L]; v x p = v x (w x h), as v x v = 0.
   The inertia is that of the generator's frame of the body, which is turned in the URDF's. */
static void build_vxiv(struct dag *d, const struct tree *t, const struct request *request)
{
	const struct body *k = chosen(t);
	struct motion x = input_motion(d);
	int f = dag_argument(d, "f", 6, 1);
	struct svec h, v, w, wh, p, L, force, moment;
	struct smat A;

	(void)request;
	if (!k) {
		d->failed = 1;
		return;
	}
	A = smat_const(d, &k->frame);
	h = svec_const(d, k->inertia.h);
	v = smat_mul_transposed(d, &A, x.v);
	w = smat_mul_transposed(d, &A, x.w);
	wh = svec_cross(d, w, h);
	p = svec_add(d, svec_scale(d, dag_within(d, k->inertia.mass), v), wh);
	L = svec_add(d, inertia_times(d, &k->inertia, w), svec_cross(d, h, v));
	force = svec_cross(d, w, p);
	moment = svec_add(d, svec_cross(d, v, wh), svec_cross(d, w, L));
	output_pair(d, f, smat_mul(d, &A, force), smat_mul(d, &A, moment));
}

/* The runtime starts what a text calls rnea. */
static const struct algorithm OPERATIONS[OPERATION_COUNT] = {
	[OPERATION_CROSS_OPERATOR] = {.name = "rnea",
		.doc = "The motion cross operator: v[6], linear then angular, -> crm[36], row by row.",
		.build = build_cross_operator},
	[OPERATION_MXS] = {.name = "rnea",
		.doc = "v[6] x S qd[1] -> a[6], linear then angular; S is the joint's axis.",
		.build = build_mxs},
	[OPERATION_VXIV] = {.name = "rnea",
		.doc = "v[6] x* I v -> f[6], linear then angular; I is the body's inertia.",
		.build = build_vxiv},
};

static const char *banner(const struct emission *e, const struct body *k, enum operation operation)
{
	struct operation_count n = plan_operations(&emit_main(e)->plan);
	struct text t;

	text_init(&t, e->arena);
	text_printf(&t, "/* The operation %s of \"", OPERATION_NAMES[operation]);
	text_put_comment(&t, e->tree->robot);
	text_put(&t, "\", at link \"");
	text_put_comment(&t, k->link);
	text_printf(&t, "\", in its frame: tests/bench/six with rneagen " RNEAGEN_VERSION ".\n"
		" * %u mul, %u add, %u sub, %u neg, %u fma. Batches: every array is [%s]. */", n.mul, n.add, n.sub, n.neg, n.fma,
		e->options->layout == RNEAGEN_SOA ? "row][sample" : "sample][row");
	return text_string(&t);
}

static const char *text_name(const char *robot, enum operation operation, struct arena *a)
{
	struct text t;

	text_init(&t, a);
	text_printf(&t, "%s_%s", robot, OPERATION_NAMES[operation]);
	return text_string(&t);
}

/* The DAG's plan; its inputs are no joint's. */
static enum rneagen_code make_pass(
	struct function *p, const struct tree *t, const struct request *k, struct arena *a, struct rneagen_error *e)
{
	struct dag raw;

	dag_init(&raw, a);
	p->algorithm->build(&raw, t, k);
	dag_init(&p->dag, a);
	dag_fuse(&p->dag, &raw, 0);
	return plan_build(&p->plan, &p->dag, t, a) ? RNEAGEN_OK : error_memory(e);
}

static enum rneagen_code emit(struct tree *t, const struct request *k, enum operation operation,
	struct rneagen_options *o, struct arena *a, const char **text, struct rneagen_error *e)
{
	struct function pass = {.algorithm = &OPERATIONS[operation]};
	struct emission emission = {
		.tree = t, .request = k, .options = o, .functions = &pass, .function_count = 1,
		.kernels = kernels_plain(o), .arena = a, .error = e};
	struct text source;

	t->joint_count = t->mimic_count = 0;
	if (make_pass(&pass, t, k, a, e))
		return e->code;
	emission.banner = banner(&emission, chosen(t), operation);
	emit_set_precision(&emission);
	text_init(&source, a);
	emit_source(&emission, &source);
	*text = text_string(&source);
	return source.failed ? error_memory(e) : e->code;
}

enum rneagen_code operation_text(const char *urdf, size_t length, enum operation operation,
	const struct rneagen_options *options, struct arena *a, const char **text, struct rneagen_error *e)
{
	struct rneagen_options o = *options;
	struct analysis x = {.urdf = urdf, .length = length, .options = *options, .arena = a, .error = e};

	o.trig = RNEAGEN_BOUNDED; /* there are no angles */
	o.strict = o.bounded = 0;
	if (analysis_run(&x, PASS_URDF_READ, PASS_REQUEST_RESOLVE))
		return e->code;
	if (!chosen(&x.tree))
		return error_set(e, RNEAGEN_NO_JOINTS, "%s: no joint has an axis: take a robot with one that turns or slides",
			o.file);
	o.name = text_name(o.name ? o.name : identifier_from(x.robot.name, a), operation, a);
	return emit(&x.tree, &x.request, operation, &o, a, text, e);
}
