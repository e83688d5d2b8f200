#ifndef RUNTIME_BENCH_H
#define RUNTIME_BENCH_H
/* How long launches take, on either backend. */

#include "rnea.h"

/* Time is taken of at least BENCH_REPLAYS runs of as many launches as last BENCH_RUN seconds, until BENCH_TOTAL seconds
   are full; on a busy machine until BENCH_ALIKE runs are within a tenth of the least, or BENCH_LIMIT seconds are full.
   Arrays of a large batch, BENCH_LARGE numbers or more whatever their type, take turns with others until they fill
   BENCH_ARRAYS bytes, so that no cache holds them. */
enum { BENCH_REPLAYS = 7, BENCH_REPLAYS_LIMIT = 199, BENCH_ALIKE = 4 };
enum { BENCH_LARGE = 1 << 20, BENCH_ARRAYS = 256 << 20 };
#define BENCH_RUN 1e-3
#define BENCH_TOTAL 0.15
#define BENCH_LIMIT 1.0

struct bench_time {
	double ns;     /* of one sample: the median of the runs */
	double least;  /* the least of them: what else the machine does only adds */
	double spread; /* distance of the quartiles, over the median */
	double floor;  /* the same for the floor: ns of one sample */
};

struct bench; /* one backend, where the arrays are */

/* Errors: as rnea_open. The caller gives *b to bench_close. */
enum rnea_code bench_open(struct bench **b, enum rnea_backend backend, int device, struct rnea_error *e);
void bench_close(struct bench *b);

/* The driver's version, 1000 major + 10 minor: 13000 is CUDA 13.0; 0 on the host. */
int bench_driver(const struct bench *b);

/* Launches of `robot` and of `floor`, which takes the same arrays, in turns. `arrays` are `count` samples in the program's
   memory, in the order of rnea_info(); on a GPU copies of them are used. The outputs of the first `back` samples, at most
   `count`, are the robot's then. Errors: as rnea_launch, DEVICE_MEMORY, MEMORY. */
enum rnea_code bench_measure(struct bench *b, const struct rnea_robot *robot, const struct rnea_robot *floor,
	void *const *arrays, size_t count, size_t back, struct bench_time *time, struct rnea_error *e);

#endif
