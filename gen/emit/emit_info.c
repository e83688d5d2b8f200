/* The table NAME_info, which librnea reads. */
#include "emit/emit.h"
#include "emit/kernels/emit_alone.h"
#include "emit/kernels/emit_kernel.h"
#include "emit/kernels/emit_limbs.h"
#include "emit/kernels/emit_relay.h"
#include "plan/segments.h"
#include "emit/kernels/emit_segments_kernel.h"
#include "emit/kernels/emit_tiles.h"
#include "emit/kernels/emit_transpose.h"
#include "plan/stage.h"
#include "plan/tiles/tiles.h"
#include <string.h>

struct operation_count emit_operations(const struct emission *e)
{
	return e->relay ? relay_operations(e->relay, e->parts, e->part_count)
		: parts_operations(e->parts, e->part_count, &emit_main(e)->plan);
}

void emit_literal(const char *s, size_t length, struct text *out)
{
	for (size_t i = 0; i < length; i++) {
		unsigned char c = (unsigned char)s[i];

		if (c == '"' || c == '\\')
			text_printf(out, "\\%c", c);
		else if (c < 0x20 || c >= 0x7f || c == '?')
			text_printf(out, "\\%03o", c); /* '?': no trigraphs */
		else
			text_putc(out, (char)c);
	}
}

/* One line of the table as a string literal; whatever stands in a name stays inside. */
static void put_literal_line(const char *s, size_t length, struct text *out)
{
	text_put(out, "\t\"");
	emit_literal(s, length, out);
	text_put(out, "\\n\"");
}

void emit_info_name(const char *s, struct text *out)
{
	for (; *s; s++)
		text_putc(out, (unsigned char)*s < 0x20 ? '?' : *s);
	text_putc(out, '\n');
}

static void put_limbs(const struct emission *e, const char *key, const struct limbs *s, struct text *out)
{
	text_printf(out, "%s %d %d %d %u\n", key, s->warps, s->groups, emit_limbs_bytes(e, s), s->most);
}

static void put_relay(const struct emission *e, struct text *out)
{
	const struct relay *r = e->relay;

	text_printf(out, "relay %d %d %d", emit_relay_bytes(e), r->threads, r->room);
	if (r->samples > WARP_THREADS || e->is_transposed) /* from version 9 on it stands */
		text_printf(out, " %d", r->samples);
	text_putc(out, '\n');
	if (r->start_count)
		text_printf(out, "start_parts %d\n", r->start_count);
}

/* What launches must know of the main function's kernels. */
static void put_kernels(const struct emission *e, struct text *out)
{
	if (emit_stage_bytes(e))
		text_printf(out, "stage %d\n", emit_stage_bytes(e));
	if (e->part_count - emit_hands(e) > 1)
		text_printf(out, "parts %d\n", e->part_count - emit_hands(e));
	if (emit_each_block(e))
		text_printf(out, "threads %d %d\n", emit_loops(e)->limbs, emit_each_block(e));
	if (e->kernels.alone_least) {
		text_printf(out, "part_kernels %d %d %d %d\n", e->kernels.alone_least, emit_part_places(e), e->kernels.alone_block,
			e->kernels.serves_untiled ? 0 : TILES_ARCH);
		emit_info_tiles(e, out);
	}
	if (emit_hands(e)) {
		text_put(out, "hands");
		for (int level = 0; level < emit_hand_levels(e); level++)
			text_printf(out, " %d", emit_hands_of(e, level));
		text_put(out, "\n");
	}
	if (e->relay)
		put_relay(e, out);
	emit_info_transpose(e, out);
	if (emit_has_limbs(e))
		put_limbs(e, emit_is_apart(e) ? "whole_limbs" : "limbs", emit_limbs_of(e), out);
	if (emit_start_limbs(e))
		put_limbs(e, "start_limbs", emit_start_limbs(e), out);
}

