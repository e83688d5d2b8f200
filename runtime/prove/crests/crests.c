#define _POSIX_C_SOURCE 200809L
#include "prove/crests/crests.h"
#include "core/seconds.h"
#include "prove/crests/frontier.h"
#include "prove/ranging.h"
#include "range/knots.h"
#include "range/magnitude.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { MOST_NUMBERS = 1 << 25, MOST_DEGREE = 4, LENGTH_DEGREE = 2, LOWERED = 2 };

/* Of the time of a crest: for curvature, the rest is for the cover. */
#define SHARE_BENDS 0.5
#define SHARE_WHOLE 0.03 /* where it is cut: for its magnitude over all angles */
/* Of what was found: less is of no interest. What is cut comes out larger, but for what depends on q alone. */
#define FLOOR 0.8
#define FLOOR_CUT 1.4

/* Crests of one field. */
struct cresting {
	const struct crests *c;
	struct crest **list; /* by output of `relaxed` */
	size_t count;
	struct relaxed relaxed; /* its view has these outputs */
	struct arena arena;
};

/* ---- what fits ---- */

double crests_knots(const struct peaks *p, const struct peak *k, int is_lowered)
{
	double knots = 1;

	for (int i = 0; i < p->dim_count; i++) {
		int degree = !p->is_angle[i] ? 1 : is_lowered && k->degrees[i] > LOWERED ? LOWERED : k->degrees[i];

		knots *= k->dims >> i & 1 ? 2 * degree + 1 : 1;
	}
	return knots;
}

/* Where rates are drives: it is linear in them, and all that it is multiplied by depends on known rows of q. */
static int is_of_drives(const struct peak *k)
{
	return k->kind == PEAK_LINEAR && !k->cut;
}

double crests_numbers(const struct peak *k)
{
	int n = k->rates, m = k->drives;

	return is_of_drives(k) ? 1 + m + n : 1 + m + n + n * (n + 1) / 2;
}

double crests_together(const struct peaks *p, const struct peak *k)
{
	return floor(MOST_NUMBERS / (crests_knots(p, k, 0) * (crests_numbers(k) + FIELD_VECTOR - 1)));
}

int crests_are_known(const struct peak *k)
{
	return k->kind != PEAK_UNKNOWN && k->found > 0 && isfinite(k->whole);
}

int crests_fit(const struct peaks *p, const struct peak *k)
{
	for (int i = 0; i < p->dim_count; i++)
		if (k->dims >> i & 1 && k->degrees[i] > (p->is_angle[i] ? MOST_DEGREE : LENGTH_DEGREE))
			return 0;
	return crests_together(p, k) >= 1;
}

/* ---- a field ---- */

static const struct peak *peak_of(const struct cresting *g, const struct field *f, int o)
{
	return g->list[f->outputs[o]]->peak;
}

/* By what is known of the expressions; the field takes them for torques. Nothing is known of an angle that has one
 * value. */
static void set_degree(const struct cresting *g, struct field *f, struct field_dim *k)
{
	const struct peaks *p = g->c->p;
	int at = 0;

	while (at < p->dim_count && p->dims[at] != k->row)
		at++;
	if (at == p->dim_count || !p->is_angle[at]) {
		f->has_grid = 0;
		return;
	}
	k->degree = 1;
	for (int o = 0; o < f->output_count; o++)
		k->degree = peak_of(g, f, o)->degrees[at] > k->degree ? peak_of(g, f, o)->degrees[at] : k->degree;
}

/* Nothing is known but the size; what waves that cancel leave is part of that. With inputs of its own it is larger. */
static int begin(const struct cresting *g, const struct field *f, struct ranging *r, const struct effort *x, double seconds)
{
	struct box box;

	memcpy(box.rows, g->relaxed.rows, sizeof box.rows);
	if (g->list[0]->peak->cut && !magnitude_find(r->whole, f, &box, 1, x, seconds))
		return 0;
	for (int o = 0; o < f->output_count; o++) {
		const struct peak *of = peak_of(g, f, o);
		double size = of->cut ? interval_size(r->whole[o]) : of->whole, whole = round_up(size * (1 + 0x1p-40) + f->noise[o]);

		r->whole[o] = (struct interval){-whole, whole};
		for (int k = 0; k < f->dim_count; k++)
			r->bends[o * f->dim_count + k] = (double)INFINITY;
	}
	return 1;
}

static void take(const struct cresting *g, const struct field *f, const struct ranging *r)
{
	for (int o = 0; o < f->output_count; o++) {
		struct crest *c = g->list[f->outputs[o]];

		c->most = interval_least(fmax(r->cover.upper[o], -r->cover.lower[o]), c->most);
	}
}

