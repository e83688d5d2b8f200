#include "tell/parts_put.h"
#include "emit/kernels/emit_transpose.h"

/* The kernel that a part is of. */
static const char *kernel_of(const struct emission *e, const struct part *p)
{
	const char *kernel = p->is_before ? emit_hands_kernel(e, p->level) : "kernel";

	return text_format(e->arena, "%s_%s_%s", e->options->name, emit_main(e)->algorithm->name, kernel);
}

void parts_put_table(const struct emission *e, struct text *out)
{
	if (e->relay) {
		text_put(out, "\nrelay: three kernels, one after the other; the table of parts is the second's\n");
		relay_dump(e->relay, out);
	}
	if (e->part_count)
		text_put(out, "\nparts           links  flops  alive\n");
	for (int i = 0; i < e->part_count; i++) {
		const struct part *p = &e->parts[i];

		text_printf(out, "  %-10d %3d..%-3d %6u %6d  %s", i, e->tree->bodies[p->first].number,
			e->tree->bodies[p->last].number, plan_flops(part_operations(p)), p->alive, kernel_of(e, p));
		if (p->what)
			text_printf(out, ": %s", p->what);
		if (p->joints)
			text_printf(out, "  motion made again, by stretches of at most %d joints", p->joints);
		if (p->function.each)
			text_printf(out, "  alike limbs in %d loops", p->function.each->loops->count);
		text_putc(out, '\n');
	}
	if (e->is_transposed) {
		const struct transposed t = emit_transposed(e);

		text_printf(out, "\ntransposed: a last kernel puts the outputs of %d samples at a time into their places, by %d threads with "
			"%d bytes\n", t.samples, t.threads, t.bytes);
	}
}

void parts_put_json(const struct emission *e, struct text *out)
{
	if (e->relay)
		text_printf(out, "  \"relay\": {\"start_flops\": %u, \"start_parts\": %d, \"values\": %d, \"columns\": %d, \"samples\": %d, "
			"\"threads\": %d},\n",
			plan_flops(plan_operations(&e->relay->start.function.plan)), e->relay->start_count ? e->relay->start_count : 1,
			e->relay->solve.function.segments.slots[0], relay_columns(e->relay),
			e->relay->samples, e->relay->threads);
	for (int i = 0; i < e->part_count; i++) {
		const struct part *p = &e->parts[i];

		text_printf(out,
			"%s\n    {\"first\": %d, \"last\": %d, \"flops\": %u, \"alive\": %d, \"kernel\": \"%s\", \"what\": \"%s\", "
			"\"stretch\": %d, \"loops\": %d}",
			i ? "," : "  \"parts\": [", e->tree->bodies[p->first].number, e->tree->bodies[p->last].number,
			plan_flops(part_operations(p)), p->alive, kernel_of(e, p), p->what ? p->what : "", p->joints,
			p->function.each ? p->function.each->loops->count : 0);
	}
	text_put(out, e->part_count ? "\n  ],\n" : "");
	if (e->is_transposed) {
		const struct transposed t = emit_transposed(e);

		text_printf(out, "  \"transposed\": {\"samples\": %d, \"threads\": %d, \"bytes\": %d},\n", t.samples, t.threads, t.bytes);
	}
}
