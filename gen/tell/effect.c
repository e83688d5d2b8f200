#include "tell/effect.h"
#include "tell/draw_put.h"
#include "dag/eval.h"
#include "base/number.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

struct measuring {
	const struct analysis *now;
	struct arena *a; /* for what goes again */
	struct rneagen_error *e;
	struct drawn inputs;
};

/* The same scene with constants changed in another way. */
static enum rneagen_code build(struct analysis *x, const struct measuring *m, const struct adjust *adjust)
{
	analysis_copy(x, m->now, m->a, m->e);
	x->adjust = *adjust;
	return analysis_run(x, PASS_ROBOT_SNAP, PASS_DAG_FUSE);
}

/* ---- torques ---- */

static size_t output_rows(const struct dag *d)
{
	size_t rows = 0;

	for (int k = 0; k < d->argument_count; k++)
		rows += d->arguments[k].is_output ? (size_t)d->arguments[k].rows : 0;
	return rows;
}

/* All outputs in one sample, after one another; 0 for a bound of errors, which tells nothing of the model. Returns 0 when memory
   runs out. */
static int torques(const struct analysis *w, const struct measuring *m, size_t sample, double *out)
{
	const struct dag *d = &w->dag;
	const double *in[DAG_ARGUMENTS] = {NULL};
	double *to[DAG_ARGUMENTS] = {NULL};

	for (int k = 0; k < d->argument_count; k++) {
		in[k] = draw_rows(&m->inputs, &d->arguments[k], sample);
		to[k] = out;
		out += d->arguments[k].is_output ? d->arguments[k].rows : 0;
	}
	if (!eval_f64(d, in, to, NULL))
		return 0;
	for (int k = 0; k < d->argument_count; k++)
		for (int i = 0; d->arguments[k].role == ROLE_JOINT_ACCELERATION_BOUND && i < d->arguments[k].rows; i++)
			to[k][i] = 0;
	return 1;
}

/* NAN where nothing is known: an output overflows. */
static int compare(struct effect *x, const struct analysis *with, const struct analysis *without, const struct measuring *m)
{
	size_t rows = output_rows(&with->dag);
	double *y = arena_alloc(m->a, 2 * rows, sizeof *y), *z = y ? y + rows : NULL, largest = 0, largest_off = 0;

	for (size_t k = 0; k < m->inputs.samples; k++) {
		double off = 0, size = 0;

		if (!y || !torques(with, m, k, y) || !torques(without, m, k, z))
			return 0;
		for (size_t i = 0; i < rows; i++) {
			off = hypot(off, y[i] - z[i]);
			size = hypot(size, z[i]);
			x->change = fmax(x->change, fabs(y[i] - z[i]));
		}
		largest = fmax(largest, size);
		largest_off = isfinite(off) ? fmax(largest_off, off) : (double)INFINITY;
	}
	x->share = largest_off > 0 ? largest_off / largest : 0;
	if (isinf(largest_off))
		x->change = x->share = (double)NAN;
	return 1;
}

/* ---- each change ---- */

static enum rneagen_code add_effect(struct effects *all, struct effect *x, const struct analysis *with,
	const struct analysis *without, const struct measuring *m)
{
	x->saved = analysis_flops(without) - analysis_flops(with);
	if (!compare(x, with, without, m))
		return error_memory(m->e);
	all->of[all->count++] = *x;
	return RNEAGEN_OK;
}

static enum rneagen_code measure_asked(struct effects *all, const struct measuring *m)
{
	for (int key = SCENE_SNAP_ANGLE; key <= SCENE_DROP_BELOW; key++) {
		struct effect x = {.key = (enum scene_key)key, .is_asked = 1};
		struct adjust other = m->now->adjust;
		struct analysis without;

		if (key == SCENE_SNAP_ANGLE) {
			x.argument = other.snap;
			other.snap = 0;
		} else if (key == SCENE_ROUND_CONSTANTS) {
			x.argument = other.digits;
			other.digits = 0;
		} else {
			x.argument = other.prune;
			x.is_proved = other.prune > 0 && !other.is_sampled;
			x.most = m->now->dropped;
			other.prune = 0;
		}
		if (x.argument > 0 && (build(&without, m, &other) || add_effect(all, &x, m->now, &without, m)))
			return m->e->code;
	}
	return RNEAGEN_OK;
}

