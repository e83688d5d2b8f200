/* What one variant computes wrong, and how long it takes. */
#include "emit/number_type.h"
#include "prove/prove_errors.h"
#include "rnearun/signature.h"
#include "study/study.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* ---- arrays ---- */

/* One for each argument of the DAG. */
struct arrays {
	void *data[DAG_ARGUMENTS];
	size_t rows[DAG_ARGUMENTS], count;
	int f32, aos;
};

static size_t place(const struct arrays *a, int i, size_t row, size_t sample)
{
	return a->aos ? sample * a->rows[i] + row : row * a->count + sample;
}

static void put(struct arrays *a, int i, size_t at, double x)
{
	if (a->f32)
		((float *)a->data[i])[at] = (float)x;
	else
		((double *)a->data[i])[at] = x;
}

static void arrays_free(struct arrays *a)
{
	for (int i = 0; i < DAG_ARGUMENTS; i++)
		free(a->data[i]);
}

/* The first `period` bytes again and again. */
static void repeat(char *bytes, size_t period, size_t size)
{
	for (size_t done = period; done < size; done += done)
		memcpy(bytes + done, bytes, done < size - done ? done : size - done);
}

/* An input's numbers: the samples', again and again, or those of the whole batch. */
static void fill(struct arrays *a, const struct judge *j, const struct argument *from, int i)
{
	size_t rows = a->rows[i], count = from->per_batch ? 1 : a->count, drawn = count < j->count ? count : j->count;
	size_t size = a->f32 ? sizeof(float) : sizeof(double);

	for (size_t k = 0; k < drawn; k++) {
		const double *x = draw_rows(&j->inputs, from, k);

		for (size_t r = 0; r < rows; r++)
			put(a, i, from->per_batch ? r : place(a, i, r, k), x[r]);
	}
	if (a->aos)
		repeat(a->data[i], drawn * rows * size, count * rows * size);
	for (size_t r = 0; !a->aos && !from->per_batch && r < rows; r++)
		repeat((char *)a->data[i] + r * count * size, drawn * size, count * size);
}

/* `count` samples; outputs are zero, and take no memory before they are written. Returns 0 when memory runs out. */
static int arrays_fill(struct arrays *a, const struct judge *j, const struct dag *d, enum rneagen_layout layout, size_t count)
{
	*a = (struct arrays){.count = count, .f32 = judge_is_f32(j->precision), .aos = layout == RNEAGEN_AOS};
	for (int i = 0; i < d->argument_count; i++) {
		const struct argument *x = &d->arguments[i];

		a->rows[i] = (size_t)x->rows;
		a->data[i] = calloc(x->per_batch ? 1 : count, a->rows[i] * (a->f32 ? sizeof(float) : sizeof(double)));
		if (!a->data[i]) {
			arrays_free(a);
			return 0;
		}
		if (!x->is_output)
			fill(a, j, x, i);
	}
	return 1;
}

/* All outputs of the judge's samples, [sample][row] one array after another. */
static void arrays_gather(const struct arrays *a, const struct judge *j, double *out)
{
	for (int i = 0; i < j->output_count; i++) {
		const struct judge_output *o = &j->outputs[i];

		for (size_t k = 0; k < j->count; k++)
			for (size_t r = 0; r < o->rows; r++) {
				size_t at = place(a, o->argument, r, k);
				const void *from = a->data[o->argument];

				out[k * j->rows + o->first + r] = a->f32 ? (double)((const float *)from)[at]
					: ((const double *)from)[at];
			}
	}
}

/* The errors of these outputs. Returns 0 when memory runs out. */
static int judge_arrays(const struct judge *j, const struct arrays *a, struct judge_errors *errors)
{
	double *out = calloc(j->count, j->rows * sizeof *out);

	if (!out)
		return 0;
	arrays_gather(a, j, out);
	*errors = judge_results(j, out);
	free(out);
	return 1;
}

/* ---- one variant ---- */

static const struct study_backend *backend_of(const struct study *s, const struct study_row *row)
{
	const struct study_backend *b = s->backends;

	while (b->backend != row->backend)
		b++;
	return b;
}

static enum rneagen_code open_robot(struct study *s, const struct study_row *row, struct rnea_robot **robot)
{
	struct rneagen_options g = study_generate(s, row);
	struct rnea_options o = study_open_options(s, row->backend);
	struct rneagen_result text;
	struct rnea_error e = {0};

	if (rneagen_generate(s->urdf.bytes, s->urdf.length, &g, &text, &s->error))
		return s->error.code;
	if (rnea_open(text.source, strlen(text.source), &o, robot, &e))
		study_fail(s, &e);
	else if (!signature_fits(&s->analysis.dag, rnea_info(*robot)))
		error_set(&s->error, RNEAGEN_UNSUPPORTED, "%s: takes other arrays than its analysis", text.name);
	rneagen_result_free(&text);
	return s->error.code;
}

static enum rneagen_code measure_errors(struct study *s, const struct rnea_robot *robot, struct study_row *row)
{
	const struct judge *j = study_judge(s, row->precision);
	struct arrays a;
	struct rnea_error e = {0};

