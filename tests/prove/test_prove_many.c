/* Every proved range and error of two robots holds in very many states: drawn, corners, and the worst that a search finds and
   others near them. Exact values are those in extended precision, which are off by far less than is allowed. It would catch a
   bound that fails in few states alone. RNEAGEN_ALL: a million states of each robot. */
#include "dag/eval.h"
#include "prove/robot_box.h"
#include "prove/states.h"
#include "support/exhaustive.h"
#include "support/suite.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { SEED = 24, FEW = 10000, MANY = 1000000, PIECES = 64, NEAR = 20 };

static const struct many_case {
	const char *name, *scene;
} CASES[] = {
	{"ur5", "range qdd=-20,20"},
	{"floating:hyq", "range qdd=-20,20\nrange qd=-2,2\nfriction\ndamping"},
};

/* One thread's room: a state in doubles, floats and extended precision, and what comes of it. */
struct many_room {
	double *in[DAG_ARGUMENTS], *out[DAG_ARGUMENTS];
	float *in_f32[DAG_ARGUMENTS], *out_f32[DAG_ARGUMENTS];
	real *in_real[DAG_ARGUMENTS], *out_real[DAG_ARGUMENTS];
};

struct many {
	struct robot_box *x;
	const struct proof *p;
	struct states s;
	double *(*best)[2];
	int count, broken;
};

static void room_make(struct many_room *r, const struct dag *d)
{
	memset(r, 0, sizeof *r);
	for (int i = 0; i < d->argument_count; i++) {
		size_t rows = (size_t)d->arguments[i].rows + 1;
		int is_output = d->arguments[i].is_output;

		*(is_output ? &r->out[i] : &r->in[i]) = calloc(rows, sizeof(double));
		*(is_output ? &r->out_f32[i] : &r->in_f32[i]) = calloc(rows, sizeof(float));
		*(is_output ? &r->out_real[i] : &r->in_real[i]) = calloc(rows, sizeof(real));
	}
}

static void room_free(struct many_room *r)
{
	for (int i = 0; i < DAG_ARGUMENTS; i++) {
		free(r->in[i]);
		free(r->out[i]);
		free(r->in_f32[i]);
		free(r->out_f32[i]);
		free(r->in_real[i]);
		free(r->out_real[i]);
	}
}

/* Of floats that are in the box, or as it is. */
static void load(const struct many *m, struct many_room *r, int is_float)
{
	const struct dag *d = &m->x->analysis.dag;

	for (int i = 0; i < d->argument_count; i++)
		for (int k = 0; r->in[i] && k < d->arguments[i].rows; k++) {
			struct interval range = m->x->box.rows[i][k];
			float f = (float)r->in[i][k];

			if (range.lower <= range.upper && (double)f > range.upper)
				f = nextafterf(f, -INFINITY);
			if (range.lower <= range.upper && (double)f < range.lower)
				f = nextafterf(f, INFINITY);
			r->in[i][k] = is_float ? (double)f : r->in[i][k];
			r->in_f32[i][k] = f;
			r->in_real[i][k] = (real)r->in[i][k];
		}
}

static real value_of(const struct many_room *r, const struct output *o, int precision)
{
	return precision == 0 ? (real)r->out_f32[o->argument][o->row] : precision == 1 ? (real)r->out[o->argument][o->row]
											: r->out_real[o->argument][o->row];
}

/* Floats beside doubles; or doubles beside extended precision, whose errors are 2^-11 of those. */
static int check(const struct many *m, struct many_room *r, int precision)
{
	const struct dag *d = &m->x->analysis.dag;
	int broken = 0;

	load(m, r, precision == 0);
	ck_assert(eval_f64(d, (const double *const *)r->in, r->out, NULL));
	ck_assert(precision ? eval_real(d, (const real *const *)r->in_real, r->out_real, NULL)
			    : eval_f32(d, (const float *const *)r->in_f32, r->out_f32, NULL));
	for (size_t o = 0; o < d->output_count; o++) {
		const struct prove_row *row = &m->p->rows[o];
		real near = value_of(r, &d->outputs[o], precision + 1), off = (real)row->error_bound[1] * (precision ? 0x1p-9L : 1);

		broken += !(near >= (real)row->low - off && near <= (real)row->high + off);
		broken += !(fabsl(value_of(r, &d->outputs[o], precision) - near) <= (real)row->error_bound[precision] + off);
	}
	return broken;
}

