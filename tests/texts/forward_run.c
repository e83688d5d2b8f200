#include "forward_run.h"
#include "support/rng.h"
#include <check.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* More than one block, and a last one that is not full; so many states, in turn, and the one with large angles. */
enum { COUNT = 150, STATES = 7, LARGE = 2, LARGEST = 35 * 35 };

struct arrays {
	void *at[DAG_ARGUMENTS];                          /* as the text has them */
	double in[DAG_ARGUMENTS][LARGEST], out[DAG_ARGUMENTS][LARGEST];
	double expected[DAG_ARGUMENTS][STATES][LARGEST], allowed[DAG_ARGUMENTS][STATES][LARGEST];
};

static void draw(const struct scene_model *m, double largest_angle, struct rng *rng, int state, struct arrays *x)
{
	const struct dag *d = &m->dag;

	for (int k = 0; k < d->argument_count; k++)
		for (int i = 0; i < d->arguments[k].rows && (!state || !d->arguments[k].per_batch) &&
			!d->arguments[k].is_output; i++)
			x->in[k][i] = (double)(float)(rng_uniform(rng, -1, 1) + (d->arguments[k].role == ROLE_LINK_MASS ? 2 : 0));
	for (int i = 0; i < m->tree.nq && state == LARGE; i++)
		x->in[0][i] = (double)(float)(x->in[0][i] * largest_angle);
	for (int j = 0; j < m->tree.joint_count; j++) {
		double *u = x->in[0] + m->tree.joints[j].iq + 3, size = 0;

		for (int i = 0; i < 4 && m->tree.joints[j].nq == 7; i++)
			size += u[i] * u[i];
		for (int i = 0; i < 4 && m->tree.joints[j].nq == 7; i++)
			u[i] = (double)(float)(u[i] / sqrt(size));
	}
}

/* What the text computes, within twice the evaluator's own bound. */
static void expect(const struct dag *d, const struct rneagen_options *o, int sample, struct arrays *x)
{
	static float in_f32[DAG_ARGUMENTS][LARGEST], out_f32[DAG_ARGUMENTS][LARGEST];
	static double bound[DAG_ARGUMENTS * LARGEST];
	const double *in[DAG_ARGUMENTS] = {0};
	double *out[DAG_ARGUMENTS] = {0}, more = o->precision == RNEAGEN_F32X2 ? 64 : o->trig == RNEAGEN_FAST ? 16 : 2;
	const float *ins[DAG_ARGUMENTS] = {0};
	float *outs[DAG_ARGUMENTS] = {0};
	int is_f32 = o->precision == RNEAGEN_F32;

	for (int k = 0; k < d->argument_count; k++) {
		for (int i = 0; i < d->arguments[k].rows; i++)
			in_f32[k][i] = (float)x->in[k][i];
		in[k] = d->arguments[k].is_output ? NULL : x->in[k];
		ins[k] = d->arguments[k].is_output ? NULL : in_f32[k];
		out[k] = d->arguments[k].is_output ? x->out[k] : NULL;
		outs[k] = d->arguments[k].is_output ? out_f32[k] : NULL;
	}
	ck_assert(is_f32 ? eval_f32(d, ins, outs, &(struct eval_terms){.bound = bound})
			 : eval_f64(d, in, out, &(struct eval_terms){.bound = bound}));
	for (size_t i = 0; i < d->output_count; i++) {
		int k = d->outputs[i].argument, row = d->outputs[i].row;
		double value = is_f32 ? (double)out_f32[k][row] : x->out[k][row];

		ck_assert_msg(isfinite(value), "%s[%d] is %g", d->arguments[k].name, row, value);
		x->expected[k][sample][row] = value;
		x->allowed[k][sample][row] = more * bound[i] + (o->precision == RNEAGEN_MIXED ? fabs(value) * 0x1p-23 : 0);
	}
}

static size_t place(const struct rnea_info *info, int k, int rows, int sample, int row)
{
	return (size_t)(info->arguments[k].per_batch ? row : info->layout == RNEA_AOS ? sample * rows + row
		: row * COUNT + sample);
}

