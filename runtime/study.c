#define _POSIX_C_SOURCE 200809L
#include "study.h"
#include "effect.h"
#include "floor.h"
#include "signature.h"
#include "urdf.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- opening ---- */

static enum rneagen_code fail_runtime(struct study *s, const struct rnea_error *e)
{
	return error_set(&s->error, e->code == RNEA_MEMORY ? RNEAGEN_MEMORY : RNEAGEN_UNSUPPORTED, "%s", e->message);
}

static struct rnea_options open_options(const struct study *s, enum rnea_backend backend)
{
	struct rnea_options o = s->command->open;

	o.backend = backend;
	if (s->options->compiles_anew)
		o.cache = "";
	return o;
}

/* What moves the arrays of a scalar type. */
static enum rneagen_code open_floor(struct study *s, struct study_backend *b, enum rnea_scalar scalar)
{
	const struct dag *d = &s->analysis.dag;
	struct rnea_options o = open_options(s, b->backend);
	struct rnea_error e = {0};
	struct text text;

	text_init(&text, &s->analysis.arena);
	floor_text(d->arguments, d->argument_count, scalar, &text);
	o.file = "the floor";
	if (text.failed)
		error_memory(&s->error);
	else if (rnea_open(text_string(&text), text.length, &o, &b->floors[scalar], &e))
		fail_runtime(s, &e);
	return s->error.code;
}

static void describe(struct study_backend *b)
{
	const struct rnea_build *build = rnea_build(b->floors[RNEA_F32]);

	snprintf(b->device, sizeof b->device, "%s", build->device);
	snprintf(b->compiler, sizeof b->compiler, "%s", build->compiler);
	snprintf(b->target, sizeof b->target, "%s", build->target);
	b->threads = build->threads;
}

static void close_backend(struct study_backend *b)
{
	rnea_close(b->floors[RNEA_F32]);
	rnea_close(b->floors[RNEA_F64]);
	bench_close(b->bench);
	*b = (struct study_backend){0};
}

/* Where nobody asked for the GPU in particular and there is none, that is said and all. */
static enum rneagen_code open_backend(struct study *s, enum rnea_backend backend)
{
	struct study_backend *b = &s->backends[s->backend_count];
	struct rnea_error e = {0};

	*b = (struct study_backend){.backend = backend};
	if (bench_open(&b->bench, backend, s->command->open.device, &e)) {
		if (backend != RNEA_BACKEND_CUDA || s->options->backend_asked || (e.code != RNEA_NO_DRIVER && e.code != RNEA_NO_DEVICE))
			return fail_runtime(s, &e);
		fprintf(stderr, "%s: no GPU: %s\n", s->command->name, e.message);
		return RNEAGEN_OK;
	}
	if (open_floor(s, b, RNEA_F32) || open_floor(s, b, RNEA_F64)) {
		close_backend(b);
		return s->error.code;
	}
	describe(b);
	s->backend_count++;
	return RNEAGEN_OK;
}

/* What --strict excludes is left out where all was asked for; the GPU's own sine has bits of its own. */
static int check_strict(const struct command *c, struct study_options *o)
{
	if (c->generate.strict && !o->precision_asked)
		o->precisions = (struct study_list){{RNEAGEN_F32, RNEAGEN_MIXED, RNEAGEN_F64}, 3};
	if (c->generate.strict && !o->trig_asked)
		o->trigs = (struct study_list){{RNEAGEN_ACCURATE, RNEAGEN_BOUNDED}, 2};
	for (int i = 0; i < o->precisions.count && c->generate.strict; i++)
		if (o->precisions.values[i] == RNEAGEN_F32X2)
			return option_refuse(c->name, "--strict and --precision f32x2 exclude each other: take f64");
	for (int i = 0; i < o->trigs.count && c->generate.strict; i++)
		if (o->trigs.values[i] == RNEAGEN_FAST)
			return option_refuse(c->name, "--strict and --trig fast exclude each other: the GPU's own unit has other bits");
	return 0;
}

