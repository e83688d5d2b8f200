/* A text computes v + delta where v is exact. For a product of a and b,
     delta = a delta_b + b delta_a + (delta_a delta_b + its own rounding),
   and so for each operation: what is linear in the operands' errors, and a rest. So the output's error is exactly the
   sum over all operations of (the output's derivative by the operation) times (the rest there), as in FPTaylor
   (Solovyev et al., Rigorous estimation of floating-point round-off errors with symbolic Taylor expansions, TOPLAS 41,
   2018). Magnitudes of both are bounded over boxes of q (norms.h), for all drives and rates at once; the box with the
   largest bound is split until the time is over. */
#define _POSIX_C_SOURCE 200809L
#include "prove/rounding.h"
#include "prove/gap.h"
#include "core/seconds.h"
#include "dag/eval.h"
#include "peaks/caps.h"
#include "prove/coarse.h"
#include "prove/crests/sharpen.h"
#include "prove/crests/stints.h"
#include "prove/rules.h"
#include "prove/twins.h"
#include "range/split.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { VIEWS = 2 };
#define LANES_BELOW 0.2 /* rad or m */
#define EQUALLY 0.15 /* of the time, where no certificate takes over boxes */
/* of the time of an output */
#define SHARE_PLAIN 0.08
#define SHARE_RECORDED 0.75 /* in its place where a certificate takes over the boxes */
#define SHARE_CAPS 0.05     /* of what is left, twice */
/* For points at most half of it, and no more than their first grids need; what is left of this is for knots. */
#define SHARE_PEAKS 0.5
#define SHARE_SHARPER 0.72
#define LEAST_PEAKS 0.12
/* For each node and row of q; less where most depends on more rows than points are for. */
#define SECONDS_OF_PEAKS 5e-4
#define SECONDS_OF_PEAKS_MANY 1e-4
enum { MANY_ROWS = 12 };

/* One output. */
struct hunt {
	const struct dag *d;
	const struct eval_model *models;
	int count;
	struct adjoint x;
	struct view views[VIEWS];
	const struct view *now;
	struct interval *rows[DAG_ARGUMENTS]; /* of the box, those of q its own */
	struct rules rules;
	double *size;         /* by node */
	double *leaves[PROVE_PRECISIONS]; /* by model and node */
	unsigned char *live;
	const struct relaxed *relaxed;
	const struct coarse *coarse;
	struct prove_gap gaps[PROVE_PRECISIONS]; /* the first that was met, by model */
	int position, dims[SPLIT_DIMS];
	struct split split;
	struct arena arena;
};

/* ---- a box ---- */

static double slope_at(const struct hunt *h, uint32_t i)
{
	return h->x.slope[i].i ? h->now->values.size[h->x.slope[i].i] : 0;
}

/* What twins' roundings make of the error is at most that of each, or what the norms say. */
static double gain_of(const struct hunt *h, const struct twins *t, double unit, const double *of)
{
	const struct view *v = h->now;
	double each = slope_at(h, t->one) * of[t->one] + slope_at(h, t->other) * of[t->other];
	double values = t->x ? v->values.size[t->x] : t->values ? norms_of_pair(&v->norms, &v->values, t->values) : 1;
	double slopes = norms_of_pair(&v->norms, &v->values, t->slopes);

	if (t->shares.count)
		slopes = fmin(slopes, shares_length(&t->shares, &v->norms, &v->values));
	return fmax(0, each - unit * values * slopes * (1 + 0x1p-48)) * (1 - 0x1p-30);
}

static double gains_of(const struct hunt *h, const struct eval_model *m)
{
	double sum = 0;

	for (size_t i = 0; i < h->now->product_count; i++) {
		const struct twins *t = &h->now->products[i];

		if (h->rules.of_product[t->one] > 0 && h->rules.of_product[t->other] > 0)
			sum += gain_of(h, t, m->mul, h->rules.of_product);
	}
	for (size_t i = 0; i < h->now->sum_count; i++)
		sum += gain_of(h, &h->now->sums[i], m->add, h->rules.of_sum);
	for (size_t i = 0; i < h->now->angle_count; i++)
		sum += gain_of(h, &h->now->angles[i], m->sincos, h->rules.of_sum);
	return sum;
}

