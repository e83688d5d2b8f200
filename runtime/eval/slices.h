#ifndef RUNTIME_EVAL_SLICES_H
#define RUNTIME_EVAL_SLICES_H
/* Which samples each track takes: slices of one size from the first sample to the end, slice i that of track i modulo the
   number of tracks. So what a slice has depends on no clock. */

#include <stddef.h>
#include <stdint.h>

struct slices {
	uint64_t first, end; /* samples first to end - 1 */
	uint64_t tracks;      /* at least 1 */
	size_t size;         /* samples of a slice, at least 1; the last one may have fewer */
};

/* Slices of `size` samples; 0: of at most `most`, and of so few that all tracks have about as many. */
struct slices slices_plan(uint64_t first, uint64_t end, uint64_t tracks, size_t size, size_t most);

/* The sample that a track's first slice begins with; the one that its next slice begins with, after the slice that
   begins with `at`. s->end: there is none. */
uint64_t slices_begin(const struct slices *s, uint64_t track);
uint64_t slices_next(const struct slices *s, uint64_t at);

/* How many samples the slice has that begins with `at`. */
size_t slices_count(const struct slices *s, uint64_t at);

#endif