	if (!j || !arrays_fill(&a, j, &s->analysis.dag, row->layout, j->count))
		return error_memory(&s->error);
	if (rnea_run(robot, a.data, a.count, &e))
		study_fail(s, &e);
	else if (!judge_arrays(j, &a, &row->errors))
		error_memory(&s->error);
	row->model_change = s->model_change;
	arrays_free(&a);
	return s->error.code;
}

static void note_resources(const struct rnea_robot *robot, struct study_row *row)
{
	struct rnea_resources r;

	row->compile_ms = rnea_build(robot)->seconds * 1e3;
	row->registers = -1;
	if (row->backend != RNEA_BACKEND_CUDA || rnea_resources(robot, rnea_info(robot)->functions->name, &r, NULL))
		return;
	row->registers = r.registers;
	row->spill_bytes = r.local_bytes;
	row->parts = rnea_info(robot)->parts;
}

enum rneagen_code study_build(struct study *s, struct study_row *row, struct rnea_robot **robot)
{
	*robot = NULL;
	if (!open_robot(s, row, robot) && !measure_errors(s, *robot, row))
		note_resources(*robot, row);
	if (s->error.code) {
		rnea_close(*robot);
		*robot = NULL;
	}
	return s->error.code;
}

/* What was timed may be another kernel than that which the errors are of: a large batch's. */
static int judge_timed(const struct judge *j, const struct arrays *a, struct judge_errors *errors)
{
	struct judge_errors timed;

	if (!judge_arrays(j, a, &timed))
		return 0;
	errors->max = fmax(errors->max, timed.max);
	errors->rms = fmax(errors->rms, timed.rms);
	errors->terms = fmax(errors->terms, timed.terms);
	return 1;
}

enum rneagen_code study_time(struct study *s, const struct rnea_robot *robot, struct study_row *row, size_t batch)
{
	const struct study_backend *b = backend_of(s, row);
	const struct rnea_robot *floor = b->floors[judge_is_f32(row->precision) ? RNEA_F32 : RNEA_F64];
	const struct judge *j = study_judge(s, row->precision);
	struct bench_time t = {0};
	struct rnea_error e = {0};
	size_t back = j && batch >= j->count ? j->count : 0;
	struct arrays a;

	if (!j || !arrays_fill(&a, j, &s->analysis.dag, row->layout, batch))
		return error_set(&s->error, RNEAGEN_MEMORY, "no memory for %zu samples; choose a smaller --batch", batch);
	if (bench_measure(b->bench, robot, floor, a.data, batch, back, &t, &e))
		study_fail(s, &e);
	row->batch = batch;
	row->ns = t.ns;
	row->least = t.least;
	row->spread = t.spread;
	row->floor_ratio = t.floor / t.ns;
	if (back && !s->error.code && !judge_timed(j, &a, &row->errors))
		error_memory(&s->error);
	arrays_free(&a);
	return s->error.code;
}

/* ---- what is proved ---- */

static struct eval_model model_of(const struct study *s, const struct study_row *row)
{
	struct rneagen_options g = study_generate(s, row);

	return eval_model_of(&g, row->backend == RNEA_BACKEND_CUDA);
}

/* Of one precision: what else differs in the arithmetic of two texts. */
static int is_same(const struct eval_model *a, const struct eval_model *b)
{
	return a->fused == b->fused && a->angle == b->angle && a->sincos == b->sincos && a->sine == b->sine &&
		a->cosine == b->cosine;
}

/* bounds: of this model, every `stride`th. */
static double proved_of(const struct judge *j, const struct dag *d, const double *bounds, size_t stride)
{
	double worst = 0;

	for (int o = 0; o < j->output_count; o++) {
		double norm = 0, scale = judge_scale(j, &j->outputs[o]);

		for (size_t i = 0; i < d->output_count; i++)
			if (d->outputs[i].argument == j->outputs[o].argument)
				norm = hypot(norm, bounds[i * stride]);
		worst = norm > 0 ? fmax(worst, norm / scale * (1 + 0x1p-40)) : worst;
	}
	return isfinite(worst) ? worst : (double)NAN;
}

enum rneagen_code study_prove(struct study *s, double seconds)
{
	const struct dag *d = &s->analysis.dag;
	size_t variants = (size_t)s->variant_count;
	struct eval_model *models = calloc(variants + 1, sizeof *models);
	int *of = calloc(variants + 1, sizeof *of), count = 0;
	double *bounds = calloc(d->output_count * variants + 1, sizeof *bounds);

	for (int i = 0; models && of && i < s->variant_count; i++) {
		struct eval_model m = model_of(s, &s->variants[i]);

		of[i] = count;
		for (int k = 0; k < i; k++)
			if (s->variants[k].precision == s->variants[i].precision && is_same(&m, &models[of[k]]))
				of[i] = of[k];
		models[of[i]] = m;
		count += of[i] == count;
	}
	if (!models || !of || !bounds)
		error_memory(&s->error);
	else if (!prove_errors(bounds, &s->analysis, models, count, s->command->open.threads, seconds, &s->error))
		for (int i = 0; i < s->variant_count; i++) {
			const struct judge *j = study_judge(s, s->variants[i].precision);

			s->variants[i].proved = j ? proved_of(j, d, bounds + of[i], (size_t)count) : (error_memory(&s->error), 0);
		}
	free(models);
	free(of);
	free(bounds);
	return s->error.code;
}
