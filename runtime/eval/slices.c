#include "eval/slices.h"

/* As many rounds as `most` asks for; each track the same share of a round, rounded up. */
static size_t share(uint64_t samples, uint64_t tracks, size_t most)
{
	uint64_t rounds = samples / tracks / most + 1, parts;

	if (rounds > 1 && samples == tracks * most * (rounds - 1))
		rounds--;
	parts = rounds * tracks;
	return (size_t)(samples / parts + (samples % parts != 0));
}

struct slices slices_plan(uint64_t first, uint64_t end, uint64_t tracks, size_t size, size_t most)
{
	struct slices s = {first, end, tracks, size ? size : share(end - first, tracks, most)};

	if (s.size > end - first)
		s.size = (size_t)(end - first);
	if (!s.size)
		s.size = 1;
	return s;
}

uint64_t slices_begin(const struct slices *s, uint64_t track)
{
	return track < (s->end - s->first) / s->size + ((s->end - s->first) % s->size != 0) ? s->first + track * s->size : s->end;
}

uint64_t slices_next(const struct slices *s, uint64_t at)
{
	uint64_t stride = s->tracks * s->size;

	return s->end - at > stride ? at + stride : s->end;
}

size_t slices_count(const struct slices *s, uint64_t at)
{
	return s->end - at < s->size ? (size_t)(s->end - at) : s->size;
}
