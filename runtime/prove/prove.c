#define _POSIX_C_SOURCE 200809L
#include "prove/prove.h"
#include "core/seconds.h"
#include "emit/emit.h"
#include "emit/number_type.h"
#include "range/parts/cut.h"
#include "range/magnitude.h"
#include "prove/ranging.h"
#include "prove/rounding.h"
#include "prove/seek_errors.h"
#include <math.h>
#include <stdlib.h>

/* Shares of the time. What is left is for what takes longer than it should. */
#define SHARE_SEEK 0.05
#define SHARE_WHOLE 0.05
#define SHARE_LIMBS 0.01
#define SHARE_MAGNITUDE 0.03
#define SHARE_CURVATURE 0.13
#define SHARE_COVER 0.20
#define SHARE_SEEK_ERRORS 0.08
#define SHARE_ALL 0.99 /* errors get what is left of this */

/* Outputs whose ranges are proved together: of a field, or of a limb that is cut off. */
struct target {
	const struct field *f;
	const struct box *b;
	const int *outputs; /* NULL: as in the field */
	struct sought (*found)[2];  /* by the field's output */
	struct interval *loads;  /* of a limb: their ranges, of outputs beyond those of the text */
};

struct proving {
	const struct analysis *a;
	const struct box *b;
	struct relaxed relaxed;
	struct box box; /* of what is relaxed */
	const struct prove_options *o;
	struct progress *progress;
	struct rneagen_error *e;
	struct arena arena;
	struct field *fields;
	int field_count;
	struct target *targets;
	int target_count, first; /* first: of those that share the time of `part` */
	double part;             /* of the time for ranges */
	struct effort effort;
	struct states states;                   /* of the text's */
	double (*values)[2], *(*best)[2];       /* by output: what was found, and where */
	struct eval_model models[PROVE_PRECISIONS];
	double start;
};

static void show(struct proving *p, const char *doing)
{
	progress_show(p->progress, (uint64_t)(seconds_now() - p->start), doing);
}

/* The number of an output of a target among all. */
static int output_of(const struct target *t, int i)
{
	return t->outputs ? t->outputs[t->f->outputs[i]] : t->f->outputs[i];
}

/* Of torques that are bounded anew there are ranges; loads have none. */
#define WORK_AGAIN 0.25

/* A target's share of the work: the more rows of q, the more points, or the more there is to search. */
static double share_of(const struct proving *p, int k, int of_grids)
{
	double sum = 0, own = 0;

	for (int i = p->first; i < p->target_count; i++) {
		const struct field *f = p->targets[i].f;
		double n = f->dim_count, work = f->output_count * (1 + n * n * n);
		int is_again = p->first && output_of(&p->targets[i], 0) < (int)p->a->dag.output_count;

		work *= of_grids && !f->has_grid ? 0 : is_again ? WORK_AGAIN : 1;
		sum += work;
		own = i == k ? work : own;
	}
	return sum > 0 ? own / sum : 0;
}

static void take_found(struct proving *p, int k, int i, int side, const struct sought *found)
{
	const struct field *f = &p->fields[k];
	int output = f->outputs[i];
	double *in[DAG_ARGUMENTS];

	p->targets[k].found[i][side] = *found;
	p->values[output][side] = found->value;
	states_point(&p->states, p->best[output][side], in);
	states_take(&p->states, &p->relaxed, f, found, in);
}

static enum rneagen_code seek_field(struct proving *p, int k, double seconds)
{
	const struct field *f = &p->fields[k];
	struct sought (*best)[2] = calloc((size_t)f->output_count, sizeof *best);
	int done = best && seek_extremes(best, f, &p->effort, seconds);

	for (int i = 0; done && i < f->output_count; i++)
		for (int side = 0; side < 2; side++)
			take_found(p, k, i, side, &best[i][side]);
	free(best);
	return done ? RNEAGEN_OK : error_memory(p->e);
}

/* What the text's own states give, where the relaxed box has others. */
static enum rneagen_code seek_all(struct proving *p)
{
	for (int k = 0; k < p->field_count; k++)
		if (seek_field(p, k, SHARE_SEEK * p->o->seconds * share_of(p, k, 0)))
			return p->e->code;
	if (!p->relaxed.is_same && !states_seek(&p->states, p->values, p->best, &p->effort, SHARE_SEEK * p->o->seconds))
		return error_memory(p->e);
	return RNEAGEN_OK;
}

