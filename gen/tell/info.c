#include "base/number.h"
#include "emit/kernels/emit_kernel.h"
#include "emit/kernels/emit_limbs.h"
#include "tell/inertia_put.h"
#include "tell/info.h"
#include "tell/params_put.h"
#include "tell/parts_put.h"
#include "tell/scene_put.h"

static real total_mass(const struct tree *t)
{
	real mass = t->fixed.mass.x;

	for (int k = 0; k < t->body_count; k++)
		mass += t->bodies[k].inertia.mass.x;
	return mass;
}

static void put_body(const struct tree *t, const struct body *k, struct text *out)
{
	text_printf(out, "%5d %6d  %-10s ", k->number, k->parent < 0 ? -1 : t->bodies[k->parent].number,
		joint_type_name(k->type));
	if (k->type == JOINT_FIXED)
		text_printf(out, "%9s", "held");
	else if (k->follower)
		text_printf(out, "%9s", "mimic");
	else if (joint_nq(k->type) > 1)
		text_printf(out, "%4d..%-3d", k->iq, k->iq + joint_nq(k->type) - 1);
	else
		text_printf(out, "%9d", k->iq);
	text_printf(out, " %12.6Lg  ", k->inertia.mass.x);
	text_put(out, *k->joint ? k->joint : "(base)");
	text_put(out, " -> ");
	text_put(out, k->link);
	text_putc(out, '\n');
}

static void put_limbs(const char *what, const struct limbs *s, struct text *out)
{
	text_printf(out, "\n%s: up to %u samples %d warps share out each, the longest %u of %u operations\n", what, s->most, s->warps,
		s->longest, s->whole);
}

static void put_limbs_json(const struct emission *e, const char *key, const struct limbs *s, struct text *out)
{
	text_printf(out, "  \"%s\": {\"warps\": %d, \"groups\": %d, \"bytes\": %d, \"most\": %u},\n", key, s->warps, s->groups,
		emit_limbs_bytes(e, s), s->most);
}

static void put_operations(const struct emission *e, struct text *out)
{
	text_put(out, "\noperations       mul    add    sub    neg    fma sincos  flops\n");
	for (int i = 0; i < e->function_count; i++) {
		struct operation_count n = i ? plan_operations(&e->functions[i].plan)
					     : emit_operations(e);

		text_printf(out, "  %-10s %7u %6u %6u %6u %6u %6u %6u\n", e->functions[i].algorithm->name, n.mul, n.add,
			n.sub, n.neg, n.fma, n.sincos, plan_flops(n));
		if (e->wide)
			text_printf(out, "  %u of the flops in %s: residuals of refinement\n", n.wide, e->wide->arithmetic->name);
	}
	parts_put_table(e, out);
	if (emit_has_limbs(e))
		put_limbs("limbs", emit_limbs_of(e), out);
	if (emit_start_limbs(e))
		put_limbs("limbs of the start", emit_start_limbs(e), out);
}

/* By the scene's words, and as the text has them. */
static void put_arrays(const struct analysis *a, const struct dag *d, int is_output, struct text *out)
{
	text_printf(out, "\n%-32s rows  in the text\n", is_output ? "outputs" : "inputs");
	for (int i = 0; i < d->argument_count; i++) {
		const struct argument *x = &d->arguments[i];
		struct text word;

		if (x->is_output != is_output)
			continue;
		text_init(&word, a->arena);
		request_put_word(&a->request, x->name, is_output, &word);
		text_printf(out, "  %-30s %4d  %s%s\n", text_string(&word), x->rows, x->name, x->per_batch ? ", one for all samples" : "");
	}
}

static int is_gravity_free(const struct request *k)
{
	for (int i = 0; i < k->freed_count; i++)
		if (k->freed[i].kind == FREED_GRAVITY)
			return 1;
	return 0;
}

void info_table(const struct info *x, struct text *out)
{
	const struct analysis *a = x->analysis;
	const struct emission *e = x->emission;
	const struct tree *t = &a->tree;

	text_printf(out, "robot %s (functions %s_...): nq %d, nv %d, %d moving bodies, %.6Lg kg, %.6Lg kg of it fixed to the world\n",
		t->robot, e->options->name, t->nq, t->nv, t->body_count, total_mass(&a->stated), t->fixed.mass.x);
	text_put(out, is_gravity_free(&a->request) ? "gravity an input, by default " : "gravity ");
	for (int i = 0; i < 3; i++)
		text_printf(out, "%s ", number_plain((double)t->gravity[i].x).s);
	text_printf(out,
		t->floating ? "in the world, in which root link %s floats\n\n" : "in the world, the frame of root link %s\n\n",
		t->root);
	text_put(out, " link parent  type       row in q         mass  joint -> link\n");
	for (int k = 0; k < t->body_count; k++)
		put_body(t, &a->stated.bodies[k], out);
	for (int i = 0; i < t->mimic_count; i++)
		text_printf(out, "%s%s = %.9Lg * %s + %.9Lg\n", i ? "  " : "\nmimic\n  ", t->mimics[i].name,
			t->mimics[i].multiplier.x, t->mimics[i].driver, t->mimics[i].offset.x);
	scene_put_table(&a->scene, &a->outcome, out);
	put_arrays(a, &a->dag, 0, out);
	put_arrays(a, &a->dag, 1, out);
	params_put_table(a, out);
	trig_put_table(a, out);
	saving_put_table(&x->savings, &a->scene, out);
	effect_put_table(&x->effects, a, out);
	scene_put_ignored(&a->outcome, out);
	put_operations(e, out);
	for (size_t i = 0; i < e->warning_count; i++)
		text_printf(out, "%s%s\n", i ? "  " : "\nwarnings\n  ", e->warnings[i]);
}

