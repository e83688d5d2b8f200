/* Texts of forward dynamics, run by librnea on drawn states, against the evaluated DAG. */
#ifndef FORWARD_RUN_H
#define FORWARD_RUN_H

#include "rnea.h"
#include "support/scene_model.h"
#include "target/target.h"
#include <stdint.h>

/* Fails where a number of the text is further from the DAG's than twice the evaluator's own bound (64 times in pairs of floats,
   16 times with fast sines). Angles are up to 1 rad, of one state `largest_angle`: beyond what small angles are, kernels take
   their tables of sines. */
void forward_run(const struct scene_model *m, const struct rneagen_options *o, const struct target *t, enum rnea_backend backend,
	double largest_angle, uint64_t seed);

/* The same, opened as `how` says. */
void forward_run_as(const struct scene_model *m, const struct rneagen_options *o, const struct target *t, struct rnea_options how,
	double largest_angle, uint64_t seed);

#endif