/* The better of both ways. */
static void take_rows(const struct proving *p, const struct target *t, const struct ranging *g, struct prove_row *rows)
{
	for (int i = 0; i < t->f->output_count; i++) {
		int output = output_of(t, i), load = output - (int)p->a->dag.output_count;
		struct prove_row *r = load < 0 ? &rows[output] : NULL;

		if (load >= 0) {
			t->loads[load] = (struct interval){fmax(g->cover.lower[i], g->ranges[i].lower),
				fmin(g->cover.upper[i], g->ranges[i].upper)};
			continue;
		}
		r->low = fmax(r->low, fmax(g->cover.lower[i], g->ranges[i].lower));
		r->high = fmin(r->high, fmin(g->cover.upper[i], g->ranges[i].upper));
		r->plain = fmin(r->plain, t->outputs ? r->plain : t->f->plain[i]);
		r->found_low = p->values[output][0];
		r->found_high = p->values[output][1];
	}
}

/* Both by the same knots, where there are any. */
static int find_covers(struct proving *p, const struct field *f, struct ranging *r, double seconds)
{
	const double part = SHARE_CURVATURE / (SHARE_CURVATURE + SHARE_COVER);
	double end = seconds_now() + seconds;
	const struct knots *knots = knots_make(&r->knots, f, &p->effort, KNOTS_SHARE * seconds) ? &r->knots : NULL;
	const struct curvature_start bent = {r->whole, r->largest, r->bends, knots};
	struct cover_start covered = {.found = (const double(*)[2])r->found, .knots = knots};

	if (!curvature_find(&r->curvature, f, &bent, &p->effort, part * (end - seconds_now())))
		return 0;
	covered.bends = r->curvature.most;
	return cover_find(&r->cover, f, &covered, &p->effort, end - seconds_now());
}

static int find_by_grids(struct proving *p, const struct target *t, struct ranging *r, double seconds)
{
	struct effort soon = p->effort;

	soon.deadline = fmin(p->effort.deadline, seconds_now() + 2 * SHARE_WHOLE * seconds);
	return magnitude_find(r->whole, t->f, t->b, 1, &p->effort, SHARE_WHOLE * seconds) &&
	       magnitude_bends(r->bends, t->f, t->b, &soon) && find_covers(p, t->f, r, (SHARE_CURVATURE + SHARE_COVER) * seconds);
}

static int find_ranges(struct proving *p, int k, struct ranging *r)
{
	const struct target *t = &p->targets[k];
	double seconds = p->part * p->o->seconds;
	struct effort own = p->effort;

	own.record = t->outputs ? NULL : own.record; /* a limb's rows are none of the text's */
	if (!(t->f->has_grid ? find_by_grids(p, t, r, seconds * share_of(p, k, 1)) : ranging_plain(&r->cover, t->f)))
		return 0;
	return magnitude_find(r->ranges, t->f, t->b, 0, &own, SHARE_MAGNITUDE * seconds * share_of(p, k, 0));
}

static enum rneagen_code prove_target(struct proving *p, int k, struct prove_row *rows)
{
	const struct target *t = &p->targets[k];
	struct ranging r;
	int done;

	show(p, "ranges");
	done = ranging_make(&r, t->f, t->found) && find_ranges(p, k, &r);
	if (done)
		take_rows(p, t, &r, rows);
	ranging_free(&r);
	return done ? RNEAGEN_OK : error_memory(p->e);
}

static void set_models(struct proving *p)
{
	for (int i = 0; i < p->o->precision_count; i++) {
		struct rneagen_options o = p->a->options;

		o.precision = p->o->precisions[i];
		p->models[i] = eval_model_of(&o, 0);
	}
}

static enum rneagen_code prove_errors(struct proving *p, struct proof *proof)
{
	int n = p->o->precision_count;
	double seconds = p->o->seconds;
	double *const(*best)[2] = (double *const(*)[2])p->best;
	struct relaxed own, *text = p->relaxed.text == p->a ? &p->relaxed : &own;

	show(p, "errors");
	if (text == &own && relax(&own, p->a, p->b->rows, &p->arena, p->e))
		return p->e->code;
	if (!seek_errors(proof->rows, p->a, p->b, p->models, n, best, &p->effort, SHARE_SEEK_ERRORS * seconds) ||
		!rounding_find(proof->rows, text, p->b, p->models, n, &p->effort, SHARE_ALL * seconds - (seconds_now() - p->start)))
		return error_memory(p->e);
	return RNEAGEN_OK;
}

