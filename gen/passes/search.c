#include "passes/search.h"
#include "passes/accuracy.h"
#include "passes/frames.h"
#include "passes/path.h"
#include <float.h>
#include <limits.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Sweeps over all bodies; how far a frame may be from its link, in longest distances between joints; bodies times
   operations, beyond which frames stay where they are, since trying others takes long; how far off torques may be, in
   what they are off as the tree is. */
enum { SWEEPS = 4, FARTHEST = 2, WORK = 1500000 };
static const double WORST = 1.15;
/* How far a frame may be from where the file's decimals have it, in radians, or longest distances. */
static const double VAGUE = 1e-14;
static const struct draw_options SAMPLES = {.seed = 16, .count = 64, .each = 1};

/* States in which it is measured: drawn as draw.h says; and with joints so fast that Coriolis terms are all there is, one
   forward and the next one back, so that they cancel where axes are parallel. */
enum { ORDINARY, FAST, STATES };
enum { FAST_RATE = 300 };

struct measure {
	struct drawn inputs;
	const real *reference; /* torques of the inputs, by the tree as it is */
	struct accuracy worst;
};

struct search {
	const struct tree *t;
	const char *keeps;
	struct restatement *by;
	char *waits;      /* by body: it or its neighbours have changed since it was tried */
	struct tree now;  /* as `by` has it */
	struct path path; /* of the body that is tried */
	long stated, least; /* operations: of the tree as it is, and by the choices so far */
	int is_careful;     /* errors are measured at each step */
	real farthest;
	struct measure in[STATES];
	struct arena own, of_now; /* of `now` */
	const struct rneagen_allocator *allocator;
	struct rneagen_error *e;
};

/* ---- trials ---- */

/* What a body that is restated so costs on its path. */
static struct cost cost_of(const struct search *s, int body, const struct cost *least)
{
	struct cost x = path_cost(&s->path, &s->by[body], least, s->allocator);

	if (x.flops < 0)
		error_memory(s->e);
	return x;
}

static int is_known(const struct turn *a)
{
	return within_error(a->s) <= VAGUE && within_error(a->c) <= VAGUE;
}

/* A frame that is neither far off nor, by the decimals of the file, here as well as there. */
static int is_near(const struct search *s, const struct restatement *r)
{
	for (int i = 0; i < 3; i++)
		if (!(fabsl(r->slide[i].x) <= FARTHEST * s->farthest) || within_error(r->slide[i]) > VAGUE * (double)s->farthest)
			return 0;
	return is_known(&r->turn) && is_known(&r->ahead);
}

/* In all states? -1: no memory. */
static int is_accurate(const struct search *s, const struct dag *d, struct arena *spare)
{
	struct accuracy x;

	for (const struct measure *m = s->in; m < s->in + STATES; m++) {
		if (!accuracy_measure(&x, d, &m->inputs, m->reference, spare))
			return -1;
		if (!(x.whole <= WORST * m->worst.whole && x.each <= WORST * m->worst.each))
			return 0;
	}
	return 1;
}

/* The choices as they are now, if the whole tree costs less with them and, in a careful search, is accurate enough. */
static int take(struct search *s)
{
	struct arena spare, of_now;
	struct tree now;
	struct dag d;
	long flops = -1;
	int is_taken = 0;

	arena_init(&spare, s->allocator);
	arena_init(&of_now, s->allocator);
	if (tree_restate(&now, s->t, s->by, &of_now)) {
		torques_build(&d, &now, &spare);
		flops = torques_flops(&d, &spare);
	}
	if (flops >= 0 && flops < s->least)
		is_taken = s->is_careful ? is_accurate(s, &d, &spare) : 1;
	if (flops < 0 || is_taken < 0)
		error_memory(s->e);
	arena_free(&spare);
	if (is_taken > 0) {
		arena_free(&s->of_now);
		s->of_now = of_now;
		s->now = now;
		s->least = flops;
	} else {
		arena_free(&of_now);
	}
	return is_taken > 0;
}

static void wait(struct search *s, int body)
{
	s->waits[body] = 1;
	if (s->t->bodies[body].parent >= 0)
		s->waits[s->t->bodies[body].parent] = 1;
	for (int i = body + 1; i < s->t->body_count; i++)
		s->waits[i] |= s->t->bodies[i].parent == body;
}