int study_open(struct study *s, const struct command *c, struct study_options *o)
{
	int status;

	*s = (struct study){.command = c, .options = o};
	if (check_strict(c, o))
		return 2;
	if ((status = command_analyse(c, &s->urdf, &s->analysis)) != 0)
		return status;
	for (size_t i = 0; i < s->analysis.robot.warning_count && !c->quiet; i++)
		fprintf(stderr, "%s: warning: %s\n", c->name, s->analysis.robot.warnings[i]);
	if (effect_total(&s->model_change, &s->analysis.tree, &s->analysis.dag, &s->analysis.robot, &c->generate, &o->sample,
		    &s->error))
		return command_fail(c, s->error.message);
	for (int i = 0; i < o->backends.count; i++)
		if (open_backend(s, (enum rnea_backend)o->backends.values[i]))
			return command_fail(c, s->error.message);
	return 0;
}

void study_close(struct study *s)
{
	for (int i = 0; i < s->backend_count; i++)
		close_backend(&s->backends[i]);
	for (int i = 0; i < STUDY_PRECISIONS; i++) {
		if (s->judges[i])
			judge_free(s->judges[i]);
		free(s->judges[i]);
	}
	analysis_free(&s->analysis);
	free(s->urdf.bytes);
}

/* ---- judging ---- */

const struct judge *study_judge(struct study *s, enum rneagen_precision precision)
{
	struct judge **j = &s->judges[precision];

	if (*j || !(*j = malloc(sizeof **j)))
		return *j;
	if (!judge_open(*j, &s->analysis, precision, &s->options->sample)) {
		free(*j);
		*j = NULL;
	}
	return *j;
}

static struct rneagen_options generate_options(const struct study *s, const struct study_row *row)
{
	struct rneagen_options g = s->command->generate;

	g.file = s->command->urdf;
	g.target = RNEAGEN_TARGET_CUDA; /* serves both backends */
	g.precision = row->precision;
	g.trig = row->trig;
	g.layout = row->layout;
	return rnea_urdf_options(&g, row->backend);
}

enum rneagen_code study_bound(struct study *s, struct study_row *row)
{
	int on_gpu = row->backend == RNEA_BACKEND_CUDA;
	const struct judge *j = study_judge(s, row->precision);
	struct rneagen_options g = generate_options(s, row);
	double *bound = &s->bounds[row->precision][row->trig][on_gpu];

	if (!j || (*bound == 0 && !judge_bound(j, &s->analysis, &g, on_gpu, bound)))
		return error_memory(&s->error);
	row->bound_max = *bound;
	return RNEAGEN_OK;
}

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

/* An input's numbers: the samples', again and again, or those of the whole batch. */
static void fill(struct arrays *a, const struct judge *j, const struct argument *from, int i)
{
	for (size_t k = 0; k < (from->per_batch ? 1 : a->count); k++) {
		const double *x = draw_rows(&j->inputs, from, k % j->count);

		for (size_t r = 0; x && r < a->rows[i]; r++)
			put(a, i, from->per_batch ? r : place(a, i, r, k), x[r]);
	}
}

/* `count` samples. Returns 0 when memory runs out. */
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
		fill(a, j, x, i);
	}
	return 1;
}

/* All outputs, [sample][row] one array after another. */
static void arrays_gather(const struct arrays *a, const struct judge *j, double *out)
{
	for (int i = 0; i < j->output_count; i++) {
		const struct judge_output *o = &j->outputs[i];

		for (size_t k = 0; k < a->count; k++)
			for (size_t r = 0; r < o->rows; r++) {
				size_t at = place(a, o->argument, r, k);
				const void *from = a->data[o->argument];

				out[k * j->rows + o->first + r] = a->f32 ? (double)((const float *)from)[at] : ((const double *)from)[at];
			}
	}
}

/* ---- one variant ---- */

struct variant {
	struct study *s;
	struct study_backend *b;
	const struct judge *judge;
	struct rnea_robot *robot;
	struct study_row *row;
};

static enum rneagen_code open_robot(struct variant *v)
{
	struct rneagen_options g = generate_options(v->s, v->row);
	struct rnea_options o = open_options(v->s, v->b->backend);
	struct rneagen_result text;
	struct rnea_error e = {0};