static enum rneagen_code add_fields(struct proving *p)
{
	size_t outputs = p->a->dag.output_count, bodies = (size_t)p->a->tree.body_count;
	/* in each of two rounds, of six levels, outputs and six loads a body */
	p->targets = arena_alloc(&p->arena, 96 * (outputs + bodies) + 1, sizeof *p->targets);
	for (int k = 0; k < p->field_count && p->targets; k++)
		p->targets[p->target_count++] = (struct target){.f = &p->fields[k], .b = &p->box,
			.found = arena_alloc(&p->arena, (size_t)p->fields[k].output_count, sizeof(struct sought[2]))};
	return p->arena.failed ? error_memory(p->e) : RNEAGEN_OK;
}

/* ---- parts ---- */

/* What depends on many rows of q is cut into limbs and what carries them, which may be cut again: grids are for the parts. */
struct proved_part {
	const struct relaxed *relaxed;
	struct field *fields;
	int field_count, from;
	const int *outputs; /* the numbers of its outputs among all; NULL: they are all */
	struct cut *cuts, rest;
	int count;
	struct interval **loads;
};

enum { MOST_PARTS = 6, CUT_FROM = 7, CUT_AGAIN_FROM = 6, OWN_GRID = 8 };

/* Grids of small limbs are quick. Large ones lose less, as more of the robot moves together; they need so many seconds for each
   output that is cut, and then get the most of the time. */
enum { SMALL_LIMB = 5, LARGE_LIMB = 7, SECONDS_LARGE = 30 };
#define PART_SMALL 0.25

/* The numbers among all of what was cut off a part. */
static int *outputs_of(struct proving *p, const struct proved_part *l, const struct cut *c)
{
	size_t count = c->relaxed.view.dag.output_count;
	int *outputs = arena_alloc(&p->arena, count + 1, sizeof *outputs), own = (int)l->relaxed->view.dag.output_count;

	for (size_t i = 0; i < count && outputs; i++)
		outputs[i] = c->outputs[i] >= own ? c->outputs[i] - own + (int)p->a->dag.output_count
						  : (l->outputs ? l->outputs[c->outputs[i]] : c->outputs[i]);
	return outputs;
}

/* Its fields, with what a search finds of them. */
static int add_part(struct proving *p, const struct cut *c, const int *outputs, struct interval *loads)
{
	for (int k = 0; k < c->field_count && outputs; k++) {
		struct target *t = &p->targets[p->target_count++];

		*t = (struct target){&c->fields[k], &c->box, outputs,
			arena_alloc(&p->arena, (size_t)c->fields[k].output_count, sizeof *t->found), loads};
		if (!t->found || !seek_extremes(t->found, t->f, &p->effort, SHARE_LIMBS * p->o->seconds / c->field_count))
			return 0;
	}
	return outputs != NULL;
}

static int add_limbs(struct proving *p, struct proved_part *l, int dims)
{
	l->count = cut_make(&l->cuts, l->relaxed, l->fields, l->field_count, l->from, dims, &p->effort,
		SHARE_LIMBS * p->o->seconds, &p->arena);
	l->loads = arena_alloc(&p->arena, (size_t)(l->count > 0 ? l->count : 0) + 1, sizeof *l->loads);
	if (l->count < 0 || !l->loads)
		return 0;
	for (int i = 0; i < l->count; i++) {
		l->loads[i] = arena_alloc(&p->arena, (size_t)l->cuts[i].load_count + 1, sizeof **l->loads);
		if (!l->loads[i] || !add_part(p, &l->cuts[i], outputs_of(p, l, &l->cuts[i]), l->loads[i]))
			return 0;
	}
	for (int k = 0; k < l->field_count; k++)
		l->fields[k].has_grid &= l->fields[k].dim_count <= OWN_GRID || !cut_has_torques(l->cuts, l->count);
	return 1;
}

static int prove_targets(struct proving *p, int *first, struct prove_row *rows)
{
	for (; *first < p->target_count; ++*first)
		if (prove_target(p, *first, rows))
			return 0;
	return 1;
}

