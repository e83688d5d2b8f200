/* Who asks whether angles are small enough for sines without a branch, and of which rows. */
#include "base/template.h"
#include "emit/emit.h"
#include "emit/kernels/emit_alone.h"
#include "emit/kernels/emit_tiles.h"
#include "plan/tiles/tiles.h"
#include <math.h>

/* The largest |q| for which no angle leaves the domain of the bounded functions: a follower turns by a multiple of q. */
static const char *small_limit(const struct emission *e)
{
	real most = 1;
	struct text t;

	for (int k = 0; k < e->tree->body_count; k++)
		if (fabsl(e->tree->bodies[k].multiplier.x) > most)
			most = fabsl(e->tree->bodies[k].multiplier.x);
	text_init(&t, e->arena);
	/* less the product's rounding */
	emit_number(e, e->memory, (real)e->arithmetic->domain * (most > 1 ? 0.999L / most : 1), &t);
	return text_string(&t);
}

/* Does a function ask whether a sample's angles are small, before it computes? */
static int tests_angles(const struct emission *e)
{
	return emit_has_batches(e) || !e->target->has_batches;
}

int emit_asks_by_parts(const struct emission *e)
{
	return e->kernels.has_columns && (!e->kernels.is_optimistic || e->kernels.has_tiles);
}

/* Does a kernel test all angles before it computes? Not one that finds out afterwards, and not one in parts with tests of their
   own. */
static int kernels_ask(const struct emission *e)
{
	if (e->relay)
		return 1;
	for (int i = 0; i < e->function_count; i++)
		if (emit_has_angles(e, &e->functions[i]) &&
			(i || !(e->kernels.is_optimistic || emit_is_apart(e) || emit_asks_by_parts(e) ||
				      e->functions[i].segments.count)))
			return 1;
	return 0;
}

static void put_small_loop(const struct emission *e, struct stretch rows, const char *index, struct text *out)
{
	text_printf(out, "\tfor (size_t i = %d; i < %d; i++)\n\t\tsmall &= fabs%s(q[%s*stride]) <= %s;\n", rows.first,
		rows.first + rows.rows, e->memory->suffix, index, small_limit(e));
}

/* In each stretch. */
static const char *small_loops(const struct emission *e, const struct stretch rows[STRETCHES])
{
	struct text t;

	text_init(&t, e->arena);
	for (int k = 0; k < STRETCHES; k++)
		if (rows[k].rows)
			put_small_loop(e, rows[k], k ? "(i - gap)" : "i", &t);
	return text_string(&t);
}

static void put_small_of(const struct emission *e, const char *what, const char *name, const char *loops, const char *gap,
	struct text *out)
{
	const struct slot slots[] = {{"WHAT", what}, {"NAME", name}, {"T", e->memory->type}, {"F", e->memory->suffix},
		{"LOOPS", loops}, {"GAP", gap},
		{"BITS", emit_main(e)->single || emit_main(e)->lanes_in_batches ? "" : "; the results have the same bits either way"}};

	template_expand(out, template_is_small_in, slots, sizeof slots / sizeof *slots);
}

/* The test of some rows of q, which may be in two stretches. */
static void put_small(const struct emission *e, const char *what, const char *name, const struct stretch rows[STRETCHES],
	struct text *out)
{
	put_small_of(e, what, name, small_loops(e, rows), rows[1].rows ? ", const size_t gap" : "", out);
}

const char *emit_is_small(const struct emission *e)
{
	int host_only = e->target->kernel && !kernels_ask(e), is_for_alone = emit_alone_is_whole(e);
	struct text t;

	text_init(&t, e->arena);
	if (!emit_has_known(e))
		return "";
	if (!tests_angles(e))
		return emit_sines(e);
	if (host_only)
		text_printf(&t, "#if !defined %s%s\n", e->target->kernel->compiler, is_for_alone ? " || !defined RNEA_NO_PART_KERNELS" : "");
	put_small(e, "a sample", e->options->name, (const struct stretch[STRETCHES]){{0, e->tree->nq}}, &t);
	text_put(&t, host_only ? "#endif\n" : "");
	text_put(&t, emit_sines(e));
	return text_string(&t);
}

void emit_part_small(const struct emission *e, const struct part *part, struct text *out)
{
	const char *name = text_format(e->arena, "%s_%s", e->options->name, part->function.algorithm->name);

	if (emit_has_known(e) && emit_has_angles(e, &part->function))
		put_small(e, "a part", name, tiles_rows(&part->function)->own[0], out);
}

/* Of each run of the rows that a part reads. */
static void put_column_small(const struct emission *e, const struct function *p, struct text *out)
{
	const struct dag *d = &p->dag;
	char *is_read = arena_alloc(e->arena, (size_t)e->tree->nq + 1, 1);
	const char *name = text_format(e->arena, "%s_%s", e->options->name, p->algorithm->name);
	struct text loops;

	text_init(&loops, e->arena);
	for (size_t i = 0; is_read && i < d->count; i++)
		if (d->nodes[i].op == OP_INPUT && !d->nodes[i].arg[0].i)
			is_read[d->nodes[i].arg[1].i] = 1;
	for (int row = 0, end; is_read && row < e->tree->nq; row = end + 1) {
		for (end = row; is_read[end]; end++)
			;
		if (end > row)
			put_small_loop(e, (struct stretch){row, end - row}, tiles_divide_q(p) && row >= p->tiles->second ? "(i - gap)" : "i", &loops);
	}
	put_small_of(e, "a part", name, text_string(&loops), tiles_divide_q(p) ? ", const size_t gap" : "", out);
}

static int has_parts_small(const struct emission *e)
{
	return emit_has_known(e) && emit_has_angles(e, emit_main(e)) && emit_asks_by_parts(e);
}

void emit_parts_small(const struct emission *e, int is_alone, struct text *out)
{
	for (int i = 0; i < e->part_count && has_parts_small(e) && is_alone == e->kernels.is_optimistic; i++)
		put_column_small(e, &e->parts[i].function, out);
}

void emit_part_asks(const struct emission *e, struct text *out)
{
	struct text cases;

	if (!has_parts_small(e) || e->kernels.is_optimistic)
		return;
	text_init(&cases, e->arena);
	for (int i = 0; i < e->part_count; i++)
		text_printf(&cases, "\tcase %d:\n\t\treturn %s_%s_is_small(q, stride%s);\n", i, e->options->name,
			e->parts[i].function.algorithm->name, tiles_divide_q(&e->parts[i].function) ? ", 0" : "");
	const struct slot slots[] = {{"NAME", e->options->name}, {"FUNCTION", emit_main(e)->algorithm->name}, {"T", e->memory->type},
		{"CASES", text_string(&cases)}};

	template_expand(out, template_parts_small_in, slots, sizeof slots / sizeof *slots);
}
