#define _POSIX_C_SOURCE 200809L
#include "certify/certificate.h"
#include "certify/left_out.h"
#include "core/seconds.h"
#include <stdatomic.h>
#include <stdlib.h>

const char *const STEP_NAMES[STEP_COUNT] = {"values", "errors", "grid"};

/* In all steps of a certificate together: a file is to be below the limit of what is read. */
enum { ALL_BOXES = 100000, MOST_BOXES = 20000 };

int certificate_ask(struct certificate *c, struct arena *arena)
{
	for (int k = 0; k < c->precision_count; k++)
		c->models[k] = asked_model(c->a, c->precisions[k]);
	return asked_box(&c->box, c->a, arena);
}

struct box_bound certified_total(const struct certified *row, int precision_count)
{
	struct box_bound total = {.value = {-(double)INFINITY, (double)INFINITY}};

	for (int k = 0; k < precision_count; k++)
		total.errors[k] = (double)INFINITY;
	for (int kind = 0; kind < BOX_STEPS; kind++) {
		struct box_bound of = boxes_total(&row->steps[kind], precision_count);

		if (!row->steps[kind].count)
			continue;
		total.value.lo = fmax(total.value.lo, of.value.lo);
		total.value.hi = fmin(total.value.hi, of.value.hi);
		for (int k = 0; k < precision_count && kind == STEP_ERRORS; k++)
			total.errors[k] = of.errors[k];
	}
	if (row->grid.dim_count) {
		total.value.lo = fmax(total.value.lo, row->grid.value.lo);
		total.value.hi = fmin(total.value.hi, row->grid.value.hi);
	}
	return total;
}

/* What a step of an output is about. */
struct subject {
	struct errors errors;
	struct asked_box box;
	struct boxes_of of;
	struct arena arena;
};

static int subject_open(struct subject *s, const struct certificate *c, size_t output, enum step_kind kind)
{
	const struct dag *d = &c->a->dag;

	arena_init(&s->arena, NULL);
	if (!errors_make(&s->errors, d, output, c->models, kind == STEP_ERRORS ? c->precision_count : 0, &s->arena) ||
		!asked_copy(&s->box, &c->box, d, &s->arena))
		return 0;
	s->of = (struct boxes_of){&s->errors, s->box.rows, s->box.position, s->box.q_rows};
	return 1;
}

long certificate_check_boxes(const struct certificate *c, size_t output, enum step_kind kind, const struct boxes *step,
	const char **what)
{
	struct subject s;
	long fault = (long)step->count;

	*what = "its expressions";
	if (subject_open(&s, c, output, kind))
		fault = boxes_check(step, &s.of, what);
	arena_free(&s.arena);
	return fault;
}

/* The output as polynomials, and how it bends. 1; 0: memory ran out; -1: it is none. */
static int subject_points(struct subject *s, const struct certificate *c, size_t output, struct points *p,
	struct bends_start *start)
{
	const struct dag *d = &c->a->dag;
	int made;

	arena_init(&s->arena, NULL);
	if (!asked_copy(&s->box, &c->box, d, &s->arena))
		return 0;
	made = points_make(p, d, output, s->box.rows, s->box.position, &s->arena);
	return made == 1 && p->dim_count ? bends_find(start, p, d, output, s->box.rows, s->box.position) : made;
}

const char *certificate_check_grid(const struct certificate *c, size_t output, const struct grid_step *step)
{
	struct subject s;
	struct points p;
	struct bends_start start;
	const char *fault = "expressions";

	if (subject_points(&s, c, output, &p, &start) == 1)
		fault = grid_check(step, &p, &start);
	arena_free(&s.arena);
	return fault;
}

/* ---- making ---- */

/* Shares of a row's time. */
static const double SHARES[STEP_COUNT] = {0.05, 0.35, 0.6};

struct making {
	struct certificate *c;
	const struct record *record;
	const struct proved_bound *proved;
	struct boxes_goal goal;
	double seconds; /* of a row */
	atomic_int failed;
};

static int make_grid(const struct making *m, size_t output)
{
	const struct proved_bound *p = &m->proved[output];
	struct certified *row = &m->c->rows[output];
	struct subject s;
	struct points points;
	struct bends_start start;
	int made = subject_points(&s, m->c, output, &points, &start);

	if (made == 1 && points.dim_count)
		made = grid_find(&row->grid, &points, &start, fmax(fabs(p->low), fabs(p->high)), SHARES[STEP_GRID] * m->seconds);
	arena_free(&s.arena);
	return made != 0;
}

static int make_boxes(const struct making *m, size_t output, enum step_kind kind)
{
	const struct record_output *r = &m->record->outputs[output];
	const struct proved_bound *p = &m->proved[output];
	struct boxes_goal goal = m->goal;
	struct subject s;
	int made = 1;

	goal.target = kind == STEP_ERRORS ? p->errors[0] : fmax(fabs(p->low), fabs(p->high));
	goal.deadline = fmin(goal.deadline, seconds_now() + SHARES[kind] * m->seconds);
	if (!subject_open(&s, m->c, output, kind))
		made = !s.arena.failed;
	else
		made = boxes_find(&m->c->rows[output].steps[kind], &s.of, kind == STEP_ERRORS ? &r->errors : &r->values, &goal);
	arena_free(&s.arena);
	return made;
}

static void make_step(void *job, size_t piece)
{
	struct making *m = job;
	size_t output = piece / STEP_COUNT;
	enum step_kind kind = (enum step_kind)(piece % STEP_COUNT);

	if (m->c->rows[output].left_out)
		return;
	m->failed |= !(kind == STEP_GRID ? make_grid(m, output) : make_boxes(m, output, kind));
}

static enum rneagen_code make_steps(struct making *m, double seconds, unsigned threads, struct rneagen_error *e)
{
	struct workers *w = workers_open(threads);
	size_t steps = STEP_COUNT * m->record->count;

	if (!w)
		return error_memory(e);
	m->seconds = seconds * workers_limit(w) / (double)m->record->count;
	m->goal.deadline = seconds_now() + seconds;
	m->goal.most = ALL_BOXES / (steps + 1) + 1 < MOST_BOXES ? ALL_BOXES / (steps + 1) + 1 : MOST_BOXES;
	workers_run(w, workers_limit(w), make_step, m, steps);
	workers_close(w);
	for (size_t i = 0; i < m->record->count; i++)
		m->c->rows[i].bound = certified_total(&m->c->rows[i], m->c->precision_count);
	return m->failed ? error_memory(e) : RNEAGEN_OK;
}

enum rneagen_code certificate_make(struct certificate *c, const struct record *record,
	const struct proved_bound *proved, double seconds, unsigned threads, struct arena *arena, struct rneagen_error *e)
{
	struct making m = {.c = c, .record = record, .proved = proved};

	c->rows = calloc(record->count + 1, sizeof *c->rows);
	if (!c->rows || !certificate_ask(c, arena))
		return error_memory(e);
	for (int k = 0; k < c->precision_count; k++)
		if (asked_text_hash(c->a, c->precisions[k], c->text_hash[k], e))
			return e->code;
	for (size_t i = 0; i < record->count; i++)
		c->rows[i].left_out = left_out(c->a, i);
	return make_steps(&m, seconds, threads, e);
}

void certificate_free(struct certificate *c)
{
	for (size_t i = 0; c->rows && i < c->a->dag.output_count; i++)
		for (int kind = 0; kind < BOX_STEPS; kind++)
			boxes_free(&c->rows[i].steps[kind]);
	free(c->rows);
	c->rows = NULL;
}