/* Why there is no bound at node i, or of what its input stands for; of the text's node. */
static struct prove_gap gap_at(const struct hunt *h, uint32_t i, int model)
{
	uint32_t source = h->relaxed->source[i];
	struct prove_gap found = gap_of(&h->rules, i, &h->models[model]);

	if (source && h->coarse->gaps[model][source - 1].why)
		return h->coarse->gaps[model][source - 1];
	found.node = h->relaxed->origin[found.node];
	return found;
}

static struct prove_gap gap_stored(const struct hunt *h, int model, double error)
{
	return (struct prove_gap){PROVE_STORED, h->relaxed->origin[h->x.count - 1], h->now->values.size[h->x.root.i] + error,
		h->models[model].store_largest};
}

/* Over the box in h->rows, whose values are known. */
static double error_of(struct hunt *h, int model)
{
	const struct eval_model *m = &h->models[model];
	double sum = 0, stored;

	h->rules.leaf = h->leaves[model];
	for (uint32_t i = 0; i < h->x.count; i++) {
		double rest;

		if (i && !h->live[i])
			continue;
		h->size[i] = h->now->values.size[h->x.value[i].i];
		rest = rules_node(&h->rules, i, m);
		if (!(rest < (double)INFINITY))
			return gap_note(&h->gaps[model], gap_at(h, i, model));
		if (rest > 0)
			sum += slope_at(h, i) * rest;
	}
	/* sums of up to 2^20 terms; derivatives' own constants are rounded by 2^-64 */
	sum = sum * (1 + 0x1p-30) - gains_of(h, m);
	stored = coarse_stored(m, h->now->values.size[h->x.root.i], sum);
	if (!isfinite(stored))
		return gap_note(&h->gaps[model], gap_stored(h, model, sum));
	return stored;
}

/* Lanes pay in small boxes alone. */
static int is_small(const struct hunt *h, const struct leaf *leaf)
{
	for (int k = 0; k < h->split.dim_count; k++)
		if (leaf->q[k].upper - leaf->q[k].lower > LANES_BELOW)
			return 0;
	return 1;
}

static void examine(void *context, struct leaf *leaf)
{
	struct hunt *h = context;

	for (int k = 0; k < h->split.dim_count; k++)
		h->rows[h->position][h->dims[k]] = leaf->q[k];
	for (int k = 0; k < (is_small(h, leaf) ? VIEWS : 1); k++) {
		struct interval value;

		h->now = &h->views[k];
		norms_evaluate(&h->views[k].norms, (const struct interval *const *)h->rows, &h->views[k].values);
		value = norms_range(&h->views[k].norms, &h->views[k].values, h->x.root.i);
		leaf->value = k ? (struct interval){fmax(value.lower, leaf->value.lower),
					  fmin(value.upper, leaf->value.upper)}
				: value;
		for (int i = 0; i < h->count; i++)
			leaf->sizes[i] = k ? fmin(leaf->sizes[i], error_of(h, i)) : error_of(h, i);
	}
}

/* ---- outputs ---- */

struct job {
	struct prove_row *rows;
	const struct relaxed *r;
	const struct box *b;
	struct coarse coarse; /* of the text */
	struct arena arena;
	const struct eval_model *models;
	int count, failed;
	double deadline;
	struct stint *stints;
	const struct effort *effort;
	_Atomic double *known; /* sharpen.h */
	struct record *record;
};

/* Rows of q that the output depends on and that have room. */
static void list_dims(struct hunt *h)
{
	for (uint32_t i = 0; i < h->x.count; i++) {
		const struct node *n = &h->x.d.nodes[h->x.value[i].i];
		const struct interval *r;

		if (n->op != OP_INPUT || (int)n->arg[0].i != h->position || h->split.dim_count == SPLIT_DIMS)
			continue;
		r = &h->rows[h->position][n->arg[1].i];
		if (r->lower < r->upper)
			h->dims[h->split.dim_count++] = (int)n->arg[1].i;
	}
}

