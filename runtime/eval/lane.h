#ifndef RUNTIME_EVAL_LANE_H
#define RUNTIME_EVAL_LANE_H
/* A lane of rnearun eval: one robot on one device, with room for a slice of the samples, which it reads, computes and
   writes. Lanes work side by side, each in a thread of its own. */

#include "eval/arrays.h"

struct eval_lane {
	const struct eval_arrays *arrays;
	struct rnea_robot *robot;
	size_t slice;                               /* the most samples at a time */
	struct npy all, files[DAG_ARGUMENTS];       /* read by this lane alone */
	void *data[DAG_ARGUMENTS], *gathered;       /* in the order of rnea_info(); outputs joined */
};

/* Samples of which all arrays together take about 64 MiB. */
size_t eval_lane_slice(const struct eval_arrays *a);

/* Make room, and fill what does not come from files of samples. The lane is zero before, and given to eval_lane_close
   in any case; the robot remains the caller's. Errors: MEMORY, READ. */
enum rneagen_code eval_lane_open(struct eval_lane *l, const struct eval_arrays *a, size_t slice, struct rneagen_error *e);
void eval_lane_close(struct eval_lane *l);

/* Samples `first` to `first` + `count` - 1. Errors: READ, UNSUPPORTED (rnea_run's), WRITE. */
enum rneagen_code eval_lane_do(struct eval_lane *l, uint64_t first, size_t count, struct rneagen_error *e);

#endif
