/* What a text's head says about its kernels. */
#include "emit/kernels/emit_alone.h"
#include "emit/kernels/emit_kernel.h"
#include "emit/kernels/emit_limbs.h"
#include "emit/kernels/emit_tiles.h"
#include "emit/kernels/emit_transpose.h"
#include "emit/emit.h"
#include <string.h>

static void put_relay(const struct emission *e, struct text *out)
{
	const char *name = e->options->name, *function = emit_main(e)->algorithm->name;

	text_printf(out, " * %s_%s_launch runs three kernels: %s_%s_start_kernel finds qdd,\n"
		" * %s_%s_kernel leaves -d tau where the gradients belong,\n"
		" * %s_%s_solve_kernel makes them of it by the factors of M; a block has %d samples, threads for each: %d.\n",
		name, function, name, function, name, function, name, function, e->relay->samples,
		e->relay->threads);
	if (e->relay->start_count)
		text_printf(out, " * The grid of the first has %d blocks along y, each for limbs that share nothing with the others.\n",
			e->relay->start_count);
}

static void put_hands(const struct emission *e, struct text *out)
{
	const char *name = e->options->name, *function = emit_main(e)->algorithm->name;
	int levels = emit_hand_levels(e);

	text_printf(out, " * %s_%s_launch runs %s kernels. %s_%s_hands_kernel, with %d blocks along y, writes the torques of hands,\n"
		" * and into rows of the arms what the hands hand on; %s_%s_kernel reads that, and writes all other rows.\n",
		name, function, levels > 1 ? emit_int(e, levels + 1) : "two", name, function, emit_hands_of(e, 0), name, function);
	for (int level = 1; level < levels; level++)
		text_printf(out, " * After the first, %s_%s_%s does so, with %d along y, for ends of long arms.\n", name, function,
			emit_hands_kernel(e, level), emit_hands_of(e, level));
}

/* The sides of a base. */
static void put_sides(const struct emission *e, struct text *out)
{
	const char *name = e->options->name, *function = emit_main(e)->algorithm->name;

	text_printf(out, " * %s_%s_launch runs two kernels. %s_%s_hands_kernel makes %s,\n"
		" * left in rows that %s_%s_kernel reads, before it writes these and the rest.\n",
		name, function, name, function, e->parts->what, name, function);
}

/* What a kernel's parts make, each thing once. */
static void put_whats(const struct part *parts, int count, struct text *out)
{
	for (int i = 0; i < count; i++)
		if (!i || strcmp(parts[i].what, parts[i - 1].what) != 0)
			text_printf(out, "%s%s", i ? "; " : "", parts[i].what);
	text_putc(out, '\n');
}

/* Kernels that read what those before have found. */
static void put_found(const struct emission *e, struct text *out)
{
	const char *name = e->options->name, *function = emit_main(e)->algorithm->name;
	int levels = emit_hand_levels(e), first = 0;

	text_printf(out, " * %s_%s_launch runs %d kernels, one after the other. "
		"In rows of the output each but the last leaves what it makes:\n", name, function, levels + 1);
	for (int level = 0; level < levels; level++) {
		int count = emit_hands_of(e, level);

		text_printf(out, " *   %s_%s_%s", name, function, emit_hands_kernel(e, level));
		if (count > 1)
			text_printf(out, ", with %d blocks along y", count);
		text_put(out, ": ");
		put_whats(e->parts + first, count, out);
		first += count;
	}
	text_printf(out, " *   %s_%s_kernel: ", name, function);
	put_whats(e->parts + first, e->part_count - first, out);
}

/* Rows of the base, which the kernel reads from qdd. */
static void put_base(const struct emission *e, struct text *out)
{
	const char *name = e->options->name, *function = emit_main(e)->algorithm->name;

	text_printf(out, " * %s_%s_launch runs two kernels. %s_%s_hands_kernel makes the base's acceleration, in its rows of qdd;\n"
		" * %s_%s_kernel reads it from there and makes those of the joints.\n", name, function, name, function, name, function);
}