/* The cheapest of some choices for a body, where one is cheaper than what it has, which costs *least. */
static void improve(struct search *s, int body, const struct frames *f, struct cost *least)
{
	if (f->count && least->flops == LONG_MAX)
		*least = cost_of(s, body, least);
	for (int i = 0; i < f->count && !s->e->code; i++) {
		struct restatement before = s->by[body];
		struct cost x;

		s->by[body] = f->of[i];
		x = is_near(s, &f->of[i]) ? cost_of(s, body, least) : *least;
		if (x.flops < least->flops && !s->e->code && take(s)) {
			*least = x;
			wait(s, body);
		} else {
			s->by[body] = before;
		}
	}
}

static void improve_regroup(struct search *s, int body, struct cost *least)
{
	struct frames f = {.count = 0};

	for (int i = 0; i < REGROUP_COUNT; i++)
		if (i != (int)s->by[body].regroup && !s->keeps[body]) {
			f.of[f.count] = s->by[body];
			f.of[f.count++].regroup = (enum regroup)i;
		}
	improve(s, body, &f, least);
}

static void improve_body(struct search *s, int body)
{
	static void (*const listings[])(struct frames *f, const struct tree *now, const struct restatement *by, int body) = {
		frames_turned, frames_split, frames_slid};
	struct arena own;
	struct tree around;
	struct frames f;
	struct cost least = PATH_COST_UNKNOWN;

	arena_init(&own, s->allocator);
	s->waits[body] = 0;
	if (!tree_restate_around(&around, s->t, s->by, body, &own) || !path_make(&s->path, &around, s->by, body, &own))
		error_memory(s->e);
	for (size_t i = 0; i < sizeof listings / sizeof *listings && !s->e->code; i++) {
		listings[i](&f, &s->now, s->by, body);
		improve(s, body, &f, &least);
	}
	if (!s->e->code)
		improve_regroup(s, body, &least);
	arena_free(&own);
}

/* ---- the whole ---- */

static real farthest(const struct tree *t)
{
	real most = 0;

	for (int k = 0; k < t->body_count; k++) {
		const struct within *p = t->bodies[k].X.p;

		most = fmaxl(most, sqrtl(p[0].x * p[0].x + p[1].x * p[1].x + p[2].x * p[2].x));
	}
	return most;
}

static void make_fast(struct drawn_array *qd, const struct tree *t, size_t samples)
{
	for (size_t s = 0; s < samples; s++) {
		double *rates = qd->values + s * (size_t)qd->rows;
		int before = 0;

		for (int i = 0; i < t->joint_count; i++)
			for (int row = t->joints[i].iv; row < t->joints[i].iv + t->joints[i].nv; row++)
				rates[row] = before++ % 2 ? -FAST_RATE : FAST_RATE;
	}
}

static int compare_bodies(const void *a, const void *b)
{
	const struct tree_joint *x = a, *y = b;

	return (x->body > y->body) - (x->body < y->body);
}

/* States are drawn joint by joint: body by body here, so that frames do not go by the order of the rows. Returns 0 when memory
   runs out. */
static int sort_joints(struct tree *by_body, const struct tree *t, struct arena *a)
{
	*by_body = *t;
	by_body->joints = arena_alloc(a, (size_t)t->joint_count, sizeof *by_body->joints);
	if (!by_body->joints)
		return 0;
	memcpy(by_body->joints, t->joints, (size_t)t->joint_count * sizeof *t->joints);
	qsort(by_body->joints, (size_t)t->joint_count, sizeof *t->joints, compare_bodies);
	return 1;
}

static int measure_in(struct search *s, struct measure *m, const struct tree *by_body, const struct dag *d, int is_fast,
	struct arena *spare)
{
	if (!draw_inputs(&m->inputs, by_body, &TORQUES_REQUEST, &SAMPLES, &s->own))
		return 0;
	if (is_fast)
		make_fast(&m->inputs.arrays[DRAWN_QD], by_body, m->inputs.samples);
	m->reference = accuracy_reference(d, &m->inputs, &s->own);
	return m->reference && accuracy_measure(&m->worst, d, &m->inputs, m->reference, spare);
}

