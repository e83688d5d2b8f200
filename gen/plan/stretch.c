#include "plan/stretch.h"
#include "plan/stage.h"

void stretch_widen(struct stretch *s, int row)
{
	int end = s->first + s->rows;

	if (!s->rows)
		*s = (struct stretch){row, 1};
	else if (row < s->first)
		*s = (struct stretch){row, end - row};
	else if (row >= end)
		s->rows = row + 1 - s->first;
}

void stretches_make(struct stretches *s, const struct dag *d)
{
	*s = (struct stretches){0};
	for (size_t i = 0; i < d->count; i++)
		if (d->nodes[i].op == OP_INPUT)
			stretch_widen(&s->own[d->nodes[i].arg[0].i], (int)d->nodes[i].arg[1].i);
	for (size_t i = 0; i < d->output_count; i++)
		stretch_widen(&s->own[d->outputs[i].argument], d->outputs[i].row);
	for (int i = 0; i < d->argument_count; i++)
		if (!s->own[i].rows)
			s->own[i].rows = 1;
	for (int i = 0; i < d->argument_count; i++) {
		struct stretch *place = &s->place[stage_place(d, i)];

		stretch_widen(place, s->own[i].first);
		stretch_widen(place, s->own[i].first + s->own[i].rows - 1);
	}
}

int stretches_words(const struct stretches *s, const struct dag *d, const struct rneagen_options *o)
{
	int words = 0;

	for (int i = 0; i < d->argument_count; i++)
		if (stage_has_place(d, i))
			words += stage_pitch(s->place[i].rows, o);
	return words;
}
