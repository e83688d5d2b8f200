#include "study/judge.h"
#include "core/workers.h"
#include "dag/eval.h"
#include "emit/number_type.h"
#include <math.h>
#include <stdlib.h>

#if defined __SIZEOF_FLOAT128__ && defined RNEAGEN_QUAD
#define eval_exact eval_quad
#else
#define eval_exact eval_real
#endif

/* One sample and what comes of it: the inputs' and outputs' rows after one another, and where each argument's begin. */
struct trial {
	exact *x;
	double *out64, *size; /* size: in the order of the DAG's outputs */
	const exact *in[DAG_ARGUMENTS];
	const double *in64[DAG_ARGUMENTS];
	exact *to[DAG_ARGUMENTS];
	double *to64[DAG_ARGUMENTS];
};

int judge_is_f32(enum rneagen_precision precision)
{
	return precision == RNEAGEN_F32 || precision == RNEAGEN_MIXED;
}

static double eps_of(const struct judge *j)
{
	return judge_is_f32(j->precision) ? 0x1p-23 : 0x1p-52;
}

/* Divided by the largest, since squares of tiny torques vanish. */
static double norm(const double *x, size_t n)
{
	double largest = 0, sum = 0;

	for (size_t i = 0; i < n; i++) {
		if (!isfinite(x[i]))
			return (double)INFINITY;
		largest = fmax(largest, fabs(x[i]));
	}
	for (size_t i = 0; i < n && largest > 0; i++)
		sum += x[i] / largest * (x[i] / largest);
	return largest * sqrt(sum);
}

/* Of the reference of output array o in sample k. */
static double norm_exact(const struct judge *j, size_t k, const struct judge_output *o)
{
	const exact *ref = j->out + k * j->rows + o->first;
	double sum = 0, largest = 0;

	for (size_t i = 0; i < o->rows; i++)
		largest = fmax(largest, fabs((double)ref[i]));
	for (size_t i = 0; i < o->rows && largest > 0; i++)
		sum += (double)ref[i] / largest * ((double)ref[i] / largest);
	return largest * sqrt(sum);
}

double judge_scale(const struct judge *j, const struct judge_output *o)
{
	double most = 0;

	for (size_t k = 0; k < j->count; k++)
		most = fmax(most, norm_exact(j, k, o));
	return most;
}

/* ---- evaluating ---- */

static int trial_new(struct trial *t, const struct judge *j, const struct dag *d)
{
	size_t rows = 0;

	for (int i = 0; i < d->argument_count; i++)
		rows += d->arguments[i].is_output ? 0 : (size_t)d->arguments[i].rows;
	*t = (struct trial){.x = calloc(rows + 1, sizeof *t->x), .out64 = calloc(j->rows, sizeof *t->out64),
		.size = calloc(d->output_count, sizeof *t->size)};
	return t->x && t->out64 && t->size;
}

static void trial_free(struct trial *t)
{
	free(t->x);
	free(t->out64);
	free(t->size);
}

static void load(struct trial *t, const struct judge *j, const struct dag *d, size_t k)
{
	exact *x = t->x;

	for (int i = 0; i < d->argument_count; i++) {
		t->in64[i] = draw_rows(&j->inputs, &d->arguments[i], k);
		t->in[i] = x;
		for (int r = 0; t->in64[i] && r < d->arguments[i].rows; r++)
			*x++ = (exact)t->in64[i][r];
	}
	for (int i = 0; i < j->output_count; i++) {
		t->to[j->outputs[i].argument] = j->out + k * j->rows + j->outputs[i].first;
		t->to64[j->outputs[i].argument] = t->out64 + j->outputs[i].first;
	}
}

static int evaluate(const struct judge *j, const struct dag *d, struct trial *t, size_t k)
{
	struct eval_terms terms = {t->size, NULL};

	load(t, j, d, k);
	if (!eval_exact(d, t->in, t->to, NULL) || !eval_f64(d, t->in64, t->to64, &terms))
		return 0;
	for (size_t i = 0; i < d->output_count; i++) {
		const struct output *o = &d->outputs[i];

		j->size[k * j->rows + (size_t)(t->to64[o->argument] - t->out64) + (size_t)o->row] = t->size[i];
	}
	return 1;
}

