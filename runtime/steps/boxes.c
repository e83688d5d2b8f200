#define _POSIX_C_SOURCE 200809L
#include "steps/boxes.h"
#include "core/seconds.h"
#include <stdlib.h>
#include <string.h>

/* What is stated is as much larger as another machine's sine may differ, and more. */
#define STATED 0x1p-40

static double stated_up(double x)
{
	return out_up(x + STATED * fabs(x));
}

/* ---- a tree of boxes ---- */

/* A box is that of the cut before it, and a half. */
struct spot {
	size_t at;     /* where its q stands */
	double key;
	int is_open;   /* it was cut further */
	struct box_bound bound;
};

struct tree {
	const struct boxes_of *of;
	const struct cuts *proof;
	const struct boxes_goal *goal;
	size_t *second;
	struct spot *spots;   /* by cut of the proof; those that were reached */
	struct span *q;       /* [at][row] */
	size_t *heap, reached, leaves;
};

static struct span *q_at(const struct tree *t, size_t at)
{
	return t->q + at * (size_t)t->of->q_rows;
}

static void look(struct tree *t, size_t cut, const struct span *q)
{
	const struct boxes_of *of = t->of;
	struct spot *s = &t->spots[cut];
	size_t at = t->leaves++;

	s->at = t->reached++;
	memcpy(q_at(t, s->at), q, (size_t)of->q_rows * sizeof *q);
	memcpy(of->rows[of->position], q, (size_t)of->q_rows * sizeof *q);
	errors_evaluate(of->x, of->rows, &s->bound);
	s->key = of->x->count ? s->bound.errors[0] : span_size(s->bound.value);
	for (; at > 0 && t->spots[t->heap[(at - 1) / 2]].key < s->key; at = (at - 1) / 2)
		t->heap[at] = t->heap[(at - 1) / 2];
	t->heap[at] = cut;
}

static size_t take_largest(struct tree *t)
{
	size_t top = t->heap[0], last = t->heap[--t->leaves], at = 0, child;

	for (; (child = 2 * at + 1) < t->leaves; at = child) {
		if (child + 1 < t->leaves && t->spots[t->heap[child + 1]].key > t->spots[t->heap[child]].key)
			child++;
		if (!(t->spots[t->heap[child]].key > t->spots[last].key))
			break;
		t->heap[at] = t->heap[child];
	}
	t->heap[at] = last;
	return top;
}

static void open_spot(struct tree *t, size_t cut, struct span *q)
{
	int row = t->proof->rows[cut];
	double middle;
	struct span whole;

	memcpy(q, q_at(t, t->spots[cut].at), (size_t)t->of->q_rows * sizeof *q);
	whole = q[row];
	middle = cuts_middle(whole.lo, whole.hi);
	t->spots[cut].is_open = 1;
	q[row].hi = middle;
	look(t, cut + 1, q);
	q[row] = (struct span){middle, whole.hi};
	look(t, t->second[cut], q);
}

static void grow(struct tree *t, struct span *q)
{
	while (t->leaves < t->goal->most && seconds_now() < t->goal->deadline) {
		size_t top = t->heap[0];

		if (t->spots[top].key <= t->goal->target || t->proof->rows[top] == CUTS_NONE)
			return;
		open_spot(t, take_largest(t), q);
	}
}

static int boxes_make(struct boxes *b, size_t count, int models)
{
	b->low = malloc((count + 1) * sizeof *b->low);
	b->high = malloc((count + 1) * sizeof *b->high);
	for (int k = 0; k < models; k++)
		b->errors[k] = malloc((count + 1) * sizeof *b->errors[k]);
	for (int k = 0; k < models; k++)
		if (!b->errors[k])
			return 0;
	return b->low && b->high;
}

/* The cuts that were made, in their order. */
static void put_all(const struct tree *t, struct boxes *b, size_t cut)
{
	const struct spot *s = &t->spots[cut];

	cuts_put(&b->cuts, s->is_open ? t->proof->rows[cut] : CUTS_NONE);
	if (s->is_open) {
		put_all(t, b, cut + 1);
		put_all(t, b, t->second[cut]);
		return;
	}
	b->low[b->count] = -stated_up(-s->bound.value.lo);
	b->high[b->count] = stated_up(s->bound.value.hi);
	for (int k = 0; k < t->of->x->count; k++)
		b->errors[k][b->count] = stated_up(s->bound.errors[k]);
	b->count++;
}