static int rules_make(struct hunt *h)
{
	size_t count = h->x.count;

	h->size = arena_alloc(&h->arena, count, sizeof *h->size);
	h->live = arena_alloc(&h->arena, count, 1);
	h->rules = (struct rules){h->d, h->size, NULL, arena_alloc(&h->arena, count, sizeof(double)),
		arena_alloc(&h->arena, count, sizeof(double)), arena_alloc(&h->arena, count, sizeof(double))};
	if (h->arena.failed)
		return 0;
	h->live[count - 1] = 1;
	dag_mark_operands(h->d, count, h->live);
	return 1;
}

struct box relaxed_box(const struct relaxed *r)
{
	struct box b;

	memcpy(b.rows, r->rows, sizeof b.rows);
	return b;
}

/* How far off inputs are that stand for what the text computes, by model. */
static int leaves_make(struct hunt *h, const struct job *j)
{
	for (int m = 0; m < h->count; m++) {
		h->leaves[m] = arena_alloc(&h->arena, h->x.count, sizeof *h->leaves[m]);
		for (uint32_t i = 0; i < h->x.count && h->leaves[m]; i++)
			h->leaves[m][i] = j->r->source[i] ? j->coarse.running[m][j->r->source[i] - 1] : -1;
	}
	return !h->arena.failed;
}

static int hunt_make(struct hunt *h, const struct job *j, size_t output)
{
	const struct box box = relaxed_box(j->r);

	*h = (struct hunt){.d = &j->r->view.dag, .models = j->models, .count = j->count, .relaxed = j->r, .coarse = &j->coarse};
	arena_init(&h->arena, NULL);
	h->position = dag_find_role(h->d, ROLE_JOINT_POSITION, 0);
	if (!adjoint_make(&h->x, h->d, output, 1, &h->arena) || !box_copy(h->rows, &box, h->d, &h->arena))
		return 0;
	for (int k = 0; k < VIEWS; k++) {
		struct view *v = &h->views[k];

		if (!norms_make(&v->norms, &h->x.d, k, &h->arena) || !twins_find(v, h->d, &h->x, &h->arena) ||
			!norms_lay(&v->norms, &h->arena) || !norms_values_make(&v->values, &v->norms, &h->arena))
			return 0;
	}
	list_dims(h);
	return rules_make(h) && leaves_make(h, j);
}

/* Of all but lanes. */
static int find_caps(struct hunt *h, double seconds)
{
	const struct caps c = {h->rows, h->rows[h->position], h->dims, h->split.dim_count, seconds_now() + seconds};

	return caps_find(&c, &h->views[0].norms, &h->views[0].values, &h->arena);
}

static double whole_error(void *hunt)
{
	struct hunt *h = hunt;

	h->now = &h->views[0];
	norms_evaluate(&h->now->norms, (const struct interval *const *)h->rows, &h->views[0].values);
	return error_of(h, 0);
}

/* What each node makes of it. */
static double *whole_terms(void *hunt)
{
	struct hunt *h = hunt;
	double *terms = arena_alloc(&h->arena, h->x.count, sizeof *terms);
	int is_bounded = isfinite(whole_error(h));

	for (uint32_t i = 0; i < h->x.count && terms && is_bounded; i++)
		terms[i] = h->live[i] ? slope_at(h, i) * rules_node(&h->rules, i, &h->models[0]) : 0;
	return terms;
}

/* From points of q and by knots, beside parts, of all but lanes. */
static int find_sharper(struct hunt *h, const struct job *j, size_t output, double seconds)
{
	const struct effort own = {j->effort->workers, 1, j->deadline, NULL};
	const struct sharpening s = {.text = h->d, .output = output, .x = &h->x, .view = &h->views[0],
		.rows = (const struct interval *const *)h->rows, .position = h->position, .dims = h->dims,
		.dim_count = h->split.dim_count, .relaxed = j->r, .effort = &own, .error = whole_error, .terms = whole_terms,
		.context = h, .known = j->known, .arena = &h->arena};

	double of_node = h->split.dim_count > MANY_ROWS ? SECONDS_OF_PEAKS_MANY : SECONDS_OF_PEAKS;
	double needed = fmax(LEAST_PEAKS * seconds, of_node * (double)h->x.d.count * h->split.dim_count);
	double of_peaks = fmin(SHARE_PEAKS * seconds, needed);

	return sharpen(&s, of_peaks, SHARE_SHARPER * seconds - of_peaks);
}