static void put_limbs(const struct emission *e, const char *start, const struct limbs *s, struct text *out)
{
	const char *name = e->options->name, *function = emit_main(e)->algorithm->name;

	text_printf(out, " * Up to %u samples %s_%s_launch takes the kernel %s_%s_%slimbs, whose %d warps share out each sample.\n",
		s->most, name, function, name, function, start, s->warps);
}

static void put_rounds(const struct emission *e, struct text *out)
{
	const char *name = e->options->name, *function = emit_main(e)->algorithm->name;

	text_printf(out, " * Up to %u samples %s_%s_launch takes two other kernels, %s_%s_start_limbs and then\n"
		" * %s_%s_limbs, of which %d and %d warps share out each sample.\n",
		emit_limbs_of(e)->most, name, function, name, function, name, function, emit_start_limbs(e)->warps,
		emit_limbs_of(e)->warps);
}

static void put_loops(const struct emission *e, struct text *out)
{
	const char *name = emit_main(e)->algorithm->name;

	if (emit_each_block(e))
		text_printf(out, " * In the %s kernel %d threads share a sample, one for each of the limbs that are alike; where RNEA_BLOCK"
			"\n * is more than %d, it goes over these in loops instead. ", name, emit_loops(e)->limbs, emit_each_block(e));
	else
		text_printf(out, " * The %s kernel goes over limbs that are alike in loops, %d of them. ", name, emit_loops(e)->count);
	text_put(out, "Its last bits may not be those of the same\n * function of target c.\n");
}

/* Kernels before the main one. */
static void put_before(const struct emission *e, struct text *out)
{
	enum division division = emit_division(e);

	if (division == DIVIDED_IN_ROUNDS || (division == DIVIDED_BASE_FIRST && emit_hand_levels(e) > 1))
		put_found(e, out);
	else if (division == DIVIDED_BASE_FIRST)
		put_base(e, out);
	else if (division == DIVIDED_BY_SIDES)
		put_sides(e, out);
	else if (division == DIVIDED_BY_HANDS)
		put_hands(e, out);
}

void emit_kernels_head(const struct emission *e, struct text *out)
{
	if (e->relay)
		put_relay(e, out);
	put_before(e, out);
	if (e->part_count - emit_hands(e) > 1)
		text_printf(out, " * The %s kernel is in %d parts: its grid has as many along y, each for %s.\n", emit_main(e)->algorithm->name,
			e->part_count - emit_hands(e), emit_is_apart(e) ? "limbs that share nothing with the others" : "the elements of some joints");
	if (e->kernels.alone_least)
		text_printf(out, " * From %d samples on %s_%s_launch takes %s_%s_part0_kernel and so on, one for each part, instead%s.\n",
			e->kernels.alone_least, e->options->name, emit_main(e)->algorithm->name, e->options->name, emit_main(e)->algorithm->name,
			e->kernels.has_tiles ? ", where\n * the rows of all arrays begin at multiples of 16 bytes" : "");
	if (e->is_transposed)
		text_printf(out, " * %s_%s_launch runs %s_%s_transpose_kernel last: it transposes outputs that the others have written\n"
			" * as [row][sample] of %d samples at a time.\n", e->options->name, emit_main(e)->algorithm->name, e->options->name,
			emit_main(e)->algorithm->name, emit_transposed(e).samples);
	if (emit_joints_again(e))
		text_printf(out, " * The %s kernel makes some motion again, by stretches of at most %d joints, instead of keeping it.\n",
			emit_main(e)->algorithm->name, emit_joints_again(e));
	if (emit_loops(e))
		put_loops(e, out);
	if (e->rounds)
		put_rounds(e, out);
	if (emit_has_limbs(e) && !e->rounds)
		put_limbs(e, "", emit_limbs_of(e), out);
	if (emit_start_limbs(e) && !e->rounds)
		put_limbs(e, "start_", emit_start_limbs(e), out);
}
