#define _POSIX_C_SOURCE 200809L
#include "range/magnitude.h"
#include "core/seconds.h"
#include "norms/adjoint.h"
#include "norms/norms.h"
#include "norms/split.h"
#include <math.h>
#include <string.h>

/* above pi */
static const double PI_ABOVE = 0x1.921fb54442d19p+1;

struct job {
	struct interval *ranges;
	const struct field *f;
	const struct box *b;
	int is_whole, failed;
	double seconds, deadline;
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

static void find(void *job, size_t output)
{
	struct job *j = job;
	struct split s = {.dim_count = j->f->dim_count, .examine = examine};
	struct leaf root = {.value = {0, 0}};
	struct values v;
	double sizes[SPLIT_SIZES];

	for (int k = 0; k < s.dim_count; k++) {
		const struct field_dim *dim = &j->f->dims[k];
		int is_turn = dim->is_angle && (j->is_whole || dim->is_circle);

		root.q[k] = is_turn ? (struct interval){-PI_ABOVE, PI_ABOVE} : (struct interval){dim->lower, dim->upper};
	}
	s.context = &v;
	if (values_make(&v, j, output) && split_run(&s, &root, fmin(j->deadline, seconds_now() + j->seconds)))
		split_total(&s, sizes, &j->ranges[output]);
	else
		j->failed = 1;
	split_free(&s);
	arena_free(&v.arena);
}

int magnitude_find(struct interval *ranges, const struct field *f, const struct box *b, int is_whole, const struct effort *x,
	double seconds)
{
	size_t outputs = (size_t)f->output_count, rounds = (outputs + x->threads - 1) / x->threads;
	struct job j = {ranges, f, b, is_whole, 0, seconds / (double)(rounds ? rounds : 1), x->deadline};

	workers_run(x->workers, x->threads, find, &j, outputs);
	return !j.failed;
}
