#ifndef TESTS_LAUNCHED_H
#define TESTS_LAUNCHED_H
/* A text opened by the runtime and launched on batches that the seed draws. */

#include "urdf.h"
#include "target/target.h"

/* From now on the runtime's GPU is the pretended one, without a cache, and what a test prints is seen as it is printed. */
void launched_pretend(void);

/* The text of tests/robots/NAME.urdf with this scene and base, "": none, and else these options. */
void launched_generate(struct target *t, const char *name, const char *scene, int floating,
	const struct rneagen_options *options);

/* The test fails with a message where it cannot be opened. block: 0, the text's. */
struct rnea_robot *launched_open(const struct target *t, enum rnea_backend backend, unsigned block);

/* A batch of arrays: inputs by the seed, with a quaternion of norm one if there is a base, and an angle of each
   eighth sample large, one after the other, where the text takes any; outputs NaN. Launched, and freed with the robot. */
struct launch {
	struct rnea_robot *robot;
	const struct rnea_info *info;
	size_t count;
	void **arrays;
};
struct launch launched_run(struct rnea_robot *robot, size_t count, unsigned seed, int floating);
void launched_free(struct launch *x);

/* A row of an argument, of one sample. */
double launched_get(const struct launch *x, size_t argument, size_t row, size_t sample);
void launched_set(const struct launch *x, size_t argument, size_t row, size_t sample, double value);

/* Its arrays alone: the robot runs again. */
void launched_drop(struct launch *x);

/* The largest difference of an output between two launches, by its largest element of the same sample; what nobody
   wrote fails. */
double launched_distance(const struct launch *x, const struct launch *y, const char *what);

#endif
