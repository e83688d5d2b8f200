/* The box of all that is drawn, and magnitudes of values and of derivatives over it. */
#include "draw/proven_bound.h"
#include "draw/felt.h"
#include "dag/eval.h"
#include "norms/adjoint.h"
#include "norms/norms.h"
#include <math.h>
#include <string.h>

/* Numbers that derivatives may take in all: more outputs, or larger ones, would take minutes. */
enum { MOST_SLOPES = 1 << 24 };

/* ---- the box ---- */

/* "qd.elbow", "gravity[2]" */
static void put_row(const struct dropping *p, const struct argument *x, int row, struct text *out)
{
	const struct tree_joint *j = x->role == ROLE_JOINT_POSITION ? tree_joint_of_q(p->t, row)
		: x->rows == p->t->nv ? tree_joint_of_row(p->t, row) : NULL;

	if (j && *j->name)
		text_printf(out, "%s.%s", x->name, j->name);
	else
		text_printf(out, "%s[%d]", request_input_word(p->k, x->name), row);
}

static int is_known(const struct dropping *p, int argument, int row)
{
	const struct drawn_array *y = draw_array(&p->inputs, &p->d->arguments[argument]);

	return y && y->ranges[row].is_known && isfinite(y->ranges[row].upper - y->ranges[row].lower);
}

/* Where nothing of an input is known it is named once; the rows of a joint likewise. */
static void put_missing(const struct dropping *p, int argument, const char *is_read, struct text *out)
{
	const struct argument *x = &p->d->arguments[argument];
	int needed = 0, missing = 0;
	struct text last, now;

	text_init(&last, p->a);
	text_init(&now, p->a);
	for (int r = 0; r < x->rows; r++) {
		needed += is_read[r];
		missing += is_read[r] && !is_known(p, argument, r);
	}
	if (missing && missing == needed && (needed > 1 || x->rows == 1)) {
		text_printf(out, "%s%s", out->length ? ", " : "", request_input_word(p->k, x->name));
		return;
	}
	for (int r = 0; r < x->rows; r++) {
		if (!is_read[r] || is_known(p, argument, r))
			continue;
		text_clear(&now);
		put_row(p, x, r, &now);
		if (strcmp(text_string(&now), text_string(&last)) != 0)
			text_printf(out, "%s%s", out->length ? ", " : "", text_string(&now));
		text_clear(&last);
		text_put(&last, text_string(&now));
	}
}

/* A rotation is of unit length, and intervals of its four numbers do not say so; they are still bounds. */
static int take_bounds(struct dropping *p, int argument)
{
	const struct drawn_array *y = draw_array(&p->inputs, &p->d->arguments[argument]);
	double (*bounds)[2] = arena_alloc(p->a, (size_t)p->d->arguments[argument].rows, sizeof *bounds);

	p->rows[argument] = arena_alloc(p->a, (size_t)p->d->arguments[argument].rows, sizeof *p->rows[argument]);
	if (p->a->failed)
		return 0;
	draw_bounds(y, bounds);
	for (int r = 0; r < y->rows; r++)
		p->rows[argument][r] = (struct interval){bounds[r][0], bounds[r][1]};
	return 1;
}

static enum rneagen_code make_box(struct dropping *p)
{
	const struct dag *d = p->d;
	char *is_read[DAG_ARGUMENTS] = {NULL};
	struct text missing;

	text_init(&missing, p->a);
	for (int i = 0; i < d->argument_count; i++)
		is_read[i] = arena_alloc(p->a, (size_t)d->arguments[i].rows, 1);
	if (p->a->failed)
		return error_memory(p->e);
	for (size_t i = 0; i < d->count; i++)
		if (p->uses[i] && d->nodes[i].op == OP_INPUT && (int)d->nodes[i].arg[0].i < d->argument_count)
			is_read[d->nodes[i].arg[0].i][d->nodes[i].arg[1].i] = 1;
	for (int i = 0; i < d->argument_count; i++)
		if (!d->arguments[i].is_output)
			put_missing(p, i, is_read[i], &missing);
	if (missing.length && !missing.failed)
		return error_set(p->e, RNEAGEN_SCENE,
			"no limit is known of %.400s: give --range NAME=LOWER,UPPER for each, or FRACTION:sampled, which proves nothing",
			text_string(&missing));
	for (int i = 0; i < d->argument_count; i++)
		if (draw_array(&p->inputs, &d->arguments[i]) && !take_bounds(p, i))
			return error_memory(p->e);
	return missing.failed ? error_memory(p->e) : RNEAGEN_OK;
}