static void put(const struct scene_model *m, const struct rnea_info *info, int sample, struct arrays *x)
{
	for (int k = 0; k < m->dag.argument_count; k++)
		for (int i = 0; i < m->dag.arguments[k].rows && !m->dag.arguments[k].is_output; i++) {
			size_t at = place(info, k, m->dag.arguments[k].rows, sample, i);

			if (info->precision == RNEA_F64)
				((double *)x->at[k])[at] = x->in[k][i];
			else
				((float *)x->at[k])[at] = (float)x->in[k][i];
		}
}

static void fill(const struct scene_model *m, const struct rneagen_options *o, const struct rnea_info *info, double largest_angle,
	uint64_t seed, struct arrays *x)
{
	struct rng rng = rng_seed(seed);

	ck_assert_int_eq((int)(info->input_count + info->output_count), m->dag.argument_count);
	for (int k = 0; k < m->dag.argument_count; k++) {
		ck_assert_str_eq(info->arguments[k].name, m->dag.arguments[k].name);
		ck_assert_int_le(m->dag.arguments[k].rows, LARGEST);
		x->at[k] = malloc((size_t)(COUNT * m->dag.arguments[k].rows) * sizeof(double));
		/* nan: what no text writes is seen */
		memset(x->at[k], 0xff, (size_t)(COUNT * m->dag.arguments[k].rows) * sizeof(double));
	}
	for (int state = 0; state < STATES; state++) {
		draw(m, largest_angle, &rng, state, x);
		expect(&m->dag, o, state, x);
		for (int s = state; s < COUNT; s += STATES)
			put(m, info, s, x);
	}
}

static void compare(const struct dag *d, const struct rnea_info *info, const struct arrays *x, const char *what)
{
	for (int k = 0; k < d->argument_count; k++)
		for (int i = 0; i < d->arguments[k].rows && d->arguments[k].is_output; i++)
			for (int s = 0; s < COUNT; s++) {
				size_t at = place(info, k, d->arguments[k].rows, s, i);
				double got = info->precision == RNEA_F64 ? ((double *)x->at[k])[at]
					: (double)((float *)x->at[k])[at];

				ck_assert_msg(fabs(got - x->expected[k][s % STATES][i]) <= x->allowed[k][s % STATES][i],
					"%s: %s[%d] of sample %d: %.17g, not %.17g (%.3g)", what, d->arguments[k].name,
					i, s, got, x->expected[k][s % STATES][i], x->allowed[k][s % STATES][i]);
			}
}

void forward_run_as(const struct scene_model *m, const struct rneagen_options *o, const struct target *t, struct rnea_options how,
	double largest_angle, uint64_t seed)
{
	struct arrays *x = calloc(1, sizeof *x);
	struct rnea_robot *robot;
	struct rnea_error e;

	ck_assert(x != NULL);
	ck_assert_msg(!rnea_open(t->text.source, strlen(t->text.source), &how, &robot, &e), "%s: %s", t->what, e.message);
	fill(m, o, rnea_info(robot), largest_angle, seed, x);
	ck_assert_msg(!rnea_run(robot, x->at, COUNT, &e), "%s: %s", t->what, e.message);
	compare(&m->dag, rnea_info(robot), x, t->what);
	for (int k = 0; k < m->dag.argument_count; k++)
		free(x->at[k]);
	free(x);
	rnea_close(robot);
}

void forward_run(const struct scene_model *m, const struct rneagen_options *o, const struct target *t, enum rnea_backend backend,
	double largest_angle, uint64_t seed)
{
	static const char *const as_calls[] = {"-Dalways_inline=unused"}; /* in line, pairs of floats take a compiler long */
	size_t is_pair = o->precision == RNEAGEN_F32X2 && backend == RNEA_BACKEND_HOST;
	struct rnea_options how = {.backend = backend, .cache = "", .compile = as_calls, .compile_count = is_pair};

	forward_run_as(m, o, t, how, largest_angle, seed);
}