static void put_json_joints(const struct tree *t, struct text *out)
{
	text_put(out, "  \"joints\": [");
	for (int i = 0; i < t->joint_count; i++) {
		const struct tree_joint *j = &t->joints[i];

		text_put(out, i ? ",\n    {\"name\": " : "\n    {\"name\": ");
		text_put_json(out, j->name);
		text_printf(out, ", \"type\": \"%s\", \"iq\": %d, \"nq\": %d, \"iv\": %d, \"nv\": %d}", joint_type_name(j->type),
			j->iq, j->nq, j->iv, j->nv);
	}
	text_put(out, "\n  ],\n  \"mimic\": [");
	for (int i = 0; i < t->mimic_count; i++) {
		const struct tree_mimic *m = &t->mimics[i];

		text_put(out, i ? ",\n    {\"name\": " : "\n    {\"name\": ");
		text_put_json(out, m->name);
		text_put(out, ", \"driver\": ");
		text_put_json(out, m->driver);
		text_printf(out, ", \"multiplier\": %s, \"offset\": %s}", number_plain((double)m->multiplier.x).s,
			number_plain((double)m->offset.x).s);
	}
	text_put(out, t->mimic_count ? "\n  ],\n" : "],\n");
}

static void put_json_array(const struct argument *a, int is_first, struct text *out)
{
	text_printf(out, "%s\n      {\"name\": \"%s\", \"rows\": %d, \"role\": \"%s\", \"of\": ", is_first ? "" : ",", a->name,
		a->rows, role_word(a->role));
	text_put_json(out, a->of ? a->of : "");
	text_printf(out, ", \"per_batch\": %s}", a->per_batch ? "true" : "false");
}

static void put_json_arrays(const struct dag *d, int is_output, struct text *out)
{
	int count = 0;

	for (int i = 0; i < d->argument_count; i++)
		if (d->arguments[i].is_output == is_output)
			put_json_array(&d->arguments[i], count++ == 0, out);
	text_put(out, count ? "\n    ]" : "]");
}

/* What the text has, by the names and with the arrays that its table lists. */
static void put_json_functions(const struct emission *e, struct text *out)
{
	text_put(out, "  \"functions\": [");
	for (int i = 0; i < e->function_count; i++) {
		text_printf(out, "%s\n    {\"name\": \"%s\", \"inputs\": [", i ? "," : "", e->functions[i].algorithm->name);
		put_json_arrays(&e->functions[i].dag, 0, out);
		text_put(out, ", \"outputs\": [");
		put_json_arrays(&e->functions[i].dag, 1, out);
		text_putc(out, '}');
	}
	text_put(out, "\n  ],\n");
}

void info_json(const struct info *x, struct text *out)
{
	const struct analysis *a = x->analysis;
	const struct emission *e = x->emission;
	struct operation_count n = emit_operations(e);

	text_put(out, "{\n  \"name\": ");
	text_put_json(out, e->options->name);
	text_put(out, ",\n  \"robot\": ");
	text_put_json(out, e->tree->robot);
	text_printf(out, ",\n  \"nq\": %d,\n  \"nv\": %d,\n  \"nb\": %d,\n", e->tree->nq, e->tree->nv, e->tree->body_count);
	put_json_joints(e->tree, out);
	scene_put_json(&a->scene, &a->outcome, out);
	params_put_json(a, out);
	saving_put_json(&x->savings, &a->scene, out);
	effect_put_json(&x->effects, a, out);
	scene_put_json_ignored(&a->outcome, out);
	put_json_functions(e, out);
	emit_pattern_json(e, out);
	inertia_put_json(a, out);
	parts_put_json(e, out);
	if (e->target->kernel)
		text_printf(out, "  \"block\": %d,\n  \"stage_bytes\": %d,\n", e->kernels.block, emit_stage_bytes(e));
	if (emit_each_block(e))
		text_printf(out, "  \"sample_threads\": %d,\n  \"most_block\": %d,\n", emit_loops(e)->limbs, emit_each_block(e));
	if (emit_has_limbs(e))
		put_limbs_json(e, "limbs", emit_limbs_of(e), out);
	if (emit_start_limbs(e))
		put_limbs_json(e, "start_limbs", emit_start_limbs(e), out);
	text_put(out, "  \"warnings\": [");
	for (size_t i = 0; i < e->warning_count; i++) {
		text_put(out, i ? ",\n    " : "\n    ");
		text_put_json(out, e->warnings[i]);
	}
	text_put(out, e->warning_count ? "\n  ],\n" : "],\n");
	if (e->wide)
		text_printf(out, "  \"refinement\": {\"steps\": %d, \"residual\": \"%s\", \"flops\": %u},\n",
			e->request->refine_steps, e->wide->arithmetic->name, n.wide);
	text_printf(out,
		"  \"operations\": {\"mul\": %u, \"add\": %u, \"sub\": %u, \"neg\": %u, \"fma\": %u, \"sincos\": %u, \"flops\": %u}\n}\n",
		n.mul, n.add, n.sub, n.neg, n.fma, n.sincos, plan_flops(n));
}