static void take(const struct hunt *h, struct prove_row *r)
{
	double errors[SPLIT_SIZES];
	struct interval value;

	split_total(&h->split, errors, &value);
	for (int m = 0; m < h->count; m++) {
		r->error_bound[m] = fmin(r->error_bound[m], errors[m] > 0 ? round_up(errors[m]) : 0);
		r->gaps[m] = isfinite(r->error_bound[m]) ? (struct prove_gap){0} : h->gaps[m];
	}
	r->low = fmax(r->low, value.lower);
	r->high = fmin(r->high, value.upper);
}

/* For so long, into the row. */
static int hunt_for(struct hunt *h, const struct job *j, const struct leaf *whole, double seconds, struct prove_row *row)
{
	struct leaf root = *whole;

	split_free(&h->split);
	if (!split_run(&h->split, &root, fmin(j->deadline, seconds_now() + seconds)))
		return 0;
	take(h, row);
	return 1;
}

/* Without caps first: with them a cut by one row alone gains little, and which row to cut by is seen less well. */
static void hunt_output(void *job, size_t piece)
{
	struct job *j = job;
	struct leaf root = {.value = {0, 0}};
	size_t output = j->stints[piece].output;
	double seconds = j->stints[piece].seconds, end = seconds_now() + seconds;
	double plain = (j->record ? SHARE_RECORDED : SHARE_PLAIN) * seconds, left = seconds - plain;
	struct hunt h;
	int done;

	if (seconds_now() > j->deadline)
		return;
	done = hunt_make(&h, j, output);
	for (int k = 0; k < h.split.dim_count && done; k++)
		root.q[k] = h.rows[h.position][h.dims[k]];
	h.split.examine = examine;
	h.split.context = &h;
	done = done && hunt_for(&h, j, &root, plain, &j->rows[output]);
	if (done && j->record)
		done = split_cuts(&h.split, &root, h.dims, j->record->q_rows, &j->record->outputs[output].errors);
	for (int k = 0; k < h.split.dim_count && done; k++)
		h.rows[h.position][h.dims[k]] = root.q[k];
	if (done && h.split.dim_count)
		done = find_caps(&h, SHARE_CAPS * left) && find_sharper(&h, j, output, left) &&
		       find_caps(&h, SHARE_CAPS * left) &&
		       hunt_for(&h, j, &root, end - seconds_now(), &j->rows[output]);
	if (!done)
		j->failed = 1;
	split_free(&h.split);
	arena_free(&h.arena);
}

/* A bound of each that is there at once, or why there is none. */
static int begin(struct job *j)
{
	const struct dag *d = &j->r->text->dag;

	j->known = arena_alloc(&j->arena, j->r->view.dag.count, sizeof *j->known);
	for (size_t i = 0; i < j->r->view.dag.count && j->known; i++)
		j->known[i] = (double)INFINITY;
	if (!j->known || !coarse_find(&j->coarse, d, j->b, j->models, j->count, &j->arena))
		return 0;
	for (size_t o = 0; o < d->output_count; o++)
		for (int m = 0; m < j->count; m++)
			j->rows[o].error_bound[m] = coarse_output(&j->coarse, d, o, m, &j->models[m], &j->rows[o].gaps[m]);
	return 1;
}

int rounding_find(struct prove_row *rows, const struct relaxed *r, const struct box *b, const struct eval_model *models,
	int count, const struct effort *x, double seconds)
{
	size_t outputs = r->view.dag.output_count;
	struct job j = {.rows = rows,
		.r = r,
		.b = b,
		.models = models,
		.count = count,
		.deadline = x->deadline,
		.effort = x,
		.record = x->record};

	arena_init(&j.arena, NULL);
	if (begin(&j) && (j.stints = stints_make(&r->view.dag, x->record ? 1 : EQUALLY, x->threads, seconds, &j.arena)))
		workers_run(x->workers, x->threads, hunt_output, &j, outputs);
	else
		j.failed = 1;
	arena_free(&j.arena);
	return !j.failed;
}