static int is_subnormal(struct within x)
{
	return x.x != 0 && fabsl(x.x) < FLT_MIN;
}

/* Inertias that floats hold with few digits: whatever is taken off or added, others are lost. */
static int has_subnormals(const struct tree *t)
{
	for (int k = 0; k < t->body_count; k++) {
		const struct inertia *I = &t->bodies[k].inertia;
		int found = is_subnormal(I->mass);

		for (int i = 0; i < 6; i++)
			found |= is_subnormal(I->I[i]) || is_subnormal(I->h[i / 2]);
		if (found)
			return 1;
	}
	return 0;
}

/* How accurate the tree is as it stands. */
static int measure(struct search *s)
{
	struct arena spare;
	struct tree by_body;
	struct dag d;
	int done;

	arena_init(&spare, s->allocator);
	torques_build(&d, s->t, &spare);
	s->stated = torques_flops(&d, &spare);
	done = s->stated >= 0 && sort_joints(&by_body, s->t, &spare);
	for (int i = 0; i < STATES && done; i++)
		done = measure_in(s, &s->in[i], &by_body, &d, i == FAST, &spare);
	arena_free(&spare);
	return done;
}

static int alloc(struct search *s)
{
	s->waits = arena_alloc(&s->own, (size_t)s->t->body_count, 1);
	s->farthest = farthest(s->t);
	return s->waits && measure(s) && tree_restate(&s->now, s->t, s->by, &s->of_now);
}

/* Each body regrouped so, where it may be, in the frame that it has; then all that is cheaper. Returns 0 where that is
   not accurate. */
static int sweep_all(struct search *s, enum regroup how)
{
	int waiting = s->t->body_count * s->stated <= WORK;

	for (int k = 0; k < s->t->body_count; k++) {
		s->by[k] = (struct restatement){.turn = TURN_NONE, .ahead = TURN_NONE,
			.regroup = s->keeps[k] ? REGROUP_NOTHING : how};
		s->waits[k] = 1;
	}
	s->least = LONG_MAX;
	if (!take(s))
		return 0;
	for (int sweep = 0; sweep < SWEEPS && waiting && !s->e->code; sweep++) {
		waiting = 0;
		for (int b = s->t->body_count - 1; b >= 0 && !s->e->code; b--)
			if (s->waits[b])
				improve_body(s, b);
		for (int b = 0; b < s->t->body_count; b++)
			waiting |= s->waits[b];
	}
	return 1;
}

static int is_now_accurate(struct search *s)
{
	struct arena spare;
	struct dag d;
	int found;

	arena_init(&spare, s->allocator);
	torques_build(&d, &s->now, &spare);
	found = d.failed ? -1 : is_accurate(s, &d, &spare);
	arena_free(&spare);
	if (found < 0)
		error_memory(s->e);
	return found > 0;
}

/* Errors take long to measure, so first without, and carefully where what was found is not accurate. */
static int run(struct search *s, enum regroup how)
{
	s->is_careful = 0;
	if ((sweep_all(s, how) && is_now_accurate(s)) || s->e->code)
		return 1;
	s->is_careful = 1;
	return sweep_all(s, how);
}

/* Whether regrouping pays is seen when all is; where it does not, each body is tried by itself. */
enum rneagen_code search_params(struct restatement *by, const struct tree *t, const char *keeps,
	const struct rneagen_allocator *allocator, struct rneagen_error *e)
{
	struct search s = {.t = t, .keeps = keeps, .by = by, .allocator = allocator, .e = e};

	for (int k = 0; k < t->body_count; k++)
		by[k] = (struct restatement){.turn = TURN_NONE, .ahead = TURN_NONE};
	if (has_subnormals(t))
		return RNEAGEN_OK;
	arena_init(&s.own, allocator);
	arena_init(&s.of_now, allocator);
	if (!alloc(&s))
		error_memory(e);
	if (!e->code && (!run(&s, REGROUP_SECOND) || s.least > s.stated) && !e->code)
		run(&s, REGROUP_NOTHING);
	arena_free(&s.own);
	arena_free(&s.of_now);
	return e->code;
}