static int find_by_knots(const struct cresting *g, struct field *f, struct ranging *r)
{
	struct effort own = *g->c->effort;
	double seconds = 0, of_bends;
	struct curvature_start bent = {r->whole, r->largest, r->bends, &r->knots};
	struct cover_start covered = {.found = (const double(*)[2])r->found, .knots = &r->knots};

	for (int o = 0; o < f->output_count; o++)
		seconds += g->list[f->outputs[o]]->cost;
	own.deadline = fmin(own.deadline, seconds_now() + 4 * seconds);
	if (!knots_make(&r->knots, f, &own, 2 * seconds))
		return 1;
	if (!knots_lower(&r->knots, f))
		return 0;
	if (!begin(g, f, r, &own, SHARE_WHOLE * seconds))
		return 0;
	of_bends = SHARE_BENDS * seconds;
	own.deadline = fmin(own.deadline, seconds_now() + 1.5 * seconds);
	if (!curvature_find(&r->curvature, f, &bent, &own, of_bends))
		return 0;
	covered.bends = r->curvature.most;
	covered.pace = r->curvature.speed;
	if (!cover_find(&r->cover, f, &covered, &own, seconds - of_bends))
		return 0;
	take(g, f, r);
	return 1;
}

static int find_field(const struct cresting *g, struct field *f)
{
	struct sought(*found)[2] = calloc((size_t)f->output_count, sizeof *found);
	struct ranging r = {0};
	int done = found != NULL;

	for (int k = 0; k < f->dim_count; k++)
		if (f->dims[k].is_angle)
			set_degree(g, f, &f->dims[k]);
	for (int o = 0; o < f->output_count && done; o++) {
		const struct peak *k = peak_of(g, f, o);

		found[o][1].value = (k->cut && k->kind != PEAK_PLAIN ? FLOOR_CUT : FLOOR) * k->found / (k->pair ? sqrt(2) : 1);
		found[o][0].value = -found[o][1].value;
	}
	done = done && ranging_make(&r, f, (const struct sought(*)[2])found) &&
	       (!f->has_grid || find_by_knots(g, f, &r));
	if (found)
		ranging_free(&r);
	free(found);
	return done;
}

/* ---- groups ---- */

static int cut_make(struct cresting *g, const struct peak *k)
{
	uint32_t *nodes = arena_alloc(&g->arena, g->count, sizeof *nodes);

	for (size_t i = 0; i < g->count && nodes; i++)
		nodes[i] = g->list[i]->node;
	return nodes && frontier_cut(&g->relaxed, g->c->relaxed, g->c->p, k, nodes, g->count, &g->arena);
}

/* The text's DAG with these nodes of the adjoint as outputs; where they are linear in rates, these are drives. */
static int outputs_make(struct cresting *g)
{
	const struct peak *k = g->list[0]->peak;
	const struct dag *d = &g->c->p->x->d;
	int argument = g->c->p->text->outputs[g->c->p->output].argument,
	    rates = dag_find_role(d, ROLE_JOINT_VELOCITY, 0);
	struct dag *to = &g->relaxed.view.dag;

	if (k->cut)
		return cut_make(g, k);
	g->relaxed = *g->c->relaxed;
	*to = *d;
	to->outputs = arena_alloc(&g->arena, g->count, sizeof *to->outputs);
	to->output_count = g->count;
	for (size_t i = 0; i < g->count && to->outputs; i++)
		to->outputs[i] = (struct output){argument, (int)i, {g->list[i]->node}};
	if (is_of_drives(k) && rates >= 0)
		to->arguments[rates].role = ROLE_JOINT_ACCELERATION;
	return to->outputs != NULL;
}

static int find_group(struct cresting *g)
{
	struct field *fields;
	struct rneagen_error e = {0};
	int is_made, done, count;

	arena_init(&g->arena, NULL);
	is_made = outputs_make(g);
	done = is_made || !g->arena.failed;
	count = is_made ? field_split(&fields, &g->relaxed, &g->arena, &e) : 0;
	for (int k = 0; k < count && done && seconds_now() < g->c->effort->deadline; k++)
		done = find_field(g, &fields[k]);
	arena_free(&g->arena);
	return done && e.code != RNEAGEN_MEMORY;
}

static int is_of(const struct peaks *p, const struct peak *a, const struct peak *b)
{
	return a->kind == b->kind && a->dims == b->dims && a->cut == b->cut && !memcmp(a->degrees, b->degrees, (size_t)p->dim_count);
}

int crests_find(const struct crests *c, struct crest *list, size_t count)
{
	struct cresting g = {.c = c, .list = malloc((count + 1) * sizeof *g.list)};
	unsigned char *is_taken = calloc(count + 1, 1);
	int done = g.list && is_taken;

	for (size_t i = 0; i < count && done; i++) {
		const struct peak *k = list[i].peak;
		double room = crests_together(c->p, k);

		g.count = 0;
		for (size_t o = i; o < count && !is_taken[i]; o++)
			if (!is_taken[o] && is_of(c->p, k, list[o].peak) && (double)g.count < room) {
				is_taken[o] = o != i;
				g.list[g.count++] = &list[o];
			}
		done = !g.count || seconds_now() > c->effort->deadline || find_group(&g);
	}
	free(g.list);
	free(is_taken);
	return done;
}
