#include "proved/rows_put.h"
#include "certify/assumptions.h"
#include "emit/emit.h"
#include "proved/gap_put.h"
#include <math.h>
#include <string.h>

/* With what the rows say beyond a certificate's. */
static const char *assumption_of(int i, struct arena *a)
{
	struct text whole;

	text_init(&whole, a);
	text_put(&whole, ASSUMPTIONS[i].text);
	if (ASSUMPTIONS[i].of_rows)
		text_put(&whole, ASSUMPTIONS[i].of_rows);
	return whole.failed ? "" : text_string(&whole);
}

/* Numbers are printed with so many digits that reading them gives the same double. */

static const char *joint_of(const struct proved *x, const struct output *o, double *effort)
{
	const struct tree *t = &x->a->tree;
	enum role role = x->a->dag.arguments[o->argument].role;

	*effort = 0;
	for (int i = 0; i < t->joint_count && role_rows(role) == ROWS_NV; i++) {
		const struct joint *j = tree_joint_of(t->source, t, i);

		if (o->row < t->joints[i].iv || o->row >= t->joints[i].iv + t->joints[i].nv)
			continue;
		if (j && j->has_rates && j->effort > 0)
			*effort = j->effort;
		return t->joints[i].name;
	}
	return "";
}

static const char *output_name(const struct proved *x, const struct output *o)
{
	return x->a->dag.arguments[o->argument].name;
}

/* Outputs by arguments and rows. */
static const uint32_t *order_of(const struct proved *x, struct text *out)
{
	uint32_t *order = arena_alloc(out->arena, x->a->dag.output_count, sizeof *order);

	out->failed |= !order;
	if (order)
		dag_order_outputs(&x->a->dag, order);
	return order;
}

/* ---- JSON ---- */

static void put_number(struct text *out, const char *name, double value)
{
	if (isfinite(value))
		text_printf(out, ", \"%s\": %.17g", name, value + 0.0); /* no -0 */
	else
		text_printf(out, ", \"%s\": null", name);
}

static void put_gap(const struct proved *x, size_t i, int k, struct text *out)
{
	struct text why;

	text_init(&why, out->arena);
	gap_put(x, i, k, &why);
	text_put(out, ", \"no_bound\": ");
	if (why.length)
		text_put_json(out, text_string(&why));
	else
		text_put(out, "null");
	out->failed |= why.failed;
}

/* A single state's bound has the rounding of the evaluator in it, some 2^-11 of the error, which no proof has. */
static double error_found(const struct prove_row *r, int k)
{
	return fmin(r->error_found[k], r->error_bound[k]);
}

static void put_row(const struct proved *x, size_t i, int k, struct text *out)
{
	const struct output *o = &x->a->dag.outputs[i];
	const struct prove_row *r = &x->p->rows[i];
	double effort;
	const char *joint = joint_of(x, o, &effort);

	text_put(out, "{\"output\": ");
	text_put_json(out, output_name(x, o));
	text_printf(out, ", \"row\": %d, \"joint\": ", o->row);
	text_put_json(out, joint);
	text_printf(out, ", \"precision\": \"%s\"", emit_precision_name(x->o->precisions[k]));
	put_number(out, "low", r->low);
	put_number(out, "high", r->high);
	put_number(out, "found_low", r->found_low);
	put_number(out, "found_high", r->found_high);
	put_number(out, "plain_intervals", r->plain);
	put_number(out, "error_bound", r->error_bound[k]);
	put_number(out, "error_found", error_found(r, k));
	put_gap(x, i, k, out);
	put_number(out, "effort", effort > 0 ? effort : (double)NAN);
	put_number(out, "error_of_effort", effort > 0 ? r->error_bound[k] / effort * (1 + 0x1p-50) : (double)NAN);
	text_put(out, "}");
}

