#include "proved/envelope.h"
#include <math.h>

static int is_torque(enum role role)
{
	return role == ROLE_JOINT_TORQUE || role == ROLE_GRAVITY_TORQUE || role == ROLE_BIAS_TORQUE;
}

int envelope_is_there(const struct dag *d)
{
	for (size_t i = 0; i < d->output_count; i++)
		if (is_torque(d->arguments[d->outputs[i].argument].role))
			return 1;
	return 0;
}

/* ---- rows ---- */

/* Forces come before moments. */
static const char *unit_of(const struct tree_joint *t, int row)
{
	int forces = t->type == JOINT_FLOATING ? 3 : t->type == JOINT_PLANAR ? 2 : t->type == JOINT_PRISMATIC;

	return row - t->iv < forces ? "N" : "N m";
}

/* "elbow"; of a joint with several rows "root fx"; a floating base has no name. */
static const char *name_of(const struct tree_joint *t, int row, struct arena *a)
{
	static const char *const floating[] = {"fx", "fy", "fz", "nx", "ny", "nz"}, *const planar[] = {"fx", "fy", "nz"};

	if (t->nv == 1)
		return t->name;
	return text_format(a, "%s %s", *t->name ? t->name : "base", (t->type == JOINT_PLANAR ? planar : floating)[row - t->iv]);
}

static double effort_of(const struct tree *t, const struct tree_joint *k)
{
	const struct joint *j = tree_joint_of(t->source, t, (int)(k - t->joints));

	return j && j->has_rates && j->effort > 0 ? j->effort : 0;
}

static void judge(struct envelope_row *r)
{
	double limit = r->effort > 0 ? r->effort : 1;

	r->proved = fmax(fabs(r->low), fabs(r->high)) / limit;
	r->found = fmax(fabs(r->found_low), fabs(r->found_high)) / limit;
	r->verdict = r->effort == 0 ? ENVELOPE_NO_LIMIT : r->proved <= 1 ? ENVELOPE_KEPT : r->found > 1
		? ENVELOPE_EXCEEDED : ENVELOPE_OPEN;
}

int envelope_list(struct envelope *x, const struct proved *of, struct arena *a)
{
	const struct dag *d = &of->a->dag;
	uint32_t *order = arena_alloc(a, d->output_count, sizeof *order);

	*x = (struct envelope){of, arena_alloc(a, d->output_count + 1, sizeof *x->rows), 0};
	if (order)
		dag_order_outputs(d, order);
	for (size_t i = 0; i < d->output_count && !a->failed; i++) {
		const struct output *o = &d->outputs[order[i]];
		const struct argument *argument = &d->arguments[o->argument];
		const struct tree_joint *t = tree_joint_of_row(&of->a->tree, o->row);
		const struct prove_row *r = &of->p->rows[order[i]];

		if (!is_torque(argument->role))
			continue;
		x->rows[x->count] = (struct envelope_row){.output = argument->name, .joint = name_of(t, o->row, a),
			.unit = unit_of(t, o->row), .argument = o->argument, .row = o->row, .low = r->low, .high = r->high,
			.found_low = r->found_low, .found_high = r->found_high, .effort = effort_of(&of->a->tree, t)};
		judge(&x->rows[x->count++]);
	}
	return !a->failed;
}

/* ---- CSV ---- */

static void put_quoted(struct text *out, const char *s)
{
	text_putc(out, '"');
	for (; *s; s++)
		text_put(out, *s == '"' ? "\"\"" : (char[]){*s, '\0'});
	text_putc(out, '"');
}

/* And a comma; nothing of what is not finite. */
static void put_number(struct text *out, double x)
{
	if (isfinite(x))
		text_printf(out, "%.17g", x + 0.0);
	text_putc(out, ',');
}

static void put_share(struct text *out, const struct envelope_row *r, double share)
{
	if (r->effort > 0 && isfinite(share))
		text_printf(out, ",%.6g", share);
	else
		text_putc(out, ',');
}

/* Numbers have as many digits as their doubles need; shares are rounded. */
void envelope_put_csv(const struct envelope *x, struct text *out)
{
	static const char *const verdicts[] = {"no limit", "kept", "open", "exceeded"};

	text_put(out, "output,row,joint,unit,low,high,found_low,found_high,effort_limit,proved_of_limit,found_of_limit,limit_is\n");
	for (size_t i = 0; i < x->count; i++) {
		const struct envelope_row *r = &x->rows[i];
		const double numbers[] = {r->low, r->high, r->found_low, r->found_high};

		text_printf(out, "%s,%d,", r->output, r->row);
		put_quoted(out, r->joint);
		text_printf(out, ",%s,", r->unit);
		for (size_t k = 0; k < sizeof numbers / sizeof *numbers; k++)
			put_number(out, numbers[k]);
		if (r->effort > 0)
			text_printf(out, "%.17g", r->effort);
		put_share(out, r, r->proved);
		put_share(out, r, r->found);
		text_printf(out, ",%s\n", verdicts[r->verdict]);
	}
}

/* ---- sentences ---- */

static void put_one(const struct envelope_row *r, int is_first, struct text *out)
{
	double most = r->proved * (r->effort > 0 ? r->effort : 1), found = r->found * (r->effort > 0 ? r->effort : 1);

	switch (r->verdict) {
	case ENVELOPE_EXCEEDED:
		text_printf(out,
			"- more than the limit: %s of %s, %g %s: a state was found that needs %.6g, %.3g %% of it; none needs more than %.6g\n",
			r->output, r->joint, r->effort, r->unit, found, 100 * r->found, most);
		return;
	case ENVELOPE_OPEN:
		text_printf(out,
			"- perhaps more than the limit: %s of %s, %g %s: no state needs more than %.6g, %.3g %% of it; found was %.6g\n",
			r->output, r->joint, r->effort, r->unit, most, 100 * r->proved, found);
		return;
	case ENVELOPE_KEPT:
		text_printf(out, "%s %s (%.0f %%)", is_first ? "- never more than the limit:" : ",", r->joint,
			ceil(100 * r->proved));
		return;
	default:
		text_printf(out, "%s %s", is_first ? "- the URDF has no limit of effort:" : ",", r->joint);
	}
}

void envelope_put_limits(const struct envelope *x, struct text *out)
{
	static const enum envelope_verdict order[] = {ENVELOPE_EXCEEDED, ENVELOPE_OPEN, ENVELOPE_KEPT, ENVELOPE_NO_LIMIT};

	text_put(out, x->count ? "\nLimits of effort, over all these states:\n" : "");
	for (int k = 0; k < 4; k++) {
		int count = 0;

		for (size_t i = 0; i < x->count; i++)
			if (x->rows[i].verdict == order[k])
				put_one(&x->rows[i], !count++, out);
		text_put(out, count && k >= 2 ? "\n" : "");
	}
}