/* What --snap-angle would do where there is something for it. */
static enum rneagen_code measure_nearly(struct effects *all, const struct measuring *m)
{
	struct effect x = {.key = SCENE_SNAP_ANGLE, .argument = ADJUST_NEARLY};
	struct adjust other = m->now->adjust;
	struct analysis with;

	if (other.snap > 0 || !m->now->outcome.angle_count)
		return RNEAGEN_OK;
	other.snap = ADJUST_NEARLY;
	return build(&with, m, &other) ? m->e->code : add_effect(all, &x, &with, m->now, m);
}

enum rneagen_code effect_measure(struct effects *x, const struct analysis *a)
{
	struct arena spare;
	struct measuring m = {.now = a, .a = &spare, .e = a->error};

	x->count = 0;
	if (!adjust_is_asked(&a->adjust) && !a->outcome.angle_count)
		return RNEAGEN_OK;
	arena_init(&spare, &a->arena->allocator);
	if (!draw_inputs(&m.inputs, &a->tree, &a->request, &DRAW_EFFECTS, &spare))
		error_memory(a->error);
	else if (!measure_asked(x, &m))
		measure_nearly(x, &m);
	arena_free(&spare);
	return a->error->code;
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
		if (!isfinite(off))
			return (double)INFINITY;
		if (size > 0)
			largest = fmax(largest, off / size);
	}
	return largest;
}

static int compare_all(double *change, const struct analysis *with, const struct analysis *without, const struct measuring *m)
{
	size_t rows = output_rows(&with->dag);
	double *y = arena_alloc(m->a, 2 * rows, sizeof *y), *z = y ? y + rows : NULL, largest = -1;

	for (size_t k = 0; k < m->inputs.samples; k++) {
		if (!y || !torques(with, m, k, y) || !torques(without, m, k, z))
			return 0;
		largest = fmax(largest, largest_change(&with->dag, y, z));
	}
	if (largest >= 0)
		*change = largest;
	return 1;
}

enum rneagen_code effect_total(double *change, const struct analysis *a, const struct draw_options *drawing,
	struct rneagen_error *e)
{
	const struct adjust none = {0};
	struct draw_options each = *drawing;
	struct analysis without;
	struct arena spare;
	struct measuring m = {.now = a, .a = &spare, .e = e};

	*change = (double)NAN;
	each.each = 1;
	if (!adjust_is_asked(&a->adjust))
		return RNEAGEN_OK;
	arena_init(&spare, NULL);
	if (!draw_inputs(&m.inputs, &a->tree, &a->request, &each, &spare))
		error_memory(e);
	else if (!build(&without, &m, &none) && !compare_all(change, a, &without, &m))
		error_memory(e);
	arena_free(&spare);
	return e->code;
}

/* ---- telling ---- */

/* `next`: the end of a line and the beginning of one that goes on with it */
static void put_effect(const struct effect *x, const char *next, struct text *out)
{
	text_printf(out, "--%s %s %s %ld flops of rnea, and torques ", scene_word(x->key), number_plain(x->argument).s,
		x->is_asked ? "saves" : "would save", x->saved);
	if (isnan(x->change))
		text_put(out, "overflow, so that nothing is known of their change");
	else
		text_printf(out, "%s by up to %.2g (%.2g of the largest |tau|)", x->is_asked ? "change" : "would change",
			x->change, x->share);
	text_printf(out, ", sampled in %zu states", DRAW_EFFECTS.count);
	if (x->is_proved)
		text_printf(out,
			"%sproved for all states within the ranges below, in exact arithmetic: no output changes by more than %.2g, %.2g of its "
			"largest",
			next, x->most.change, x->most.share);
	else if (x->key == SCENE_DROP_BELOW)
		text_printf(out, "%sthe terms were chosen by samples, and nothing is proved of other states", next);
}