/* A function of the table: what it takes and gives, and what it costs. Only the first has matrices, stages or is in parts. */
static void put_function(const struct emission *e, const struct function *p, struct text *out)
{
	int is_main = p == emit_main(e);
	struct operation_count n = is_main ? emit_operations(e) : plan_operations(&p->plan);

	text_printf(out, "function %s\n", p->algorithm->name);
	for (const struct argument *a = p->dag.arguments; a < p->dag.arguments + p->dag.argument_count; a++) {
		int is_of = a->of && *a->of;

		text_printf(out, "%s %s %d %s %s %s%s", a->is_output ? "output" : "input", a->name, a->rows, e->memory->name,
			a->per_batch ? "batch" : "sample", role_word(a->role), is_of ? " " : "");
		emit_info_name(is_of ? a->of : "", out);
	}
	if (is_main) {
		emit_info_matrices(e, out);
		emit_info_parameters(e, out);
	}
	text_printf(out, "operations %u %u %u %u %u %u\n", n.mul, n.add, n.sub, n.neg, n.fma, n.sincos);
	if (e->target->kernel && p->segments.count)
		text_printf(out, "segments %d %d\n",
			segments_bytes(&p->segments, e->options, e->wide != NULL), kernels_segment_samples(e->options));
	if (is_main)
		put_kernels(e, out);
}

/* What knows no relays, no hands, no parts of a relay's first kernel, no more than one kernel for hands, no threads of a
   sample, no relay with blocks of more samples than a warp's, or no limbs of two kernels, is not to launch some of the kernels
   alone, a part, half of the threads, or other blocks. */
enum { VERSION = 3, VERSION_RELAY, VERSION_HANDS, VERSION_STARTS, VERSION_LEVELS, VERSION_THREADS, VERSION_WIDE,
	VERSION_TRANSPOSED, VERSION_ROUNDS };

static int version_of(const struct emission *e)
{
	if (e->rounds)
		return VERSION_ROUNDS;
	if (e->is_transposed)
		return VERSION_TRANSPOSED;
	if (emit_each_block(e))
		return VERSION_THREADS;
	if (e->relay && e->relay->samples > WARP_THREADS)
		return VERSION_WIDE;
	if (e->relay)
		return e->relay->start_count ? VERSION_STARTS : VERSION_RELAY;
	if (emit_hand_levels(e) > 1)
		return VERSION_LEVELS;
	return emit_hands(e) ? VERSION_HANDS : VERSION;
}

static void put_info_lines(const struct emission *e, struct text *t)
{
	const struct rneagen_options *o = e->options;

	text_printf(t, "rneagen-info %d\nname %s\nprecision %s\narithmetic %s\nlayout %s\ntrig %s\nbase %s\n",
		version_of(e), o->name,
		e->memory->name, e->arithmetic->name, emit_layout_name(o->layout), emit_trig_name(o->trig),
		o->base == RNEAGEN_FLOATING ? "floating" : "fixed");
	text_printf(t, "nq %d\nnv %d\nnb %d\nblock %d\n", e->tree->nq, e->tree->nv, e->tree->body_count, e->kernels.block);
	for (int i = 0; i < e->tree->joint_count; i++) {
		const struct tree_joint *j = &e->tree->joints[i];

		text_printf(t, "joint %d %d %d %d %s ", j->iq, j->nq, j->iv, j->nv, joint_type_name(j->type));
		emit_info_name(j->name, t);
	}
	for (int i = 0; i < e->function_count; i++)
		put_function(e, &e->functions[i], t);
}

void emit_info(const struct emission *e, struct text *out)
{
	struct text t;

	text_init(&t, e->arena);
	put_info_lines(e, &t);
	out->failed |= t.failed;
	for (const char *s = t.failed ? "" : text_string(&t); *s;) { /* what failed may end within a line */
		const char *end = strchr(s, '\n');

		put_literal_line(s, (size_t)(end - s), out);
		s = end + 1;
		if (*s)
			text_putc(out, '\n');
	}
}
