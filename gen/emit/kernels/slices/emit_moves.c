/* How slices of the batch come to shared memory, and leave it. */
#include "emit/emit.h"
#include "emit/kernels/slices/emit_slices.h"
#include "emit/kernels/slices/slice_rows.h"
#include "plan/stage.h"

typedef void put_move(const struct emission *e, const struct stretches *s, int argument, int k, struct text *out);

/* aos: a line for each stretch that comes, or goes. */
static const char *moves_text(const struct emission *e, const struct stretches *s, int is_output, put_move *put)
{
	const struct dag *d = emit_arguments(e);
	struct text t;

	text_init(&t, e->arena);
	for (int i = 0; i < d->argument_count; i++)
		for (int k = 0; k < STRETCHES && !d->arguments[i].per_batch && d->arguments[i].is_output == is_output; k++)
			if (slice_stretch(s, d, i, k).rows)
				put(e, s, i, k, &t);
	return text_string(&t);
}

/* Parts of the kernel that has the part with these stretches. */
static int parts_beside(const struct emission *e, const struct stretches *s)
{
	int hands = emit_hands(e), count = e->part_count - hands;

	for (int i = 0; i < hands; i++)
		if (e->parts[i].function.stretches == s)
			count = emit_hands_of(e, e->parts[i].level);
	return count;
}

/* Is a stretch some rows of each sample, of an array that has more, or of which other parts have the others? */
static int is_some(const struct emission *e, const struct stretches *s, int argument, int k)
{
	const struct dag *d = emit_arguments(e);

	return s && (parts_beside(e, s) > 1 || slice_stretch(s, d, argument, k).rows < d->arguments[argument].rows);
}

/* `rneagen_stage_in<7, 7>(`, and where there are other rows, or other parts, `rneagen_stage_rows_in<7, 7, 30>(`, of how many. */
static void put_function(const struct emission *e, const struct stretches *s, const char *direction, int argument, int k,
	struct text *out)
{
	const struct dag *d = emit_arguments(e);
	int rows = slice_stretch(s, d, argument, k).rows;

	text_printf(out, "\t\trneagen_stage%s_%s<%d, %d", is_some(e, s, argument, k) ? "_rows" : "", direction, rows,
		stage_pitch(slice_place_rows(s, d, argument), e->options));
	if (is_some(e, s, argument, k))
		text_printf(out, ", %d", d->arguments[argument].rows);
	text_put(out, ">(");
}

/* `q + first*7`, and for a part `+ 3`, where its rows begin. */
static void put_array(const struct emission *e, const struct stretches *s, int argument, int k, struct text *out)
{
	const struct argument *a = &emit_arguments(e)->arguments[argument];
	int first = slice_stretch(s, emit_arguments(e), argument, k).first;

	text_printf(out, "%s + first*%d", a->name, a->rows);
	slice_put_shift(first, out);
}

static void put_slice_in(const struct emission *e, const struct stretches *s, int argument, int k, struct text *out)
{
	const struct dag *d = emit_arguments(e);

	put_function(e, s, "in", argument, k, out);
	text_printf(out, "%s_slice", d->arguments[argument].name);
	slice_put_shift(emit_slot(s, d, argument, k), out);
	text_put(out, ", ");
	put_array(e, s, argument, k, out);
	text_put(out, ", samples);\n");
}

/* Words of a thread that holds all rows of a vjp for a moment; threads that may meet in a bank of shared memory then. H100, 1 M
   samples of tau with vjp in aos, ps, so and by threads that write three runs of each sample, in brackets how many meet: jvrc1
   500 and 554, atlas 370 and 440, g1_29dof 386 and 440, romeo 392 and 451, in f64 baxter 407 and 444, floating hyq 473 and 503,
   but pr2 1147 and 1115, and shadow_hand_right 950 and 878 (8). */
enum { JOINED_WORDS = 240, JOINED_MEET = 4 };

static int is_joined(const struct emission *e, const struct stretches *s)
{
	int rows = s && s->period && parts_beside(e, s) == 1 ? PERIODS * s->period : 0;

	return rows && s->own[s->divided]->rows == s->period && (!s->takes_found || s->found.rows == s->period) &&
		rows * e->memory->bytes <= 4 * JOINED_WORDS && rows % (2 * JOINED_MEET) != 0;
}

/* Does a part move some rows of an array? */
static int moves_some(const struct emission *e, const struct stretches *s)
{
	const struct dag *d = emit_arguments(e);

	for (int i = 0; i < d->argument_count; i++)
		if (!d->arguments[i].per_batch && is_some(e, s, i, 0) && !(s->period && i == s->divided && is_joined(e, s)))
			return 1;
	return 0;
}

typedef int does(const struct emission *e, const struct stretches *s);

static int does_any(const struct emission *e, does *what)
{
	for (int i = 0; i < e->part_count && emit_is_apart(e); i++)
		if (what(e, e->parts[i].function.stretches))
			return 1;
	return 0;
}

int emit_is_joined(const struct emission *e)
{
	return does_any(e, is_joined);
}

int emit_moves_some(const struct emission *e)
{
	return does_any(e, moves_some);
}

/* Has it its kernel for itself, and whole arrays there? */
static int is_alone(const struct emission *e, const struct stretches *s)
{
	return parts_beside(e, s) == 1;
}