/* All samples, each a piece. */
struct samples {
	const struct judge *j;
	const struct dag *d;
	const struct eval_model *model; /* of bounds */
	unsigned char *done;
	double *max;
};

static void evaluate_piece(void *job, size_t k)
{
	struct samples *s = job;
	struct trial t = {0};

	s->done[k] = (unsigned char)(trial_new(&t, s->j, s->d) && evaluate(s->j, s->d, &t, k));
	trial_free(&t);
}

static int run(struct samples *s, workers_piece *piece)
{
	int done = (s->done = calloc(s->j->count + 1, 1)) != NULL;

	if (done)
		workers_run(s->j->workers, workers_limit(s->j->workers), piece, s, s->j->count);
	for (size_t k = 0; k < s->j->count && done; k++)
		done = s->done[k];
	free(s->done);
	return done;
}

static void list_outputs(struct judge *j, const struct dag *d)
{
	for (int i = 0; i < d->argument_count; i++) {
		const struct argument *x = &d->arguments[i];
		struct judge_output *o = &j->outputs[j->output_count];

		if (!x->is_output)
			continue;
		*o = (struct judge_output){i, j->rows, (size_t)x->rows, x->role == ROLE_JOINT_ACCELERATION_BOUND};
		j->rows += o->rows;
		j->output_count++;
		if (x->role == ROLE_JOINT_ACCELERATION)
			j->qdd = o;
	}
}

int judge_has_outputs(const struct dag *d)
{
	int found = 0;

	for (int i = 0; i < d->argument_count; i++)
		found |= d->arguments[i].is_output && d->arguments[i].role != ROLE_JOINT_ACCELERATION_BOUND;
	return found;
}

int judge_open(struct judge *j, const struct analysis *a, enum rneagen_precision precision, const struct draw_options *o,
	unsigned threads)
{
	struct samples s = {.j = j, .d = &a->dag};
	int done;

	*j = (struct judge){.precision = precision, .count = o->count, .workers = workers_open(threads)};
	arena_init(&j->arena, NULL);
	list_outputs(j, &a->dag);
	j->out = calloc(o->count, j->rows * sizeof *j->out);
	j->size = calloc(o->count, j->rows * sizeof *j->size);
	done = j->workers && j->out && j->size && draw_inputs(&j->inputs, &a->tree, &a->request, o, &j->arena);
	if (done && judge_is_f32(precision))
		draw_round(&j->inputs);
	done = done && run(&s, evaluate_piece);
	if (!done)
		judge_free(j);
	return done;
}

void judge_free(struct judge *j)
{
	workers_close(j->workers);
	free(j->out);
	free(j->size);
	arena_free(&j->arena);
	*j = (struct judge){0};
}

/* ---- judging ---- */

/* What is off over what it is of: no more than 0 where both are 0; -1: nothing is known. */
static double ratio(double off, double size)
{
	return size > 0 || isinf(off) ? off / size : off > 0 ? -1 : 0;
}

/* The largest bound of sample k; -1: none is known. */
static int bound_sample(const struct samples *s, size_t k, double *bound)
{
	const struct judge *j = s->j;
	const double *in[DAG_ARGUMENTS] = {NULL};
	double *to[DAG_ARGUMENTS] = {NULL};

	for (int i = 0; i < s->d->argument_count; i++)
		in[i] = draw_rows(&j->inputs, &s->d->arguments[i], k);
	for (int i = 0; i < j->output_count; i++)
		to[j->outputs[i].argument] = bound + j->outputs[i].first;
	if (!eval_bound(s->d, s->model, in, to))
		return 0;
	s->max[k] = -1;
	for (int i = 0; i < j->output_count; i++) {
		const struct judge_output *o = &j->outputs[i];

		if (!o->is_bound)
			s->max[k] = fmax(s->max[k], ratio(norm(bound + o->first, o->rows), norm_exact(j, k, o)));
	}
	return 1;
}

