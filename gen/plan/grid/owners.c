#include "plan/grid/owners.h"
#include "tree/lumps.h"
#include "tree/pattern.h"

/* By row of qd: the last body that moves with it. */
static int *bodies_of_rows(const struct tree *t, struct arena *a)
{
	int *body = arena_alloc(a, (size_t)t->nv, sizeof *body);

	for (int k = 0; k < t->body_count && body; k++)
		for (int i = 0; i < joint_nv(t->bodies[k].type); i++)
			body[t->bodies[k].iv + i] = k;
	return body;
}

/* Ten columns are of the lump's body. */
static void own_columns(const struct tree *t, const struct pattern *p, int *body, struct arena *a)
{
	struct lumps x;

	if (!lumps_make(&x, t, a))
		return;
	for (int e = 0; e < t->nv * p->cols; e++)
		if (p->row[e] >= 0)
			body[p->row[e]] = x.body[e % p->cols / LUMP_PARAMETERS];
}

/* Of a matrix that is not by joints on both sides: the link's body, or the column's. */
static void own_motion(const struct tree *t, const struct want *w, const struct pattern *p, const int *of_row, int *body)
{
	for (int e = 0; e < p->lines * p->cols; e++)
		if (p->row[e] >= 0)
			body[p->row[e]] = want_is(w->kind, OF_LINK) ? w->body : of_row[e % p->cols % t->nv];
}

/* By stored element of a matrix by joints: the body that is further out; of what is solved column by column, the column's. */
static void own_elements(const struct tree *t, const struct want *w, int dense, int is_solved, int *body, struct arena *a)
{
	int nv = t->nv, by_column = is_solved && want_is(w->kind, IS_SOLVED), *of_row = bodies_of_rows(t, a);
	struct pattern p;

	if (!of_row || !request_pattern(&p, t, w, dense, a))
		return;
	if (w->kind == WANT_REGRESSOR) {
		own_columns(t, &p, body, a);
		return;
	}
	if (want_is(w->kind, OF_LINK | IS_MOTION)) {
		own_motion(t, w, &p, of_row, body);
		return;
	}
	for (int i = 0; i < nv; i++)
		for (int j = 0; j < nv; j++)
			if (p.row[i * nv + j] >= 0)
				body[p.row[i * nv + j]] = !by_column && of_row[i] > of_row[j] ? of_row[i] : of_row[j];
}

int owners_matrix(const struct request *k)
{
	for (int i = 0; i < k->stored_count; i++)
		if (request_is_matrix(k, &k->wants[i]))
			return 1;
	return 0;
}

static void own_want(
	struct owners *x, const struct dag *d, const struct tree *t, const struct want *w, int dense, int is_solved, struct arena *a)
{
	int *body = arena_alloc(a, (size_t)w->rows, sizeof *body), argument = dag_find_argument(d, w->argument);

	if (!body)
		return;
	own_elements(t, w, dense, is_solved, body, a);
	for (size_t i = 0; i < d->output_count; i++)
		if (d->outputs[i].argument == argument)
			x->owner[i] = body[d->outputs[i].row];
}

/* From bodies to those of them that own anything. */
static void list(struct owners *x, size_t outputs, const struct tree *t, int *place)
{
	for (size_t i = 0; i < outputs; i++)
		place[x->owner[i]] = 1;
	for (int k = 0; k < t->body_count; k++)
		if (place[k]) {
			place[k] = x->count;
			x->bodies[x->count++] = k;
		}
	for (size_t i = 0; i < outputs; i++)
		x->owner[i] = place[x->owner[i]];
}

int owners_make(
	struct owners *x, const struct dag *d, const struct tree *t, const struct request *k, int is_solved, struct arena *a)
{
	int *place = arena_alloc(a, (size_t)t->body_count, sizeof *place);

	*x = (struct owners){.owner = arena_alloc(a, d->output_count, sizeof *x->owner),
		.bodies = arena_alloc(a, (size_t)t->body_count, sizeof *x->bodies)};
	for (int i = 0; i < k->stored_count && !a->failed; i++)
		if (request_is_matrix(k, &k->wants[i]))
			own_want(x, d, t, &k->wants[i], k->dense, is_solved, a);
	if (!a->failed)
		list(x, d->output_count, t, place);
	return !a->failed;
}