static void put_ranges(const struct proved *x, struct text *out)
{
	int count = 0;

	for (int i = 0; i < x->a->dag.argument_count; i++)
		for (int r = 0; r < x->a->dag.arguments[i].rows && x->b->rows[i]; r++) {
			const struct interval *range = &x->b->rows[i][r];

			if (!(range->lower <= range->upper))
				continue;
			text_put(out, count++ ? ",\n    {\"input\": " : "\n    {\"input\": ");
			text_put_json(out, x->a->dag.arguments[i].name);
			text_printf(out, ", \"row\": %d, \"lower\": %.17g, \"upper\": %.17g}", r, range->lower, range->upper);
		}
}

void rows_put_json(const struct proved *x, struct text *out)
{
	const uint32_t *order = order_of(x, out);

	text_put(out, "{\n  \"robot\": ");
	text_put_json(out, x->a->robot.name);
	text_printf(out, ",\n  \"trig\": \"%s\",\n  \"assumptions\": [", emit_trig_name(x->a->options.trig));
	for (int i = 0; i < ASSUMPTION_COUNT; i++)
		if (assumption_is_needed(x->a, i)) {
			text_put(out, i ? ",\n    " : "\n    ");
			text_put_json(out, assumption_of(i, out->arena));
		}
	text_put(out, "\n  ],\n  \"ranges\": [");
	put_ranges(x, out);
	text_put(out, "\n  ],\n  \"rows\": [");
	for (size_t i = 0; i < x->a->dag.output_count && order; i++)
		for (int k = 0; k < x->o->precision_count; k++) {
			text_put(out, i || k ? ",\n    " : "\n    ");
			put_row(x, order[i], k, out);
		}
	text_put(out, "\n  ]\n}\n");
}

/* ---- table ---- */

static double slack(const struct prove_row *r)
{
	double found = fmax(fabs(r->found_low), fabs(r->found_high)), proved = fmax(fabs(r->low), fabs(r->high));

	return found > 0 ? proved / found : 1;
}

/* Where sums leave the doubles no range is proved, and what a search finds is no number. */
static void put_range(const struct prove_row *r, struct text *out)
{
	double found = fmax(fabs(r->found_low), fabs(r->found_high));

	if (isfinite(r->low) && isfinite(r->high) && isfinite(found))
		text_printf(out, "from %.6g to %.6g; found %.6g to %.6g; slack %.2f, of plain intervals %.1f", r->low + 0.0, r->high + 0.0,
			r->found_low, r->found_high, slack(r), r->plain / fmax(found, 1e-300));
	else
		text_put(out, "no range: the ranges of inputs are too wide for doubles");
}

static void put_line(const struct proved *x, size_t i, struct text *out)
{
	const struct output *o = &x->a->dag.outputs[i];
	const struct prove_row *r = &x->p->rows[i];
	double effort;
	const char *joint = joint_of(x, o, &effort);

	text_printf(out, "%s[%d] %s: ", output_name(x, o), o->row, joint);
	put_range(r, out);
	if (effort > 0 && isfinite(r->low) && isfinite(r->high))
		text_printf(out, "; at most %.3g of the effort limit, %g", fmax(fabs(r->low), fabs(r->high)) / effort, effort);
	text_putc(out, '\n');
	for (int k = 0; k < x->o->precision_count; k++) {
		if (!isfinite(r->error_bound[k])) {
			text_printf(out, "    %-5s no bound: ", emit_precision_name(x->o->precisions[k]));
			gap_put(x, i, k, out);
			text_putc(out, '\n');
			continue;
		}
		text_printf(out, "    %-5s off by at most %.3g; found %.3g; slack %.2f", emit_precision_name(x->o->precisions[k]),
			r->error_bound[k], error_found(r, k), r->error_bound[k] / fmax(error_found(r, k), 1e-300));
		if (effort > 0)
			text_printf(out, "; %.2g of the limit", r->error_bound[k] / effort);
		text_putc(out, '\n');
	}
}

void rows_put_table(const struct proved *x, struct text *out)
{
	const uint32_t *order = order_of(x, out);

	for (size_t i = 0; i < x->a->dag.output_count && order; i++)
		put_line(x, order[i], out);
	text_put(out, "\nThis holds if:\n");
	for (int i = 0; i < ASSUMPTION_COUNT; i++)
		if (assumption_is_needed(x->a, i))
			text_printf(out, "- %s\n", assumption_of(i, out->arena));
}
