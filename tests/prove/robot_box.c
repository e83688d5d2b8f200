#include "prove/robot_box.h"
#include "dag/eval.h"
#include "support/read.h"
#include <check.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

/* The elbow turns as the shoulder does. Takes the text, and returns it longer. */
static char *follow(char *urdf)
{
	static const char joint[] = "<joint name=\"elbow\"", mimic[] = "<mimic joint=\"shoulder\"/>";
	size_t length = strlen(urdf);
	char *longer = realloc(urdf, length + sizeof mimic), *at = longer ? strstr(longer, joint) : NULL;

	ck_assert(at && (at = strchr(at, '>')));
	memmove(at + sizeof mimic, at + 1, strlen(at));
	memcpy(at + 1, mimic, sizeof mimic - 1);
	return longer;
}

void robot_box_open(struct robot_box *x, const char *name, const char *scene, double gravity)
{
	static const char floats[] = "floating:";
	static const char follows[] = "mimic:";
	int is_floating = !strncmp(name, floats, sizeof floats - 1), is_mimic = !strncmp(name, follows, sizeof follows - 1);

	name += is_floating ? sizeof floats - 1 : is_mimic ? sizeof follows - 1 : 0;
	*x = (struct robot_box){.urdf = robot_text(name), .options = rneagen_options_default()};
	if (is_mimic)
		x->urdf = follow(x->urdf);
	x->options.file = name;
	x->options.base = is_floating ? RNEAGEN_FLOATING : RNEAGEN_FIXED;
	x->options.scene = scene;
	if (gravity > 0)
		x->options.gravity[2] = -gravity;
	arena_init(&x->arena, NULL);
	ck_assert_msg(!analysis_open(&x->analysis, x->urdf, strlen(x->urdf), &x->options, &x->error), "%s", x->error.message);
	ck_assert_msg(!box_make(&x->box, &x->analysis, &x->arena, &x->error), "%s", x->error.message);
	for (int i = 0; i < x->analysis.dag.argument_count; i++) {
		size_t rows = (size_t)x->analysis.dag.arguments[i].rows;

		x->in[i] = x->out[i] = NULL;
		if (x->analysis.dag.arguments[i].is_output)
			x->out[i] = arena_alloc(&x->arena, rows, sizeof(double));
		else
			x->in[i] = arena_alloc(&x->arena, rows, sizeof(double));
		x->exact[i] = arena_alloc(&x->arena, rows + 1, sizeof(__float128));
	}
	ck_assert(!x->arena.failed);
}

void robot_box_close(struct robot_box *x)
{
	analysis_free(&x->analysis);
	arena_free(&x->arena);
	free(x->urdf);
}

static double draw(struct rng *r, struct interval range, int is_corner, int is_float)
{
	double x = is_corner ? (rng_chance(r, 0.5) ? range.upper : range.lower) : rng_uniform(r, range.lower, range.upper);
	double y = (double)(float)x;

	if (is_float && y > range.upper)
		y = (double)nextafterf((float)y, -INFINITY);
	if (is_float && y < range.lower)
		y = (double)nextafterf((float)y, INFINITY);
	return is_float ? y : fmin(range.upper, x);
}

/* Quaternions are of length 1, as nearly as their numbers can be. */
static void settle(struct robot_box *x, int is_float)
{
	int position = dag_find_role(&x->analysis.dag, ROLE_JOINT_POSITION, 0);

	for (int i = 0; i < x->analysis.tree.joint_count && position >= 0; i++) {
		const struct tree_joint *j = &x->analysis.tree.joints[i];
		double *q = x->in[position] + j->iq + 3, size = 0;

		for (int k = 0; k < 4 && j->type == JOINT_FLOATING; k++)
			size += q[k] * q[k];
		for (int k = 0; k < 4 && j->type == JOINT_FLOATING; k++) {
			q[k] = size > 1e-6 ? q[k] / sqrt(size) : k == 3;
			q[k] = is_float ? (double)(float)q[k] : q[k];
		}
	}
}

void robot_box_draw(struct robot_box *x, struct rng *r, int is_float, double wider)
{
	int corners = rng_below(r, 3);

	for (int i = 0; i < x->analysis.dag.argument_count; i++)
		for (int k = 0; x->in[i] && k < x->analysis.dag.arguments[i].rows; k++) {
			int is_position = x->analysis.dag.arguments[i].role == ROLE_JOINT_POSITION;
			struct interval range = x->box.rows[i][k];
			double more = wider * (range.upper - range.lower);

			x->in[i][k] = 0;
			if (range.lower <= range.upper)
				x->in[i][k] = draw(r, (struct interval){range.lower - more, range.upper + more}, corners > is_position, is_float);
		}
	settle(x, is_float);
}

void robot_box_evaluate(struct robot_box *x)
{
	__float128 *in = calloc(DAG_ARGUMENTS * 256, sizeof *in);
	const __float128 *rows[DAG_ARGUMENTS] = {NULL};

	for (int i = 0; i < x->analysis.dag.argument_count; i++) {
		rows[i] = in + 256 * i;
		for (int k = 0; x->in[i] && k < x->analysis.dag.arguments[i].rows; k++)
			in[256 * i + k] = (__float128)x->in[i][k];
	}
	ck_assert(eval_quad(&x->analysis.dag, rows, x->exact, NULL));
	free(in);
}

double robot_box_value(const struct robot_box *x, size_t output)
{
	const struct output *o = &x->analysis.dag.outputs[output];

	return (double)x->exact[o->argument][o->row];
}

double robot_box_polynomial(const struct field *f, const double *c, const double *x)
{
	const double *v = x + f->drive_count;
	double sum = c[0];

	for (int i = 0; i < f->drive_count; i++)
		sum += c[1 + i] * x[i];
	for (int j = 0; j < f->rate_count; j++) {
		double slope = c[1 + f->drive_count + j];

		for (int k = j; k < f->rate_count; k++)
			slope += c[field_pair(f, j, k)] * v[k];
		sum += slope * v[j];
	}
	return sum;
}

double robot_box_error(struct robot_box *x, size_t output, int is_float)
{
	const struct output *o = &x->analysis.dag.outputs[output];
	float *in = calloc(DAG_ARGUMENTS * 512, sizeof *in), *rows[DAG_ARGUMENTS], *out[DAG_ARGUMENTS];
	double value;

	for (int i = 0; i < x->analysis.dag.argument_count; i++) {
		rows[i] = in + 256 * i;
		out[i] = in + 256 * (DAG_ARGUMENTS + i);
		for (int k = 0; x->in[i] && k < x->analysis.dag.arguments[i].rows; k++)
			rows[i][k] = (float)x->in[i][k];
	}
	if (is_float)
		ck_assert(eval_f32(&x->analysis.dag, (const float *const *)rows, out, NULL));
	else
		ck_assert(eval_f64(&x->analysis.dag, (const double *const *)x->in, x->out, NULL));
	value = is_float ? (double)out[o->argument][o->row] : x->out[o->argument][o->row];
	free(in);
	return fabs((double)((__float128)value - x->exact[o->argument][o->row]));
}

struct effort robot_box_effort(void)
{
	struct effort e = {workers_open(2), 2, (double)INFINITY, NULL};

	ck_assert_ptr_nonnull(e.workers);
	return e;
}
