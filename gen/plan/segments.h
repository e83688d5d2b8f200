#ifndef RNEAGEN_SEGMENTS_H
#define RNEAGEN_SEGMENTS_H
/* A plan in segments: each runs for several samples before the next one does, so that a processor holds its code, and a
   compiler its loop. What one makes and a later one reads crosses the cut between them in a slot of memory; inputs are read
   again. */

#include "plan/plan.h"
#include "request/request.h"
#include "rneagen.h"

struct segment_limits {
	unsigned operations; /* of a segment */
	unsigned overhead;   /* of one more segment, in values fetched or kept */
	unsigned across;     /* values alive at a cut */
};

/* Cut where the fewest values are fetched and kept, within the limits as far as one line allows. Values of the plan's
   two types of numbers have slots of their own. Returns 0 when memory runs out. */
int segments_make(struct segments *s, const struct plan *p, const struct segment_limits *limits, struct arena *a);

/* What a function is to become; AGAIN: what stands beside loops, or is in lanes, however short. */
enum segment_use { SEGMENT_NONE, SEGMENT_LOOPS, SEGMENT_AGAIN, SEGMENT_KERNEL };

/* Make p->segments as the options ask for, or where that pays (segment_limits.c). Without loops or a kernel of its own a function
   stays whole; AGAIN has one segment at least. Returns 0 when memory runs out. */
int segments_choose(struct function *p, enum segment_use use, const struct request *k, const struct rneagen_options *o,
	struct arena *a);

/* Make p->single, with derivatives of qdd by loops over columns, or gradients by loops over coordinates, for a function in
   segments that serve batches: where one sample gains by it, and nothing promises its bits, which are not those of a batch.
   Returns 0 when memory runs out. */
int segments_single(struct function *p, const struct request *k, const struct rneagen_options *o, struct arena *a);

/* Make p->many, with derivatives of qdd by loops over columns in place, or gradients by loops over coordinates, for a function
   that has p->single: where its own lines take a compiler long. Returns 0 when memory runs out. */
int segments_many(struct function *p, const struct request *k, const struct rneagen_options *o, struct arena *a);

/* May a call of one sample run another text than a batch does: does nothing promise its bits, or ask for these segments? */
int segments_may_differ(const struct rneagen_options *o);

/* The function once more, for one sample or for batches: of a DAG that `build` makes, under a name of its own, and in segments.
   *made is NULL where `build` returns 0, or makes other sines, for the table of sines is the whole's. Returns 0 when memory
   runs out. */
typedef int segments_build(struct dag *d, const struct function *p, const struct request *k);
int segments_once_more(struct function **made, const struct function *p, segments_build *build, const char *name,
	const struct request *k, const struct rneagen_options *o, struct arena *a);

/* The line, from this one on, at which a loop over columns begins, or the number of lines; all lines behind the first are
   in loops. */
uint32_t segments_next_loop(const struct plan *p, uint32_t line);

/* Does a segment read an input other than a loop's column? */
int segments_reads_input(const struct plan *segment);

/* Bytes that a sample keeps across cuts, at least those of a number; `is_wide`: some numbers have more bits. */
int segments_bytes(const struct segments *s, const struct rneagen_options *o, int is_wide);

/* A line for each segment of the function, or for the whole where there are none. */
void segments_dump(const struct function *p, struct text *out);

#endif