static void bound_piece(void *job, size_t k)
{
	struct samples *s = job;
	double *bound = calloc(s->j->rows, sizeof *bound);

	s->done[k] = (unsigned char)(bound && bound_sample(s, k, bound));
	free(bound);
}

/* Of the residual in a step of refinement, where it is of another type than the text's numbers. */
static struct eval_model wide_model(const struct analysis *a, const struct rneagen_options *o, int on_gpu)
{
	struct rneagen_options wide = *o;

	wide.precision = a->request.refine == REFINE_F64 ? RNEAGEN_F64 : RNEAGEN_F32X2;
	return eval_model_of(&wide, on_gpu);
}

int judge_bound(const struct judge *j, const struct analysis *a, const struct rneagen_options *o, int on_gpu, double *max)
{
	struct eval_model m = eval_model_of(o, on_gpu), wide;
	struct samples s = {.j = j, .d = &a->dag, .model = &m, .max = calloc(j->count + 1, sizeof *s.max)};
	int done;

	if (o->precision == RNEAGEN_F32 && a->request.refine != REFINE_SAME) {
		wide = wide_model(a, o, on_gpu);
		m.wide = &wide;
	}
	done = s.max && run(&s, bound_piece);
	*max = -1;
	for (size_t k = 0; k < j->count && done; k++)
		*max = fmax(*max, s.max[k]);
	if (!(*max >= 0) || isinf(*max))
		*max = (double)NAN;
	free(s.max);
	return done;
}

/* The error of an output array of sample k in the norm; the worst of its rows by terms is taken note of. */
static double judge_array(const struct judge *j, const double *out, size_t k, const struct judge_output *o, double *terms)
{
	size_t first = k * j->rows + o->first;
	double largest = 0, sum = 0;

	for (int pass = 0; pass < 2; pass++)
		for (size_t i = first; i < first + o->rows; i++) {
			double x = fabs((double)((exact)out[i] - j->out[i]));

			if (!isfinite(x))
				x = (double)INFINITY;
			if (pass == 0)
				largest = fmax(largest, x);
			else if (largest > 0 && isfinite(largest))
				sum += x / largest * (x / largest);
			if (x > 0)
				*terms = fmax(*terms, x / (eps_of(j) * j->size[i]));
		}
	return isfinite(largest) ? largest * sqrt(sum) : largest;
}

/* Is qdd of sample k off by more than its bound? One that is not a number says nothing. */
static int is_beyond(const struct judge *j, const double *out, size_t k, const struct judge_output *bound)
{
	for (size_t i = 0, at = k * j->rows; j->qdd && i < bound->rows; i++) {
		size_t row = at + j->qdd->first + i;

		if (fabs((double)((exact)out[row] - j->out[row])) > out[at + bound->first + i])
			return 1;
	}
	return 0;
}

/* The worst output array of sample k; -1: there is nothing to say. */
static double judge_sample(const struct judge *j, const double *out, size_t k, double *terms)
{
	double worst = -1;

	for (int i = 0; i < j->output_count; i++) {
		const struct judge_output *o = &j->outputs[i];

		if (o->is_bound && is_beyond(j, out, k, o))
			worst = (double)INFINITY;
		else if (!o->is_bound)
			worst = fmax(worst, ratio(judge_array(j, out, k, o, terms), norm_exact(j, k, o)));
	}
	return worst;
}

struct judge_errors judge_results(const struct judge *j, const double *out)
{
	struct judge_errors e = {0};
	size_t counted = 0;

	for (size_t k = 0; k < j->count; k++) {
		double worst = judge_sample(j, out, k, &e.terms);

		if (worst < 0)
			continue;
		e.max = fmax(e.max, worst);
		e.rms += worst * worst;
		counted++;
	}
	e.rms = counted ? sqrt(e.rms / (double)counted) : (double)NAN;
	if (!counted)
		e.max = (double)NAN;
	return e;
}