/* Limbs of so many rows of q first; when their loads are known, what carries them. */
static int prove_parts(struct proving *p, int *first, int dims, struct prove_row *rows)
{
	struct proved_part *l = arena_alloc(&p->arena, MOST_PARTS + 1, sizeof *l);
	int made = 1;

	if (!l)
		return 0;
	l[0] = (struct proved_part){.relaxed = &p->relaxed, .fields = p->fields, .field_count = p->field_count, .from = CUT_FROM};
	for (int i = 0; i < MOST_PARTS && made; i++) {
		if (!add_limbs(p, &l[i], dims) || !prove_targets(p, first, rows))
			return 0;
		made = l[i].count ? cut_rest(&l[i].rest, l[i].relaxed, l[i].fields, l[i].field_count, l[i].from,
					    l[i].cuts, l[i].count, l[i].loads, &p->arena)
				  : 0;
		if (made < 0)
			return 0;
		l[i + 1] = (struct proved_part){.relaxed = &l[i].rest.relaxed, .fields = l[i].rest.fields, .from = CUT_AGAIN_FROM,
			.field_count = l[i].rest.field_count, .outputs = made ? outputs_of(p, &l[i], &l[i].rest) : NULL};
		if (made && !add_part(p, &l[i].rest, l[i + 1].outputs, NULL))
			return 0;
	}
	return prove_targets(p, first, rows);
}

/* Is there time for large limbs, and are there any? */
static int has_large(struct proving *p)
{
	int outputs = 0;

	for (int k = 0; k < p->field_count; k++)
		outputs += p->fields[k].dim_count >= CUT_FROM ? p->fields[k].output_count : 0;
	return p->o->seconds >= SECONDS_LARGE * outputs &&
	       cut_differs(&p->relaxed, p->fields, p->field_count, CUT_FROM, SMALL_LIMB, LARGE_LIMB, &p->arena) > 0;
}

static int prove_ranges(struct proving *p, struct prove_row *rows)
{
	int is_large = has_large(p), first = 0;

	p->part = is_large ? PART_SMALL : 1;
	if (!prove_parts(p, &first, SMALL_LIMB, rows))
		return 0;
	p->first = first;
	p->part = 1 - PART_SMALL;
	return !is_large || prove_parts(p, &first, LARGE_LIMB, rows);
}

static int make_states(struct proving *p)
{
	size_t outputs = p->a->dag.output_count;

	p->values = arena_alloc(&p->arena, outputs, sizeof *p->values);
	p->best = arena_alloc(&p->arena, outputs, sizeof *p->best);
	for (size_t i = 0; i < outputs && p->best; i++)
		for (int side = 0; side < 2; side++)
			p->best[i][side] = arena_alloc(&p->arena, p->states.size + 1, sizeof(double));
	return !p->arena.failed;
}

static enum rneagen_code prove_all(struct proving *p, struct proof *proof)
{
	proof->rows = calloc(p->a->dag.output_count + 1, sizeof *proof->rows);
	p->effort.workers = workers_open(p->o->threads);
	states_of(&p->states, p->a, p->b);
	if (!proof->rows || !p->effort.workers || !make_states(p))
		return error_memory(p->e);
	p->effort.threads = workers_limit(p->effort.workers);
	p->effort.deadline = p->start + 1.2 * p->o->seconds;
	set_models(p);
	if (add_fields(p) || seek_all(p))
		return p->e->code;
	for (size_t i = 0; i < p->a->dag.output_count; i++)
		proof->rows[i] = (struct prove_row){
			.low = -(double)INFINITY, .high = (double)INFINITY, .plain = (double)INFINITY};
	if (!prove_ranges(p, proof->rows))
		return p->e->code ? p->e->code : error_memory(p->e);
	if (prove_errors(p, proof))
		return p->e->code;
	return RNEAGEN_OK;
}

enum rneagen_code prove(struct proof *proof, const struct analysis *a, const struct box *b, const struct prove_options *o,
	struct progress *progress, struct rneagen_error *e)
{
	double start = o->start > 0 ? o->start : seconds_now();
	struct proving p = {.a = a, .b = b, .o = o, .progress = progress, .e = e, .start = start, .effort = {.record = o->record}};

	*proof = (struct proof){0};
	arena_init(&p.arena, NULL);
	if (!relax(&p.relaxed, o->stated ? o->stated : a, b->rows, &p.arena, e)) {
		p.box = relaxed_box(&p.relaxed);
		p.field_count = field_split(&p.fields, &p.relaxed, &p.arena, e);
		if (p.field_count >= 0)
			prove_all(&p, proof);
	}
	workers_close(p.effort.workers);
	arena_free(&p.arena);
	return e->code;
}