int emit_moves_whole(const struct emission *e)
{
	return !emit_is_apart(e) || does_any(e, is_alone);
}

int emit_divided_slot(const struct stretches *s)
{
	return s->own[s->divided]->first + s->shift - s->place[0]->first;
}

const char *slice_join(const struct emission *e, const struct stretches *s)
{
	const struct dag *d = emit_arguments(e);
	struct text t;

	text_init(&t, e->arena);
	if (s && is_joined(e, s))
		text_printf(&t, "\t\trneagen_stage_join<%d, %d, %d>(%s_slice);\n", s->period,
			stage_pitch(slice_place_rows(s, d, 0), e->options), emit_divided_slot(s), d->arguments[0].name);
	return text_string(&t);
}

/* The rows of a vjp for q, qd and qdd, from the places of these. */
static void put_divided_out(const struct emission *e, const struct stretches *s, struct text *out)
{
	const struct argument *a = &emit_arguments(e)->arguments[s->divided];
	const struct stretch *own = s->own[s->divided];
	int slot = emit_divided_slot(s);

	if (is_joined(e, s)) {
		text_printf(out, "\t\trneagen_stage_out<%d, %d>(%s + first*%d, %s_slice, samples);\n", a->rows, a->rows, a->name, a->rows,
			emit_arguments(e)->arguments[0].name);
		return;
	}
	for (int i = 0; i < PERIODS; i++) {
		int first = i * s->period + own->first;

		if (!(s->periods >> i & 1))
			continue;
		text_printf(out, "\t\trneagen_stage_rows_out<%d, %d, %d>(%s + first*%d", own->rows,
			stage_pitch(slice_place_rows(s, emit_arguments(e), i), e->options), a->rows, a->name, a->rows);
		slice_put_shift(first, out);
		text_printf(out, ", %s_slice", emit_arguments(e)->arguments[i].name);
		slice_put_shift(slot, out);
		text_put(out, ", samples);\n");
	}
}

static void put_slice_out(const struct emission *e, const struct stretches *s, int argument, int k, struct text *out)
{
	const struct dag *d = emit_arguments(e);

	if (s && s->period && argument == s->divided) {
		put_divided_out(e, s, out);
		return;
	}
	put_function(e, s, "out", argument, k, out);
	put_array(e, s, argument, k, out);
	text_printf(out, ", %s_slice", d->arguments[slice_place(s, d, argument)].name);
	slice_put_shift(emit_slot(s, d, argument, k), out);
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
	const struct dag *d = emit_arguments(e);
	const char *name = d->arguments[argument].name, *place = d->arguments[slice_place(s, d, argument)].name;
	const char *row = row_text(e, slice_stretch(s, d, argument, k).first), *slot = row_text(e, emit_slot(s, d, argument, k));

	if (d->arguments[argument].is_output)
		text_printf(out, "\t\t\t%s[%s*count + k] = %s_slice[%s*RNEA_BLOCK];\n", name, row, place, slot);
	else
		text_printf(out, "\t\t\trneagen_stage_copy<sizeof *%s>(%s_slice + %s*RNEA_BLOCK, %s + %s*count + k);\n", name, name, slot, name,
			row);
}

/* soa: a thread fetches or writes its own sample; one loop for stretches of one length that follow each other. */
static const char *move_samples(const struct emission *e, const struct stretches *s, int out)
{
	const struct dag *d = emit_arguments(e);
	struct text t;
	int rows = 0;

	text_init(&t, e->arena);
	for (int n = 0; n < d->argument_count * STRETCHES; n++) {
		int i = n % d->argument_count, k = n / d->argument_count, own = slice_stretch(s, d, i, k).rows;

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

/* They come from rows of the vjp. */
static const char *found_moves(const struct emission *e, const struct stretches *s)
{
	const struct dag *d = emit_arguments(e);
	struct text t;

	text_init(&t, e->arena);
	for (int k = 0; k < FOUND_COUNT && slice_takes_found(s); k++) {
		int place = stretches_found_place(d, k);
		const struct argument *vjp = &d->arguments[s->divided];

		text_printf(&t, "\t\trneagen_stage_rows_in<%d, %d, %d>(%s_slice", s->found.rows,
			stage_pitch(slice_place_rows(s, d, place), e->options), vjp->rows, d->arguments[place].name);
		slice_put_shift(s->found.first + s->shift - s->place[0]->first, &t);
		text_printf(&t, ", %s + first*%d", vjp->name, vjp->rows);
		slice_put_shift(stretches_found_row(s, k) + s->found.first, &t);
		text_put(&t, ", samples);\n");
	}
	return text_string(&t);
}

const char *slice_moves_in(const struct emission *e, const struct stretches *s)
{
	if (e->options->layout != RNEAGEN_AOS)
		return move_samples(e, s, 0);
	return text_format(e->arena, "%s%s", moves_text(e, s, 0, put_slice_in), found_moves(e, s));
}

const char *slice_moves_out(const struct emission *e, const struct stretches *s)
{
	return e->options->layout == RNEAGEN_AOS ? moves_text(e, s, 1, put_slice_out) : move_samples(e, s, 1);
}
