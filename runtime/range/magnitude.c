#define _POSIX_C_SOURCE 200809L
#include "range/magnitude.h"
#include "core/seconds.h"
#include "norms/adjoint.h"
#include "norms/norms.h"
#include "range/split.h"
#include "dag/derive.h"
#include <math.h>
#include <string.h>

/* Grids of more dimensions are too large, and then nobody asks for second derivatives. */
enum { MOST_DIMS = 12 };

static struct interval range_of(const struct field_dim *k, int is_whole)
{
	int is_turn = k->is_angle && (is_whole || k->is_circle);

	return is_turn ? interval_turn() : (struct interval){k->lower, k->upper};
}

struct job {
	struct interval *ranges;
	const struct field *f;
	const struct box *b;
	int is_whole, failed;
	double seconds, deadline;
	struct record *record;
};

/* One output. */
struct values {
	struct adjoint x;
	struct norms norms;
	struct interval *rows[DAG_ARGUMENTS];
	struct norms_values values;
	const struct field *f;
	int position;
	struct arena arena;
};

static void examine(void *context, struct leaf *leaf)
{
	struct values *v = context;

	for (int k = 0; k < v->f->dim_count; k++)
		v->rows[v->position][v->f->dims[k].row] = leaf->q[k];
	norms_evaluate(&v->norms, (const struct interval *const *)v->rows, &v->values);
	leaf->value = norms_range(&v->norms, &v->values, v->x.root.i);
	memset(leaf->sizes, 0, sizeof leaf->sizes);
	leaf->sizes[0] = interval_size(leaf->value);
}

static int values_make(struct values *v, const struct job *j, size_t output)
{
	const struct dag *d = j->f->d;

	*v = (struct values){.f = j->f, .position = dag_find_role(d, ROLE_JOINT_POSITION, 0)};
	arena_init(&v->arena, NULL);
	if (!adjoint_make(&v->x, d, (size_t)j->f->outputs[output], 0, &v->arena) || !norms_make(&v->norms, &v->x.d, 0, &v->arena) ||
		!norms_lay(&v->norms, &v->arena))
		return 0;
	return norms_values_make(&v->values, &v->norms, &v->arena) && box_copy(v->rows, j->b, d, &v->arena);
}

static int record_cuts(const struct job *j, size_t output, const struct split *s, const struct leaf *root)
{
	int rows[SPLIT_DIMS];

	for (int k = 0; k < s->dim_count; k++)
		rows[k] = j->f->dims[k].row;
	return split_cuts(s, root, rows, j->record->q_rows, &j->record->outputs[j->f->outputs[output]].values);
}

static void find(void *job, size_t output)
{
	struct job *j = job;
	struct split s = {.dim_count = j->f->dim_count, .examine = examine};
	struct leaf root = {.value = {0, 0}};
	struct values v;
	double sizes[SPLIT_SIZES];

	j->ranges[output] = (struct interval){-(double)INFINITY, (double)INFINITY};
	if (seconds_now() > j->deadline)
		return;
	for (int k = 0; k < s.dim_count; k++)
		root.q[k] = range_of(&j->f->dims[k], j->is_whole);
	s.context = &v;
	if (values_make(&v, j, output) && split_run(&s, &root, fmin(j->deadline, seconds_now() + j->seconds)))
		split_total(&s, sizes, &j->ranges[output]);
	else
		j->failed = 1;
	if (!j->failed && j->record)
		j->failed |= !record_cuts(j, output, &s, &root);
	split_free(&s);
	arena_free(&v.arena);
}

int magnitude_find(struct interval *ranges, const struct field *f, const struct box *b, int is_whole, const struct effort *x,
	double seconds)
{
	size_t outputs = (size_t)f->output_count, rounds = (outputs + x->threads - 1) / x->threads;
	struct job j = {ranges, f, b, is_whole, 0, seconds / (double)(rounds ? rounds : 1), x->deadline,
		is_whole ? NULL : x->record};

	workers_run(x->workers, x->threads, find, &j, outputs);
	return !j.failed;
}

/* ---- second derivatives ---- */

/* Of one output by one row of q; -1 when memory runs out. */
static double bend_of(const struct job *j, size_t output, const struct field_dim *dim)
{
	struct values v = {.f = j->f, .position = dag_find_role(j->f->d, ROLE_JOINT_POSITION, 0)};
	double size = -1;

	arena_init(&v.arena, NULL);
	if (adjoint_make(&v.x, j->f->d, (size_t)j->f->outputs[output], 0, &v.arena) &&
		derive_by(&v.x.d, &v.x.root, v.position, dim->row) && derive_by(&v.x.d, &v.x.root, v.position, dim->row) &&
		norms_make(&v.norms, &v.x.d, 0, &v.arena) && norms_lay(&v.norms, &v.arena) &&
		norms_values_make(&v.values, &v.norms, &v.arena) && box_copy(v.rows, j->b, j->f->d, &v.arena)) {
		for (int k = 0; k < j->f->dim_count; k++)
			v.rows[v.position][j->f->dims[k].row] = range_of(&j->f->dims[k], 1);
		norms_evaluate(&v.norms, (const struct interval *const *)v.rows, &v.values);
		size = v.values.size[v.x.root.i];
	}
	arena_free(&v.arena);
	return size >= 0 || size < 0 ? size : (double)INFINITY;
}

struct bends_job {
	struct job j;
	double *most;
};

static void find_bends(void *job, size_t output)
{
	struct bends_job *b = job;
	int n = b->j.f->dim_count;

	for (int k = 0; k < n; k++) {
		int is_late = n > MOST_DIMS || seconds_now() > b->j.deadline;
		double size = is_late ? (double)INFINITY : bend_of(&b->j, output, &b->j.f->dims[k]);

		b->j.failed |= size < 0;
		b->most[output * (size_t)n + (size_t)k] = size * (1 + 0x1p-30);
	}
}

int magnitude_bends(double *most, const struct field *f, const struct box *b, const struct effort *x)
{
	struct bends_job job = {{.f = f, .b = b, .is_whole = 1, .deadline = x->deadline}, most};

	workers_run(x->workers, x->threads, find_bends, &job, (size_t)f->output_count);
	return !job.j.failed;
}