	if (rneagen_generate(v->s->urdf.bytes, v->s->urdf.length, &g, &text, &v->s->error))
		return v->s->error.code;
	if (rnea_open(text.source, strlen(text.source), &o, &v->robot, &e))
		fail_runtime(v->s, &e);
	else if (!signature_fits(&v->s->analysis.dag, rnea_info(v->robot)))
		error_set(&v->s->error, RNEAGEN_UNSUPPORTED, "%s: takes other arrays than its analysis", text.name);
	rneagen_result_free(&text);
	return v->s->error.code;
}

static enum rneagen_code measure_errors(struct variant *v)
{
	const struct judge *j = v->judge;
	struct arrays a;
	struct rnea_error e = {0};
	double *out = calloc(j->count, j->rows * sizeof *out);

	if (!out || !arrays_fill(&a, j, &v->s->analysis.dag, v->row->layout, j->count)) {
		free(out);
		return error_memory(&v->s->error);
	}
	if (rnea_run(v->robot, a.data, a.count, &e))
		fail_runtime(v->s, &e);
	arrays_gather(&a, j, out);
	v->row->errors = judge_results(j, out);
	v->row->model_change = v->s->model_change;
	arrays_free(&a);
	free(out);
	return v->s->error.code;
}

static void note_resources(struct variant *v)
{
	struct rnea_resources r;

	v->row->compile_ms = rnea_build(v->robot)->seconds * 1e3;
	v->row->registers = -1;
	if (v->b->backend != RNEA_BACKEND_CUDA || rnea_resources(v->robot, RNEA_KERNEL_RNEA, &r, NULL))
		return;
	v->row->registers = r.registers;
	v->row->spill_bytes = r.local_bytes;
	v->row->parts = rnea_info(v->robot)->parts;
}

static enum rneagen_code measure_time(struct variant *v, struct study_row *row, size_t batch)
{
	const struct rnea_robot *floor = v->b->floors[judge_is_f32(row->precision) ? RNEA_F32 : RNEA_F64];
	struct bench_time t = {0};
	struct rnea_error e = {0};
	struct arrays a;

	if (!arrays_fill(&a, v->judge, &v->s->analysis.dag, row->layout, batch))
		return error_set(&v->s->error, RNEAGEN_MEMORY, "no memory for %zu samples; choose a smaller --batch", batch);
	if (bench_measure(v->b->bench, v->robot, floor, a.data, batch, &t, &e))
		fail_runtime(v->s, &e);
	row->batch = batch;
	row->ns = t.ns;
	row->spread = t.spread;
	row->floor_ratio = t.floor / t.ns;
	arrays_free(&a);
	return v->s->error.code;
}

enum rneagen_code study_measure(struct study *s, struct study_backend *b, struct study_row *row)
{
	struct variant v = {s, b, study_judge(s, row->precision), NULL, row};

	if (!v.judge)
		return error_memory(&s->error);
	if (!study_bound(s, row) && !open_robot(&v) && !measure_errors(&v))
		note_resources(&v);
	for (int i = 0; i < s->options->batch_count && !s->error.code; i++) {
		row[i] = row[0];
		measure_time(&v, &row[i], s->options->batches[i]);
	}
	rnea_close(v.robot);
	return s->error.code;
}

int study_variants(const struct study *s)
{
	const struct study_options *o = s->options;

	return s->backend_count * o->precisions.count * o->trigs.count * o->layouts.count;
}

struct study_backend *study_variant(struct study *s, int i, struct study_row *row)
{
	const struct study_options *o = s->options;
	int layouts = o->layouts.count, trigs = o->trigs.count, precisions = o->precisions.count;
	struct study_backend *b = &s->backends[i / (layouts * trigs * precisions)];

	*row = (struct study_row){.backend = b->backend,
		.layout = (enum rneagen_layout)o->layouts.values[i % layouts],
		.trig = (enum rneagen_trig)o->trigs.values[i / layouts % trigs],
		.precision = (enum rneagen_precision)o->precisions.values[i / (layouts * trigs) % precisions]};
	return b;
}