static void draw(const struct many *m, struct many_room *r, struct rng *rng, unsigned short seed[3])
{
	const struct dag *d = &m->x->analysis.dag;
	size_t output = (size_t)rng_below(rng, (int)d->output_count);
	const double *best = m->best[output][rng_below(rng, 2)];

	states_draw(&m->s, r->in, seed);
	for (int i = 0; i < d->argument_count; i++)
		for (int k = 0; r->in[i] && k < d->arguments[i].rows && rng_below(rng, NEAR) == 0; k++)
			r->in[i][k] = best[m->s.at[i] + (size_t)k];
	if (rng_below(rng, 4) == 0)
		for (int i = 0; i < d->argument_count; i++)
			for (int k = 0; r->in[i] && k < d->arguments[i].rows; k++) {
				struct interval range = m->x->box.rows[i][k];
				double at = rng_uniform(rng, 0, 1);

				if (range.lower <= range.upper)
					r->in[i][k] = rng_chance(rng, 0.5) ? best[m->s.at[i] + (size_t)k] : range.lower + at * (range.upper - range.lower);
			}
	states_settle(&m->s, r->in);
}

static void check_piece(void *job, size_t piece)
{
	struct many *m = job;
	struct rng rng = rng_seed(SEED + piece);
	unsigned short seed[3] = {SEED, (unsigned short)piece, 3};
	struct many_room r;
	int broken = 0;

	room_make(&r, &m->x->analysis.dag);
	for (int i = 0; i < m->count / PIECES; i++) {
		draw(m, &r, &rng, seed);
		broken += check(m, &r, i % 16 == 0);
	}
	__atomic_fetch_add(&m->broken, broken, __ATOMIC_RELAXED);
	room_free(&r);
}

/* The states that a search finds, themselves. */
static int check_best(const struct many *m)
{
	const struct dag *d = &m->x->analysis.dag;
	struct many_room r;
	int broken = 0;

	room_make(&r, d);
	for (size_t o = 0; o < d->output_count; o++)
		for (int side = 0; side < 2; side++)
			for (int precision = 0; precision < 2; precision++) {
				for (int i = 0; i < d->argument_count; i++)
					for (int k = 0; r.in[i] && k < d->arguments[i].rows; k++)
						r.in[i][k] = m->best[o][side][m->s.at[i] + (size_t)k];
				broken += check(m, &r, precision);
			}
	room_free(&r);
	return broken;
}

START_TEST(test_many)
{
	struct effort effort = robot_box_effort();
	struct prove_options options = {{RNEAGEN_F32, RNEAGEN_F64}, 2, 2, 2, 0, NULL, NULL};
	struct progress silent = {0};
	struct rneagen_error e = {0};
	struct robot_box x;
	struct proof p;
	struct many m = {.x = &x, .p = &p, .count = exhaustive() ? MANY : sanitized() ? FEW / 20 : FEW};
	double (*values)[2];
	size_t outputs;

	robot_box_open(&x, CASES[_i].name, CASES[_i].scene, 0);
	outputs = x.analysis.dag.output_count;
	ck_assert_msg(!prove(&p, &x.analysis, &x.box, &options, &silent, &e), "%s", e.message);
	states_of(&m.s, &x.analysis, &x.box);
	values = arena_alloc(&x.arena, outputs, sizeof *values);
	m.best = arena_alloc(&x.arena, outputs, sizeof *m.best);
	for (size_t o = 0; o < outputs; o++)
		for (int side = 0; side < 2; side++)
			m.best[o][side] = arena_alloc(&x.arena, m.s.size, sizeof(double));
	ck_assert(states_seek(&m.s, values, m.best, &effort, exhaustive() ? 4 : 0.5));
	ck_assert_int_eq(check_best(&m), 0);
	workers_run(effort.workers, effort.threads, check_piece, &m, PIECES);
	ck_assert_msg(m.broken == 0, "%s: %d of %d states and their rows are out of what is proved", CASES[_i].name, m.broken, m.count);
	workers_close(effort.workers);
	free(p.rows);
	robot_box_close(&x);
}
END_TEST

int main(void)
{
	Suite *suite = suite_create("prove many");

	suite_add(suite, "many", test_many, (int)(sizeof CASES / sizeof *CASES), 600);
	return suite_run(suite);
}
