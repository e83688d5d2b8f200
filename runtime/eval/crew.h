#ifndef RUNTIME_EVAL_CREW_H
#define RUNTIME_EVAL_CREW_H
/* The tracks of all ranks over the samples, in slices (slices.h). Each rank has a thread for each of its tracks, and its
   own thread, which asks several times a second how far the others are. */

#include "eval/track.h"

struct eval_crew {
	struct eval_arrays *arrays;
	struct ranks *ranks;
	struct rnea_robot *robot;   /* of this rank's first track */
	const char *text;           /* those of the others are opened from, each on a device of its own */
	struct rnea_options open;
	const int *devices;         /* `count` of them, the first one's included */
	size_t count;
	uint64_t first, samples;    /* what is to be done: from here to the end */
	size_t slice;               /* 0: as many samples as tracks have room for */
	/* In the first rank: `done` samples are, of those that were to be. */
	void (*show)(void *own, uint64_t done);
	/* There, if it is not NULL: all samples before `whole` are written, and on the disk. */
	void (*record)(void *own, uint64_t whole);
	void *own;
};

/* All ranks end together: when all is done, or some time after a track has failed. *e tells of a failure in this rank
   alone. Returns whether all is done. Errors: MEMORY, those of eval_track_open, eval_track_do and rnea_open. */
int eval_crew_run(struct eval_crew *c, struct rneagen_error *e);

#endif
