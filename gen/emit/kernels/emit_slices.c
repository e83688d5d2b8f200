/* Slices of the batch in shared memory: where those of the arrays stand, how they come and go, and what the body is called with.
   A part that shares nothing with others has stretches of rows alone. */
#include "base/template.h"
#include "emit/emit.h"
#include "emit/kernels/emit_blocks.h"
#include "emit/kernels/emit_slices.h"
#include "plan/stage.h"
#include <stdlib.h>

static struct stretch stretch_of(const struct stretches *s, const struct dag *d, int argument, int k)
{
	return s ? s->own[argument][k] : (struct stretch){0, k ? 0 : d->arguments[argument].rows};
}

/* Whose place an array takes. */
static int place_of(const struct stretches *s, const struct dag *d, int argument)
{
	return s ? s->place_of[argument] : stage_place(d, argument);
}

/* Rows in the place of an array, its own or another's, and the first of them. */
static int place_rows(const struct stretches *s, const struct dag *d, int argument)
{
	int place = place_of(s, d, argument);

	return s ? stretches_rows(s, place) : d->arguments[place].rows;
}

/* How much further on a row stands there. */
static int shift_of(const struct stretches *s, int argument)
{
	return s && s->period && argument == s->divided ? s->shift : 0;
}

static int place_first(const struct stretches *s, const struct dag *d, int argument)
{
	return s ? s->place[place_of(s, d, argument)][0].first : 0;
}

int emit_slot(const struct stretches *s, const struct dag *d, int argument, int k)
{
	return stretch_of(s, d, argument, k).first - place_first(s, d, argument) - (k ? s->gap : 0);
}

static const struct dag *arguments_of(const struct emission *e)
{
	return &emit_main(e)->dag;
}

/* `*const q_slice = slices, *const qd_slice = q_slice + RNEA_BLOCK*7, ...`: where the slices of the arrays begin; in soa
   where this thread's rows do. */
static const char *slices_text(const struct emission *e, const struct stretches *s, const char *block)
{
	const struct dag *d = arguments_of(e);
	struct text t;
	int last = -1;

	text_init(&t, e->arena);
	for (int i = 0; i < d->argument_count; i++) {
		if (d->arguments[i].per_batch || place_of(s, d, i) != i || !place_rows(s, d, i))
			continue;
		text_printf(&t, "%s*const %s_slice = ", last >= 0 ? ", " : "", d->arguments[i].name);
		if (last >= 0)
			text_printf(&t, "%s_slice + %s*%d", d->arguments[last].name, block, emit_pitch(e, place_rows(s, d, last)));
		else
			text_put(&t, e->options->layout == RNEAGEN_AOS ? "slices" : "slices + threadIdx.x");
		last = i;
	}
	return text_string(&t);
}

/* What the body is called with: q_here, qd_here, ..., and as it is what all samples share. */
static const char *here_text(const struct emission *e)
{
	const struct dag *d = arguments_of(e);
	struct text t;

	text_init(&t, e->arena);
	for (int i = 0; i < d->argument_count; i++)
		text_printf(&t, "%s%s%s", i ? ", " : "", d->arguments[i].name, d->arguments[i].per_batch ? "" : "_here");
	return text_string(&t);
}

/* Those pointers: to this thread's rows in the slices or, where nothing is staged, in the arrays; from row 0 on, which a part's
   slice may lack. */
static const char *pointers_text(const struct emission *e, const struct stretches *s, const char *block)
{
	const struct dag *d = arguments_of(e);
	struct text t;

	text_init(&t, e->arena);
	for (int i = 0; i < d->argument_count; i++) {
		const struct argument *a = &d->arguments[i];
		int before = shift_of(s, i) - place_first(s, d, i);

		if (a->per_batch)
			continue;
		if (!place_rows(s, d, i)) { /* it is in no slice */
			text_printf(&t, "\t%s%s *const %s_here = %s + k;\n", a->is_output ? "" : "const ", e->memory->type, a->name, a->name);
			continue;
		}
		text_printf(&t, "%s%s%s *const %s_here = staged ? %s_slice", e->options->layout == RNEAGEN_AOS ? "\t\t" : "\t",
			a->is_output ? "" : "const ", e->memory->type, a->name, d->arguments[place_of(s, d, i)].name);
		if (e->options->layout == RNEAGEN_AOS)
			text_printf(&t, " + %s*%d", emit_each_block(e) ? "sample" : "threadIdx.x", emit_pitch(e, place_rows(s, d, i)));
		if (before)
			text_printf(&t, " %c %s%s%d", before < 0 ? '-' : '+', e->options->layout == RNEAGEN_AOS ? "" : block,
				e->options->layout == RNEAGEN_AOS ? "" : "*", abs(before));
		text_printf(&t, " : %s + k", a->name);
		if (e->options->layout == RNEAGEN_AOS)
			text_printf(&t, "*%d", a->rows);
		text_put(&t, ";\n");
	}
	return text_string(&t);
}

