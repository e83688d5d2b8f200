/* The generator's evaluator of expressions as a robot that can be launched. */
#include "core/failure.h"
#include "dag/eval.h"
#include "generate.h"
#include "passes/analysis.h"
#include "urdf.h"
#include <stdlib.h>
#include <string.h>

_Static_assert((int)DAG_ARGUMENTS == (int)RNEA_ARGUMENT_LIMIT, "a text takes no more arrays than a launch, and no fewer");

struct evaluation {
	struct analysis analysis;
	struct rneagen_error error;
	int in_floats;   /* arithmetic */
	int memory_is_f32, is_aos;
};

/* Rows of one sample, of all arrays after one another. */
struct sample {
	double *values, *rows[DAG_ARGUMENTS];
	float *narrow, *narrow_rows[DAG_ARGUMENTS];
};

static size_t place(const struct evaluation *v, const struct argument *a, size_t row, size_t sample, size_t count)
{
	if (a->per_batch)
		return row;
	return v->is_aos ? sample * (size_t)a->rows + row : row * count + sample;
}

static double get(const struct evaluation *v, const void *array, size_t at)
{
	return v->memory_is_f32 ? (double)((const float *)array)[at] : ((const double *)array)[at];
}

static void put(const struct evaluation *v, void *array, size_t at, double x)
{
	if (v->memory_is_f32)
		((float *)array)[at] = (float)x;
	else
		((double *)array)[at] = x;
}

static int sample_open(struct sample *s, const struct dag *d)
{
	size_t total = 0;

	for (int i = 0; i < d->argument_count; i++)
		total += (size_t)d->arguments[i].rows;
	s->values = calloc(total, sizeof *s->values);
	s->narrow = calloc(total, sizeof *s->narrow);
	for (int i = 0, at = 0; s->values && s->narrow && i < d->argument_count; at += d->arguments[i++].rows) {
		s->rows[i] = s->values + at;
		s->narrow_rows[i] = s->narrow + at;
	}
	return s->values && s->narrow;
}

static void gather(struct sample *s, const struct evaluation *v, void *const *arrays, size_t sample, size_t count)
{
	const struct dag *d = &v->analysis.dag;

	for (int i = 0; i < d->argument_count; i++)
		for (int r = 0; !d->arguments[i].is_output && r < d->arguments[i].rows; r++) {
			s->rows[i][r] = get(v, arrays[i], place(v, &d->arguments[i], (size_t)r, sample, count));
			s->narrow_rows[i][r] = (float)s->rows[i][r];
		}
}

static void scatter(const struct sample *s, const struct evaluation *v, void *const *arrays, size_t sample, size_t count)
{
	const struct dag *d = &v->analysis.dag;

	for (int i = 0; i < d->argument_count; i++)
		for (int r = 0; d->arguments[i].is_output && r < d->arguments[i].rows; r++)
			put(v, arrays[i], place(v, &d->arguments[i], (size_t)r, sample, count),
				v->in_floats ? (double)s->narrow_rows[i][r] : s->rows[i][r]);
}

static int evaluate(void *context, void *const *arrays, size_t count, size_t first, size_t end)
{
	const struct evaluation *v = context;
	const struct dag *d = &v->analysis.dag;
	struct sample s = {0};
	int done = sample_open(&s, d);

	for (size_t k = first; done && k < end; k++) {
		gather(&s, v, arrays, k, count);
		done = v->in_floats ? eval_f32(d, (const float *const *)s.narrow_rows, s.narrow_rows, NULL)
				    : eval_f64(d, (const double *const *)s.rows, s.rows, NULL);
		if (done)
			scatter(&s, v, arrays, k, count);
	}
	free(s.values);
	free(s.narrow);
	return done;
}

static void evaluation_close(void *context)
{
	struct evaluation *v = context;

	analysis_free(&v->analysis);
	free(v);
}

/* `source` is the text of the same options. */
static enum rnea_code open_evaluation(const char *source, const char *urdf, size_t length, const struct rneagen_options *g,
	const struct rnea_options *options, struct rnea_robot **robot, struct rnea_error *e)
{
	struct evaluation *v = calloc(1, sizeof *v);
	const struct rnea_evaluator evaluator = {.context = v, .evaluate = evaluate, .close = evaluation_close};

	if (!v)
		return rnea_error_memory(e);
	if (analysis_open(&v->analysis, urdf, length, g, &v->error)) {
		generate_refused(&v->error, e);
		free(v);
		return e->code;
	}
	if (rnea_open_evaluator(source, strlen(source), &evaluator, options, robot, e)) {
		evaluation_close(v);
		return e->code;
	}
	v->analysis.dag.angle = v->analysis.model.angle; /* as in the text: NAN beyond */
	v->memory_is_f32 = rnea_info(*robot)->precision == RNEA_F32;
	v->in_floats = !strcmp(rnea_info(*robot)->arithmetic, "f32");
	v->is_aos = rnea_info(*robot)->layout == RNEA_AOS;
	return RNEA_OK;
}

enum rnea_code rnea_evaluate_urdf(const char *urdf, size_t length, const struct rneagen_options *generate,
	const struct rnea_options *options, struct rnea_robot **robot, struct rnea_error *error)
{
	struct rneagen_options g = generate ? *generate : rneagen_options_default();
	struct rnea_error spare, *e = rnea_error_start(error, &spare);
	struct rneagen_result text;

	g.tell = 0;
	g.only = RNEAGEN_ONLY_MAIN;
	g.parts = 1;
	if (robot)
		*robot = NULL;
	if (!robot || !urdf)
		return rnea_error_set(e, RNEA_ARGUMENT, "there is no %s",
			robot ? "URDF (urdf is NULL)" : "place for the robot (robot is NULL)");
	if (generate_text(urdf, length, &g, &text, e))
		return e->code;
	open_evaluation(text.source, urdf, length, &g, options, robot, e);
	rneagen_result_free(&text);
	return e->code;
}
