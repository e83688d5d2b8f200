/* Slices of the batch in shared memory: where those of the arrays stand, and what the body is called with.
   A part that shares nothing with others has stretches of rows alone. */
#include "base/template.h"
#include "emit/emit.h"
#include "emit/kernels/slices/emit_slices.h"
#include "emit/kernels/slices/slice_rows.h"
#include "plan/stage.h"
#include <stdlib.h>

struct stretch slice_stretch(const struct stretches *s, const struct dag *d, int argument, int k)
{
	return s ? s->own[argument][k] : (struct stretch){0, k ? 0 : d->arguments[argument].rows};
}

int slice_place(const struct stretches *s, const struct dag *d, int argument)
{
	return s ? s->place_of[argument] : stage_place(d, argument);
}

int slice_place_rows(const struct stretches *s, const struct dag *d, int argument)
{
	int place = slice_place(s, d, argument);

	return s ? stretches_rows(s, place) : d->arguments[place].rows;
}

/* How much further on a row stands there. */
static int shift_of(const struct stretches *s, int argument)
{
	return s && s->period && argument == s->divided ? s->shift : 0;
}

static int place_first(const struct stretches *s, const struct dag *d, int argument)
{
	return s ? s->place[slice_place(s, d, argument)][0].first : 0;
}

int emit_slot(const struct stretches *s, const struct dag *d, int argument, int k)
{
	return slice_stretch(s, d, argument, k).first - place_first(s, d, argument) - (k ? s->gap : 0);
}

void slice_put_shift(int by, struct text *out)
{
	if (by)
		text_printf(out, " %c %d", by < 0 ? '-' : '+', abs(by));
}

int slice_takes_found(const struct stretches *s)
{
	return s && s->takes_found;
}

/* `*const q_slice = slices, *const qd_slice = q_slice + RNEA_BLOCK*7, ...`: where the slices of the arrays begin; in soa
   where this thread's rows do. */
static const char *slices_text(const struct emission *e, const struct stretches *s, const char *block)
{
	const struct dag *d = emit_arguments(e);
	struct text t;
	int last = -1;

	text_init(&t, e->arena);
	for (int i = 0; i < d->argument_count; i++) {
		if (d->arguments[i].per_batch || slice_place(s, d, i) != i || !slice_place_rows(s, d, i))
			continue;
		text_printf(&t, "%s*const %s_slice = ", last >= 0 ? ", " : "", d->arguments[i].name);
		if (last >= 0)
			text_printf(&t, "%s_slice + %s*%d", d->arguments[last].name, block, stage_pitch(slice_place_rows(s, d, last), e->options));
		else
			text_put(&t, e->options->layout == RNEAGEN_AOS ? "slices" : "slices + threadIdx.x");
		last = i;
	}
	return text_string(&t);
}

/* What the body is called with: q_here, qd_here, ..., and as it is what all samples share. */
static const char *here_text(const struct emission *e)
{
	const struct dag *d = emit_arguments(e);
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
	const struct dag *d = emit_arguments(e);
	struct text t;

	text_init(&t, e->arena);
	for (int i = 0; i < d->argument_count; i++) {
		const struct argument *a = &d->arguments[i];
		int before = shift_of(s, i) - place_first(s, d, i);

		if (a->per_batch)
			continue;
		if (!slice_place_rows(s, d, i)) { /* it is in no slice */
			text_printf(&t, "\t%s%s *const %s_here = %s + k;\n", a->is_output ? "" : "const ", e->memory->type, a->name, a->name);
			continue;
		}
		text_printf(&t, "%s%s%s *const %s_here = staged ? %s_slice", e->options->layout == RNEAGEN_AOS ? "\t\t" : "\t",
			a->is_output ? "" : "const ", e->memory->type, a->name, d->arguments[slice_place(s, d, i)].name);
		if (e->options->layout == RNEAGEN_AOS)
			text_printf(&t, " + %s*%d", emit_each_block(e) ? "sample" : "threadIdx.x", stage_pitch(slice_place_rows(s, d, i), e->options));
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

/* The same for qdd and mu, which stand in the places of the weights and of the third period. */
static const char *found_text(const struct emission *e, const struct stretches *s)
{
	const struct dag *d = emit_arguments(e);
	struct text t;

	text_init(&t, e->arena);
	for (int k = 0; k < FOUND_COUNT && slice_takes_found(s); k++) {
		int place = stretches_found_place(d, k);

		text_printf(&t, "\t\tconst %s *const %s_here = staged ? %s_slice + threadIdx.x*%d", e->memory->type,
			k == FOUND_MU ? "mu" : "found", d->arguments[place].name, stage_pitch(slice_place_rows(s, d, place), e->options));
		slice_put_shift(s->shift - s->place[0]->first, &t);
		text_printf(&t, " : %s + k*%d", d->arguments[s->divided].name, d->arguments[s->divided].rows);
		slice_put_shift(stretches_found_row(s, k), &t);
		text_put(&t, ";\n");
	}
	return text_string(&t);
}

struct slices emit_slices(const struct emission *e, const struct stretches *s, const char *block)
{
	return (struct slices){slices_text(e, s, block), here_text(e),
		text_format(e->arena, "%s%s", pointers_text(e, s, block), found_text(e, s)), slice_moves_in(e, s), slice_moves_out(e, s),
		e->options->layout == RNEAGEN_AOS ? slice_join(e, s) : ""};
}

const char *emit_slices_declaration(const struct emission *e, int words)
{
	const struct slot slots[] = {{"T", e->memory->type}, {"WORDS", emit_int(e, words)}};

	return template_text(e->arena, e->target->kernel->slices, slots, sizeof slots / sizeof *slots);
}
