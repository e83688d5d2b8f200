#ifndef RUNTIME_EVAL_TRACK_H
#define RUNTIME_EVAL_TRACK_H
/* A track of rnearun eval: one robot on one device, with room for a slice of the samples, which it reads, computes and
   writes. Tracks work side by side, each in a thread of its own. */

#include "eval/arrays.h"

struct eval_track {
	const struct eval_arrays *arrays;
	struct rnea_robot *robot;
	size_t slice;                               /* the most samples at a time */
	struct npy all, files[DAG_ARGUMENTS];       /* read by this track alone */
	void *data[DAG_ARGUMENTS], *gathered;       /* in the order of rnea_info(); outputs joined */
};

/* Samples of which all arrays together take about 64 MiB. */
size_t eval_track_slice(const struct eval_arrays *a);

/* Make room, and fill what does not come from files of samples. The track is zero before, and given to eval_track_close
   in any case; the robot remains the caller's. Errors: MEMORY, READ. */
enum rneagen_code eval_track_open(struct eval_track *l, const struct eval_arrays *a, size_t slice, struct rneagen_error *e);
void eval_track_close(struct eval_track *l);

/* Samples `first` to `first` + `count` - 1. Errors: READ, UNSUPPORTED (rnea_run's), WRITE. */
enum rneagen_code eval_track_do(struct eval_track *l, uint64_t first, size_t count, struct rneagen_error *e);

#endif