typedef void put_move(const struct emission *e, const struct stretches *s, int argument, int k, struct text *out);

/* aos: a line for each stretch that comes, or goes. */
static const char *moves_text(const struct emission *e, const struct stretches *s, int is_output, put_move *put)
{
	const struct dag *d = arguments_of(e);
	struct text t;

	text_init(&t, e->arena);
	for (int i = 0; i < d->argument_count; i++)
		for (int k = 0; k < STRETCHES && !d->arguments[i].per_batch && d->arguments[i].is_output == is_output; k++)
			if (stretch_of(s, d, i, k).rows)
				put(e, s, i, k, &t);
	return text_string(&t);
}

/* Is a stretch some rows of each sample, of an array that has more, or of which other parts have the others? */
static int is_some(const struct emission *e, const struct stretches *s, int argument, int k)
{
	return s && (e->part_count > 1 || stretch_of(s, arguments_of(e), argument, k).rows < arguments_of(e)->arguments[argument].rows);
}

/* `rneagen_stage_in<7, 7>(`, and where there are other rows, or other parts, `rneagen_stage_rows_in<7, 7, 30>(`, of how many. */
static void put_function(const struct emission *e, const struct stretches *s, const char *direction, int argument, int k,
	struct text *out)
{
	const struct dag *d = arguments_of(e);
	int rows = stretch_of(s, d, argument, k).rows;

	text_printf(out, "\t\trneagen_stage%s_%s<%d, %d", is_some(e, s, argument, k) ? "_rows" : "", direction, rows,
		emit_pitch(e, place_rows(s, d, argument)));
	if (is_some(e, s, argument, k))
		text_printf(out, ", %d", d->arguments[argument].rows);
	text_put(out, ">(");
}

/* `q + first*7`, and for a part `+ 3`, where its rows begin. */
static void put_array(const struct emission *e, const struct stretches *s, int argument, int k, struct text *out)
{
	const struct argument *a = &arguments_of(e)->arguments[argument];
	int first = stretch_of(s, arguments_of(e), argument, k).first;

	text_printf(out, "%s + first*%d", a->name, a->rows);
	if (first)
		text_printf(out, " + %d", first);
}

static void put_slice_in(const struct emission *e, const struct stretches *s, int argument, int k, struct text *out)
{
	const struct dag *d = arguments_of(e);

	put_function(e, s, "in", argument, k, out);
	text_printf(out, "%s_slice", d->arguments[argument].name);
	if (emit_slot(s, d, argument, k))
		text_printf(out, " + %d", emit_slot(s, d, argument, k));
	text_put(out, ", ");
	put_array(e, s, argument, k, out);
	text_put(out, ", samples);\n");
}

/* Words of a thread that holds all rows of a vjp for a moment; threads that may meet in a bank of shared memory then. H100, 1 M
   samples of tau with vjp in aos, ps, so and by threads that write three runs of each sample, in brackets how many meet: jvrc1
   500 and 554, atlas 370 and 440, g1_29dof 386 and 440, romeo 392 and 451, in f64 baxter 407 and 444, floating hyq 473 and 503,
   but pr2 1147 and 1115, and shadow_hand_right 950 and 878 (8). */
enum { JOINED_WORDS = 240, JOINED_MEET = 4 };

int emit_is_joined(const struct emission *e)
{
	const struct stretches *s = emit_is_apart(e) && e->part_count == 1 ? e->parts->function.stretches : NULL;
	int rows = s && s->period ? PERIODS * s->period : 0;

	return rows && s->own[s->divided]->rows == s->period && rows * e->memory->bytes <= 4 * JOINED_WORDS &&
		rows % (2 * JOINED_MEET) != 0;
}

int emit_moves_some(const struct emission *e)
{
	const struct stretches *s = emit_is_apart(e) ? e->parts->function.stretches : NULL;

	for (int i = 0; s && i < arguments_of(e)->argument_count; i++)
		if (!arguments_of(e)->arguments[i].per_batch && is_some(e, s, i, 0) && !(s->period && i == s->divided && emit_is_joined(e)))
			return 1;
	return 0;
}

int emit_divided_slot(const struct stretches *s)
{
	return s->own[s->divided]->first + s->shift - s->place[0]->first;
}

static const char *join_text(const struct emission *e, const struct stretches *s)
{
	const struct dag *d = arguments_of(e);
	struct text t;

	text_init(&t, e->arena);
	if (s && emit_is_joined(e))
		text_printf(&t, "\t\trneagen_stage_join<%d, %d, %d>(%s_slice);\n", s->period,
			emit_pitch(e, place_rows(s, d, 0)), emit_divided_slot(s), d->arguments[0].name);
	return text_string(&t);
}

