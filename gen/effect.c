#include "effect.h"
#include "analysis.h"
#include "eval.h"
#include "sample.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* One way to build the scene: the DAG of its torques and what they cost. */
struct way {
	struct tree tree;
	struct dag dag;
	long flops;
};

struct measuring {
	const struct robot *r;
	const struct rneagen_options *o;
	struct arena *a; /* for what goes again */
	struct rneagen_error *e;
	struct states states;
};

static enum rneagen_code count(struct way *w, const struct measuring *m)
{
	w->flops = analysis_dag(&w->dag, &w->tree, m->o->strict, m->a) ? analysis_flops(&w->dag, &w->tree, m->a) : -1;
	return w->flops < 0 ? error_memory(m->e) : RNEAGEN_OK;
}

static enum rneagen_code build(struct way *w, const struct measuring *m, const struct adjust *x)
{
	return tree_build_adjusted(&w->tree, m->r, m->o, x, m->a, m->e) ? m->e->code : count(w, m);
}

/* ---- torques ---- */

static size_t total_rows(const struct dag *d, int outputs)
{
	size_t rows = 0;

	for (int k = 0; k < d->argument_count; k++)
		rows += d->arguments[k].is_output == outputs ? (size_t)d->arguments[k].rows : 0;
	return rows;
}

/* All outputs in one state, after one another; `rows` is room for the inputs. Returns 0 when memory runs out. */
static int torques(const struct way *w, const struct measuring *m, size_t state, double *rows, double *out)
{
	const struct dag *d = &w->dag;
	const double *in[DAG_ARGUMENTS] = {NULL};
	double *to[DAG_ARGUMENTS] = {NULL};

	for (int k = 0; k < d->argument_count; k++) {
		const struct argument *x = &d->arguments[k];

		if (x->is_output) {
			to[k] = out;
			out += x->rows;
		} else {
			in[k] = rows;
			for (int i = 0; i < x->rows; i++)
				*rows++ = sample_input(&m->states, &w->tree, x, i, state);
		}
	}
	return eval_f64(d, in, to, NULL);
}

static int compare(struct effect *x, const struct way *with, const struct way *without, const struct measuring *m)
{
	size_t rows = total_rows(&with->dag, 1);
	double *in = arena_alloc(m->a, total_rows(&with->dag, 0) + total_rows(&without->dag, 0), sizeof *in);
	double *y = arena_alloc(m->a, 2 * rows, sizeof *y), *z = y ? y + rows : NULL, largest = 0, largest_off = 0;

	for (size_t k = 0; k < m->states.count; k++) {
		double off = 0, size = 0;

		if (!in || !y || !torques(with, m, k, in, y) || !torques(without, m, k, in, z))
			return 0;
		for (size_t i = 0; i < rows; i++) {
			off = hypot(off, y[i] - z[i]);
			size = hypot(size, z[i]);
			x->change = fmax(x->change, fabs(y[i] - z[i]));
		}
		largest = fmax(largest, size);
		largest_off = fmax(largest_off, off);
	}
	x->share = largest_off > 0 ? largest_off / largest : 0;
	return 1;
}

/* ---- each change ---- */

static enum rneagen_code add_effect(struct tree *t, struct effect *x, const struct way *with, const struct way *without,
	const struct measuring *m)
{
	x->saved = without->flops - with->flops;
	if (!compare(x, with, without, m))
		return error_memory(m->e);
	t->effects[t->effect_count++] = *x;
	return RNEAGEN_OK;
}

static enum rneagen_code measure_asked(struct tree *t, const struct way *now, const struct measuring *m)
{
	for (int key = SCENE_SNAP_ANGLE; key <= SCENE_DROP_BELOW; key++) {
		struct effect x = {.key = (enum scene_key)key, .is_asked = 1};
		struct adjust other = t->adjust;
		struct way without;

		if (key == SCENE_SNAP_ANGLE) {
			x.argument = other.snap;
			other.snap = 0;
		} else if (key == SCENE_ROUND_CONSTANTS) {
			x.argument = other.digits;
			other.digits = 0;
		} else {
			x.argument = other.drop;
			other.drop = 0;
		}
		if (x.argument > 0 && (build(&without, m, &other) || add_effect(t, &x, now, &without, m)))
			return m->e->code;
	}
	return RNEAGEN_OK;
}

/* What --snap-angle would do where there is something for it. */
static enum rneagen_code measure_nearly(struct tree *t, const struct way *now, const struct measuring *m)
{
	struct effect x = {.key = SCENE_SNAP_ANGLE, .argument = ADJUST_NEARLY};
	struct adjust other = t->adjust;
	struct way with;

	if (other.snap > 0 || !t->angle_count)
		return RNEAGEN_OK;
	other.snap = ADJUST_NEARLY;
	return build(&with, m, &other) ? m->e->code : add_effect(t, &x, &with, now, m);
}

enum rneagen_code effect_measure(
	struct tree *t, const struct robot *r, const struct rneagen_options *o, struct arena *a, struct rneagen_error *e)
{
	struct way now = {.tree = *t};
	struct arena spare;
	struct measuring m = {.r = r, .o = o, .a = &spare, .e = e};

