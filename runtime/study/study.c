#define _POSIX_C_SOURCE 200809L
#include "study/study.h"
#include "tell/effect.h"
#include "emit/emit.h"
#include "study/floor.h"
#include "urdf.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- opening ---- */

enum rneagen_code study_fail(struct study *s, const struct rnea_error *e)
{
	return error_set(&s->error, e->code == RNEA_MEMORY ? RNEAGEN_MEMORY : RNEAGEN_UNSUPPORTED, "%s", e->message);
}

struct rnea_options study_open_options(const struct study *s, enum rnea_backend backend)
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
	struct rnea_options o = study_open_options(s, b->backend);
	struct rnea_error e = {0};
	struct text text;

	text_init(&text, s->analysis.arena);
	floor_text(d->arguments, d->argument_count, scalar, &text);
	o.file = "the text that only copies the arrays";
	if (text.failed)
		error_memory(&s->error);
	else if (rnea_open(text_string(&text), text.length, &o, &b->floors[scalar], &e))
		study_fail(s, &e);
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
		if (backend != RNEA_BACKEND_CUDA || s->options->backend_asked ||
			(e.code != RNEA_NO_DRIVER && e.code != RNEA_NO_DEVICE))
			return study_fail(s, &e);
		if (!s->command->quiet)
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

/* Pairs of floats, and the GPU's own sine, where all was asked for. */
static void leave_out(struct study_options *o)
{
	if (!o->precision_asked)
		o->precisions = (struct study_list){{RNEAGEN_F32, RNEAGEN_MIXED, RNEAGEN_F64}, 3};
	if (!o->trig_asked)
		o->trigs = (struct study_list){{RNEAGEN_ACCURATE, RNEAGEN_BOUNDED}, 2};
}

/* What --strict excludes; the GPU's own sine has bits of its own. */
static int check_strict(const struct command *c, struct study_options *o)
{
	if (c->generate.strict)
		leave_out(o);
	for (int i = 0; i < o->precisions.count && c->generate.strict; i++)
		if (o->precisions.values[i] == RNEAGEN_F32X2)
			return option_refuse(c->name, "--strict and --precision f32x2 exclude each other: take f64");
	for (int i = 0; i < o->trigs.count && c->generate.strict; i++)
		if (o->trigs.values[i] == RNEAGEN_FAST)
			return option_refuse(c->name,
				"--strict and --trig fast exclude each other: the GPU's own unit has other bits");
	return 0;
}

/* qdd_bound excludes the same, which the generator says where it was asked for. */
static int check_bound(const struct study *s, struct study_options *o)
{
	if (request_wants(&s->analysis.request, WANT_QDD_BOUND))
		leave_out(o);
	if (judge_has_outputs(&s->analysis.dag))
		return 0;
	return option_refuse(s->command->name,
		"qdd_bound bounds the error of qdd, and is not judged itself: take --want qdd,qdd_bound");
}

static uint64_t variants_asked(const struct study *s)
{
	const struct study_options *o = s->options;

	return (uint64_t)(s->backend_count * o->precisions.count * o->trigs.count * o->layouts.count);
}

int study_open(struct study *s, const struct command *c, struct study_options *o)
{
	int status;

	*s = (struct study){.command = c, .options = o};
	if (check_strict(c, o))
		return 2;
	if ((status = command_analyse(c, &s->urdf, &s->analysis)) != 0 || (status = check_bound(s, o)) != 0)
		return status;
	for (size_t i = 0; i < s->analysis.robot.warning_count && !c->quiet; i++)
		fprintf(stderr, "%s: warning: %s\n", c->name, s->analysis.robot.warnings[i]);
	if (effect_total(&s->model_change, &s->analysis, &o->sample, &s->error))
		return command_fail(c, s->error.message);
	for (int i = 0; i < o->backends.count; i++)
		if (open_backend(s, (enum rnea_backend)o->backends.values[i]))
			return command_fail(c, s->error.message);
	progress_start(&s->progress, c->name, "variants", variants_asked(s), c->quiet);
	if (study_plan(s)) {
		progress_end(&s->progress);
		command_fail(c, s->error.message);
		return 1 + option_at_fault(s->error.code);
	}
	s->progress.total = (uint64_t)s->variant_count;
	return 0;
}

void study_show(struct study *s, int done, const struct study_row *row)
{
	char name[64];

	study_name(row, name, sizeof name);
	progress_show(&s->progress, (uint64_t)done, name);
}

static void close_precision(struct study_precision *x)
{
	if (!x)
		return;
	judge_free(&x->judge);
	analysis_free(&x->analysis);
	free(x);
}

void study_close(struct study *s)
{
	for (int i = 0; i < s->backend_count; i++)
		close_backend(&s->backends[i]);
	for (int i = 0; i < STUDY_PRECISIONS; i++)
		close_precision(s->precisions[i]);
	analysis_free(&s->analysis);
	free(s->variants);
	free(s->urdf.bytes);
}

/* ---- judging ---- */

static struct rneagen_options options_of(const struct study *s, enum rneagen_precision precision)
{
	struct rneagen_options g = s->command->generate;

	g.file = s->command->urdf;
	g.precision = precision;
	return g;
}

/* NULL when memory runs out. */
static struct study_precision *precision_of(struct study *s, enum rneagen_precision precision)
{
	struct study_precision **x = &s->precisions[precision];
	struct rneagen_options g = options_of(s, precision);

	if (*x || !(*x = calloc(1, sizeof **x)))
		return *x;
	if (analysis_open(&(*x)->analysis, s->urdf.bytes, s->urdf.length, &g, &s->error) ||
		!judge_open(&(*x)->judge, &(*x)->analysis, precision, &s->options->sample, s->command->open.threads)) {
		analysis_free(&(*x)->analysis);
		free(*x);
		*x = NULL;
	}
	return *x;
}

const struct judge *study_judge(struct study *s, enum rneagen_precision precision)
{
	const struct study_precision *x = precision_of(s, precision);

	return x ? &x->judge : NULL;
}

struct rneagen_options study_generate(const struct study *s, const struct study_row *row)
{
	struct rneagen_options g = options_of(s, row->precision);

	g.target = row->backend == RNEA_BACKEND_CUDA ? RNEAGEN_TARGET_CUDA : RNEAGEN_TARGET_C;
	g.trig = row->trig;
	g.layout = row->layout;
	return g;
}

enum rneagen_code study_bound(struct study *s, struct study_row *row)
{
	int on_gpu = row->backend == RNEA_BACKEND_CUDA;
	const struct study_precision *x = precision_of(s, row->precision);
	struct rneagen_options g = study_generate(s, row);
	double *bound = &s->bounds[row->precision][row->trig][on_gpu];

	if (!x || (*bound == 0 && !judge_bound(&x->judge, &x->analysis, &g, on_gpu, bound)))
		return error_memory(&s->error);
	row->bound_max = *bound;
	return RNEAGEN_OK;
}