/* The rows of a vjp for q, qd and qdd, from the places of these. */
static void put_divided_out(const struct emission *e, const struct stretches *s, struct text *out)
{
	const struct argument *a = &arguments_of(e)->arguments[s->divided];
	const struct stretch *own = s->own[s->divided];
	int slot = emit_divided_slot(s);

	if (emit_is_joined(e)) {
		text_printf(out, "\t\trneagen_stage_out<%d, %d>(%s + first*%d, %s_slice, samples);\n", a->rows, a->rows, a->name, a->rows,
			arguments_of(e)->arguments[0].name);
		return;
	}
	for (int i = 0; i < PERIODS; i++) {
		int first = i * s->period + own->first;

		text_printf(out, "\t\trneagen_stage_rows_out<%d, %d, %d>(%s + first*%d", own->rows,
			emit_pitch(e, place_rows(s, arguments_of(e), i)), a->rows, a->name, a->rows);
		if (first)
			text_printf(out, " + %d", first);
		text_printf(out, ", %s_slice", arguments_of(e)->arguments[i].name);
		if (slot)
			text_printf(out, " + %d", slot);
		text_put(out, ", samples);\n");
	}
}

static void put_slice_out(const struct emission *e, const struct stretches *s, int argument, int k, struct text *out)
{
	const struct dag *d = arguments_of(e);

	if (s && s->period && argument == s->divided) {
		put_divided_out(e, s, out);
		return;
	}
	put_function(e, s, "out", argument, k, out);
	put_array(e, s, argument, k, out);
	text_printf(out, ", %s_slice", d->arguments[place_of(s, d, argument)].name);
	if (emit_slot(s, d, argument, k))
		text_printf(out, " + %d", emit_slot(s, d, argument, k));
	text_put(out, ", samples);\n");
}

/* `r`, or `(r + 3)`. */
static const char *row_text(const struct emission *e, int first)
{
	return text_format(e->arena, first ? "(r + %d)" : "r", first);
}

/* The loop's line for rows of an array. */
static void put_row_move(const struct emission *e, const struct stretches *s, int argument, int k, struct text *out)
{
	const struct dag *d = arguments_of(e);
	const char *name = d->arguments[argument].name, *place = d->arguments[place_of(s, d, argument)].name;
	const char *row = row_text(e, stretch_of(s, d, argument, k).first), *slot = row_text(e, emit_slot(s, d, argument, k));

	if (d->arguments[argument].is_output)
		text_printf(out, "\t\t\t%s[%s*count + k] = %s_slice[%s*RNEA_BLOCK];\n", name, row, place, slot);
	else
		text_printf(out, "\t\t\trneagen_stage_copy<sizeof *%s>(%s_slice + %s*RNEA_BLOCK, %s + %s*count + k);\n", name, name, slot, name,
			row);
}

/* soa: a thread fetches or writes its own sample; one loop for stretches of one length that follow each other. */
static const char *move_samples(const struct emission *e, const struct stretches *s, int out)
{
	const struct dag *d = arguments_of(e);
	struct text t;
	int rows = 0;

	text_init(&t, e->arena);
	for (int n = 0; n < d->argument_count * STRETCHES; n++) {
		int i = n % d->argument_count, k = n / d->argument_count, own = stretch_of(s, d, i, k).rows;

		if (d->arguments[i].per_batch || d->arguments[i].is_output != out || !own)
			continue;
		if (own != rows)
			text_printf(&t, "%s#pragma unroll\n\t\tfor (unsigned r = 0; r < %d; r++) {\n", rows ? "\t\t}\n" : "", own);
		rows = own;
		put_row_move(e, s, i, k, &t);
	}
	text_put(&t, rows ? "\t\t}\n" : "");
	return text_string(&t);
}

struct slices emit_slices(const struct emission *e, const struct stretches *s, const char *block)
{
	int is_aos = e->options->layout == RNEAGEN_AOS;

	return (struct slices){slices_text(e, s, block), here_text(e), pointers_text(e, s, block),
		is_aos ? moves_text(e, s, 0, put_slice_in) : move_samples(e, s, 0),
		is_aos ? moves_text(e, s, 1, put_slice_out) : move_samples(e, s, 1), is_aos ? join_text(e, s) : ""};
}

const char *emit_slices_declaration(const struct emission *e, int words)
{
	const struct slot slots[] = {{"T", e->memory->type}, {"WORDS", emit_int(e, words)}};

	return template_text(e->arena, e->target->kernel->slices, slots, sizeof slots / sizeof *slots);
}