	t->effects = arena_alloc(a, 4, sizeof *t->effects);
	if (!t->effects)
		return error_memory(e);
	if (t->adjust.snap == 0 && t->adjust.digits == 0 && t->adjust.drop == 0 && !t->angle_count)
		return RNEAGEN_OK;
	arena_init(&spare, &a->allocator);
	if (!sample_states(&m.states, r, t, &SAMPLE_EFFECTS))
		error_memory(e);
	else if (!count(&now, &m) && !measure_asked(t, &now, &m))
		measure_nearly(t, &now, &m);
	sample_free(&m.states);
	arena_free(&spare);
	return e->code;
}

/* ---- all of them ---- */

/* The largest of ||y - z|| / ||z|| over the output arrays; what is 0 has nothing to compare with. */
static double largest_change(const struct dag *d, const double *y, const double *z)
{
	double largest = -1;

	for (int k = 0; k < d->argument_count; k++) {
		double off = 0, size = 0;

		for (int i = 0; d->arguments[k].is_output && i < d->arguments[k].rows; i++, y++, z++) {
			off = hypot(off, *y - *z);
			size = hypot(size, *z);
		}
		if (size > 0)
			largest = fmax(largest, off / size);
	}
	return largest;
}

static int compare_all(double *change, const struct way *with, const struct way *without, const struct measuring *m)
{
	size_t rows = total_rows(&with->dag, 1);
	double *in = arena_alloc(m->a, total_rows(&with->dag, 0) + total_rows(&without->dag, 0), sizeof *in);
	double *y = arena_alloc(m->a, 2 * rows, sizeof *y), *z = y ? y + rows : NULL, largest = -1;

	for (size_t k = 0; k < m->states.count; k++) {
		if (!in || !y || !torques(with, m, k, in, y) || !torques(without, m, k, in, z))
			return 0;
		largest = fmax(largest, largest_change(&with->dag, y, z));
	}
	if (largest >= 0)
		*change = largest;
	return 1;
}

enum rneagen_code effect_total(double *change, const struct tree *t, const struct robot *r, const struct rneagen_options *o,
	const struct sample_options *sampling, struct rneagen_error *e)
{
	struct way with = {.tree = *t}, without;
	struct adjust none = t->adjust;
	struct arena spare;
	struct measuring m = {.r = r, .o = o, .a = &spare, .e = e};

	*change = (double)NAN;
	none.snap = none.drop = 0;
	none.digits = 0;
	if (t->adjust.snap == 0 && t->adjust.digits == 0 && t->adjust.drop == 0)
		return RNEAGEN_OK;
	arena_init(&spare, NULL);
	if (!sample_states(&m.states, r, t, sampling))
		error_memory(e);
	else if (!count(&with, &m) && !build(&without, &m, &none) && !compare_all(change, &with, &without, &m))
		error_memory(e);
	sample_free(&m.states);
	arena_free(&spare);
	return e->code;
}

/* ---- telling ---- */

static void put_effect(const struct effect *x, struct text *out)
{
	text_printf(out, "--%s %g %s %ld flops of rnea, and torques %s by up to %.2g (%.2g of the largest |tau|), sampled in %zu states", scene_word(x->key),
		x->argument, x->is_asked ? "saves" : "would save", x->saved, x->is_asked ? "change" : "would change", x->change, x->share,
		SAMPLE_EFFECTS.count);
}

void effect_put_table(const struct tree *t, struct text *out)
{
	for (int i = 0; i < t->angle_count; i++)
		text_printf(out, "%s%s '%s', by %.2g\n", i ? "  " : "\nangles that are nearly right, rad\n  ", t->angles[i].what,
			t->angles[i].name, t->angles[i].off);
	for (int i = 0; i < t->effect_count; i++) {
		text_put(out, i ? "  " : "\nchanged constants\n  ");
		put_effect(&t->effects[i], out);
		text_putc(out, '\n');
	}
}

void effect_put_comment(const struct tree *t, struct text *out)
{
	for (int i = 0; i < t->effect_count; i++)
		if (t->effects[i].is_asked) {
			text_put(out, " * ");
			put_effect(&t->effects[i], out);
			text_put(out, "\n");
		}
}

void effect_put_json(const struct tree *t, struct text *out)
{
	if (t->angle_count)
		text_put(out, "  \"nearly_right\": [");
	for (int i = 0; i < t->angle_count; i++) {
		text_printf(out, "%s{\"%s\": ", i ? ",\n    " : "\n    ", *t->angles[i].what == 'j' ? "joint" : "link");
		text_put_json(out, t->angles[i].name);
		text_printf(out, ", \"off\": %.17g}", t->angles[i].off);
	}
	text_put(out, t->angle_count ? "\n  ],\n" : "");
	if (t->effect_count)
		text_put(out, "  \"changed\": [");
	for (int i = 0; i < t->effect_count; i++) {
		const struct effect *x = &t->effects[i];

		text_printf(out, "%s{\"option\": \"%s\", \"value\": %.17g, \"asked\": %s, \"saved\": %ld, \"change\": %.17g, \"share\": %.17g}",
			i ? ",\n    " : "\n    ", scene_word(x->key), x->argument, x->is_asked ? "true" : "false", x->saved, x->change, x->share);
	}
	text_put(out, t->effect_count ? "\n  ],\n" : "");
}