/* ---- what stays ---- */

/* Derivatives are followed through these. */
static int is_linear(enum op op)
{
	return op == OP_CONST || op == OP_INPUT || op == OP_NEG || op == OP_ADD || op == OP_SUB || op == OP_MUL ||
		op == OP_FMA || op == OP_ANEW;
}

/* Angles, roots, quotients and what they are made of. */
static void find_kept(struct dropping *p)
{
	for (size_t i = p->d->count; i-- > 0;) {
		const struct node *n = &p->d->nodes[i];

		for (int k = 0; k < op_arity[n->op] && (p->kept[i] || !is_linear(n->op)); k++)
			p->kept[n->arg[k].i] = 1;
	}
}

/* ---- the samples ---- */

static int find_scales(struct dropping *p)
{
	const struct dag *d = p->d;
	double *v = arena_alloc(p->a, d->count, sizeof *v);

	for (size_t s = 0; v && s < p->inputs.samples; s++) {
		for (size_t i = 0; i < d->count; i++) {
			const struct node *n = &d->nodes[i];
			const double *rows = NULL;

			if (n->op == OP_INPUT && (int)n->arg[0].i < d->argument_count)
				rows = draw_rows(&p->inputs, &d->arguments[n->arg[0].i], s);
			v[i] = n->op == OP_INPUT ? (rows ? rows[n->arg[1].i] : 0) : eval_node(n, v);
		}
		for (size_t i = 0; i < d->output_count; i++)
			p->scale[i] = fmax(p->scale[i], fabs(v[d->outputs[i].value.i]));
	}
	return v != NULL;
}

/* ---- magnitudes ---- */

/* Of all values that an output is made of, and of its derivatives by them. */
static enum rneagen_code bound_output(struct dropping *p, size_t output)
{
	uint32_t root = p->d->outputs[output].value.i;
	struct adjoint x;
	struct norms n;
	struct norms_values v;
	struct arena spare;

	arena_init(&spare, &p->a->allocator);
	p->slope[output] = arena_alloc(p->a, (size_t)root + 1, sizeof **p->slope);
	if (!p->slope[output] || !adjoint_make(&x, p->d, output, 1, &spare) || !norms_make(&n, &x.d, 0, &spare) ||
		!norms_lay(&n, &spare) ||
		!norms_values_make(&v, &n, &spare)) {
		arena_free(&spare);
		return error_memory(p->e);
	}
	norms_evaluate(&n, (const struct interval *const *)p->rows, &v);
	for (uint32_t i = 1; i <= root; i++) {
		double size = v.size[x.value[i].i], slope = x.slope[i].i ? v.size[x.slope[i].i] : 0;

		if (x.value[i].i)
			p->size[i] = fmin(p->size[i], isnan(size) ? (double)INFINITY : size);
		p->slope[output][i] = isnan(slope) ? (double)INFINITY : slope;
	}
	arena_free(&spare);
	return RNEAGEN_OK;
}

static enum rneagen_code bound_outputs(struct dropping *p)
{
	size_t slopes = 0;

	for (size_t i = 0; i < p->d->output_count; i++)
		slopes += p->d->outputs[i].value.i;
	if (slopes > MOST_SLOPES)
		return error_set(p->e, RNEAGEN_LIMIT,
			"%zu outputs of so many operations are too many for a proof: ask for fewer, or give FRACTION:sampled, which proves nothing",
			p->d->output_count);
	for (size_t i = 1; i < p->d->count; i++)
		p->size[i] = (double)INFINITY;
	for (size_t i = 0; i < p->d->output_count; i++)
		if (op_arity[p->d->nodes[p->d->outputs[i].value.i].op] && bound_output(p, i))
			return p->e->code;
	return RNEAGEN_OK;
}

enum rneagen_code proven_bound(struct dropping *p)
{
	const struct dag *d = p->d;

	p->uses = arena_alloc(p->a, d->count, sizeof *p->uses);
	p->kept = arena_alloc(p->a, d->count, 1);
	p->size = arena_alloc(p->a, d->count, sizeof *p->size);
	p->slope = arena_alloc(p->a, d->output_count, sizeof *p->slope);
	p->scale = arena_alloc(p->a, d->output_count, sizeof *p->scale);
	if (p->a->failed || !draw_inputs(&p->inputs, p->t, p->k, &FELT_SAMPLES, p->a))
		return error_memory(p->e);
	dag_uses(d, p->uses);
	find_kept(p);
	if (make_box(p))
		return p->e->code;
	return find_scales(p) ? bound_outputs(p) : error_memory(p->e);
}