static int is_asked(const struct effects *all)
{
	for (int i = 0; i < all->count; i++)
		if (all->of[i].is_asked)
			return 1;
	return 0;
}

void effect_put_table(const struct effects *all, const struct analysis *a, struct text *out)
{
	for (int i = 0; i < a->outcome.angle_count; i++)
		text_printf(out, "%s%s '%s', by %.2g\n", i ? "  " : "\nangles that are nearly right, rad\n  ",
			a->outcome.angles[i].what, a->outcome.angles[i].name, a->outcome.angles[i].off);
	for (int i = 0; i < all->count; i++) {
		text_put(out, i ? "  " : "\nchanged constants\n  ");
		put_effect(&all->of[i], ";\n    ", out);
		text_putc(out, '\n');
	}
	if (all->count) {
		text_put(out, "  drawn are ");
		draw_put(a, "\n    ", out);
		text_putc(out, '\n');
	}
}

void effect_put_comment(const struct effects *all, const struct analysis *a, struct text *out)
{
	for (int i = 0; i < all->count; i++)
		if (all->of[i].is_asked) {
			text_put(out, " * ");
			put_effect(&all->of[i], ";\n *   ", out);
			text_put(out, "\n");
		}
	if (is_asked(all)) {
		text_put(out, " * Drawn are ");
		draw_put(a, "\n *   ", out);
		text_put(out, "\n");
	}
}

/* A number of JSON, or null. */
static void put_number(const char *name, double x, struct text *out)
{
	if (isnan(x))
		text_printf(out, ", \"%s\": null", name);
	else
		text_printf(out, ", \"%s\": %s", name, number_plain(x).s);
}

static void put_json_effect(const struct effect *x, struct text *out)
{
	text_printf(out, "{\"option\": \"%s\", \"value\": %s, \"asked\": %s, \"saved\": %ld", scene_word(x->key),
		number_plain(x->argument).s, x->is_asked ? "true" : "false", x->saved);
	put_number("change", x->change, out);
	put_number("share", x->share, out);
	if (x->key == SCENE_DROP_BELOW)
		text_printf(out, ", \"proved\": %s", x->is_proved ? "true" : "false");
	if (x->is_proved) {
		put_number("proved_change", x->most.change, out);
		put_number("proved_share", x->most.share, out);
	}
	text_putc(out, '}');
}

void effect_put_json(const struct effects *all, const struct analysis *a, struct text *out)
{
	if (a->outcome.angle_count)
		text_put(out, "  \"nearly_right\": [");
	for (int i = 0; i < a->outcome.angle_count; i++) {
		text_printf(out, "%s{\"%s\": ", i ? ",\n    " : "\n    ", *a->outcome.angles[i].what == 'j' ? "joint" : "link");
		text_put_json(out, a->outcome.angles[i].name);
		text_printf(out, ", \"off\": %s}", number_plain(a->outcome.angles[i].off).s);
	}
	text_put(out, a->outcome.angle_count ? "\n  ],\n" : "");
	if (!all->count)
		return;
	text_put(out, "  \"changed\": [");
	for (int i = 0; i < all->count; i++) {
		text_put(out, i ? ",\n    " : "\n    ");
		put_json_effect(&all->of[i], out);
	}
	text_printf(out, "\n  ],\n  \"sampled\": {\"states\": %zu, \"inputs\": [\n    ", DRAW_EFFECTS.count);
	draw_put_json(a, ",\n    ", out);
	text_put(out, "\n  ]},\n");
}
