#include "eval/slices.h"

/* As many rounds as `most` asks for; each lane the same share of a round, rounded up. */
static size_t share(uint64_t samples, uint64_t lanes, size_t most)
{
	uint64_t rounds = samples / lanes / most + 1, parts;

	if (rounds > 1 && samples == lanes * most * (rounds - 1))
		rounds--;
	parts = rounds * lanes;
	return (size_t)(samples / parts + (samples % parts != 0));
}

struct slices slices_plan(uint64_t first, uint64_t end, uint64_t lanes, size_t size, size_t most)
{
	struct slices s = {first, end, lanes, size ? size : share(end - first, lanes, most)};

	if (s.size > end - first)
		s.size = (size_t)(end - first);
	if (!s.size)
		s.size = 1;
	return s;
}

uint64_t slices_begin(const struct slices *s, uint64_t lane)
{
	return lane < (s->end - s->first) / s->size + ((s->end - s->first) % s->size != 0) ? s->first + lane * s->size : s->end;
}

uint64_t slices_next(const struct slices *s, uint64_t at)
{
	uint64_t stride = s->lanes * s->size;

	return s->end - at > stride ? at + stride : s->end;
}

size_t slices_count(const struct slices *s, uint64_t at)
{
	return s->end - at < s->size ? (size_t)(s->end - at) : s->size;
}