static int tree_make(struct tree *t)
{
	size_t count = t->proof->count, most = 2 * t->goal->most + 2;

	t->second = malloc(count * sizeof *t->second);
	t->heap = malloc((count + 2) * sizeof *t->heap);
	t->spots = calloc(count + 1, sizeof *t->spots);
	t->q = malloc(most * (size_t)(t->of->q_rows + 1) * sizeof *t->q);
	return t->second && t->heap && t->spots && t->q;
}

int boxes_find(struct boxes *b, const struct boxes_of *of, const struct cuts *proof, const struct boxes_goal *goal)
{
	static int none = CUTS_NONE;
	const struct cuts whole = {&none, 1, 1, 0};
	struct tree t = {.of = of, .proof = proof->count ? proof : &whole, .goal = goal};
	struct span *q = malloc((size_t)(of->q_rows + 1) * sizeof *q);
	int done = q && tree_make(&t);

	*b = (struct boxes){0};
	if (done && !cuts_check(t.proof, of->q_rows, t.second)) { /* they are about other rows */
		t.proof = &whole;
		t.second[0] = 0;
	}
	if (done) {
		memcpy(q, of->rows[of->position], (size_t)of->q_rows * sizeof *q);
		look(&t, 0, q);
		grow(&t, q);
		memcpy(of->rows[of->position], t.q, (size_t)of->q_rows * sizeof *q);
		done = boxes_make(b, t.leaves, of->x->count);
	}
	if (done)
		put_all(&t, b, 0);
	free(t.second);
	free(t.heap);
	free(t.spots);
	free(t.q);
	free(q);
	return done && !b->cuts.failed;
}

/* ---- checking ---- */

struct walk {
	const struct boxes *b;
	const struct boxes_of *of;
	const char **what;
	size_t at, box;
	long fault;
};

static void check_box(struct walk *w)
{
	static const char *const NAMES[] = {"its error", "its second error", "its third error", "its fourth error"};
	struct box_bound bound;

	errors_evaluate(w->of->x, w->of->rows, &bound);
	*w->what = !states(-w->b->low[w->box], -bound.value.lo) ? "its lower bound" : !states(w->b->high[w->box], bound.value.hi)
		? "its upper bound" : NULL;
	for (int k = 0; k < w->of->x->count && !*w->what; k++)
		if (w->b->errors[k] && !states(w->b->errors[k][w->box], bound.errors[k]))
			*w->what = NAMES[k];
	if (*w->what)
		w->fault = (long)w->box;
	w->box++;
}

/* The cuts are known to be a cover, and none of it too deep. */
static void walk(struct walk *w)
{
	int row = w->b->cuts.rows[w->at++];
	struct span *q, whole;
	double middle;

	if (w->fault >= 0)
		return;
	if (row == CUTS_NONE) {
		check_box(w);
		return;
	}
	q = &w->of->rows[w->of->position][row];
	whole = *q;
	middle = cuts_middle(whole.lo, whole.hi);
	q->hi = middle;
	walk(w);
	*q = (struct span){middle, whole.hi};
	walk(w);
	*q = whole;
}

long boxes_check(const struct boxes *b, const struct boxes_of *of, const char **what)
{
	struct walk w = {b, of, what, 0, 0, -1};
	size_t *second = malloc((b->cuts.count + 1) * sizeof *second), leaves = 0;
	int is_cover = second && cuts_check(&b->cuts, of->q_rows, second);

	for (size_t i = 0; i < b->cuts.count; i++)
		leaves += b->cuts.rows[i] == CUTS_NONE;
	free(second);
	*what = "its cuts";
	if (!is_cover || leaves != b->count)
		return (long)b->count;
	walk(&w);
	return w.fault;
}

struct box_bound boxes_total(const struct boxes *b, int count)
{
	struct box_bound total = {.value = {(double)INFINITY, -(double)INFINITY}};

	for (size_t i = 0; i < b->count; i++) {
		total.value.lo = fmin(total.value.lo, b->low[i]);
		total.value.hi = fmax(total.value.hi, b->high[i]);
		for (int k = 0; k < count; k++)
			total.errors[k] = fmax(total.errors[k], b->errors[k] ? b->errors[k][i] : (double)INFINITY);
	}
	return total;
}

void boxes_free(struct boxes *b)
{
	cuts_free(&b->cuts);
	free(b->low);
	free(b->high);
	for (int k = 0; k < STEPS_PRECISIONS; k++)
		free(b->errors[k]);
	*b = (struct boxes){0};
}
