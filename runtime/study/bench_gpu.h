#ifndef RUNTIME_BENCH_GPU_H
#define RUNTIME_BENCH_GPU_H
/* The GPU's side of bench.h: device arrays, and graphs of launches between two events. */

#include "rnea.h"

struct bench_gpu;

enum rnea_code bench_gpu_open(struct bench_gpu **g, int device, struct rnea_error *e);
void bench_gpu_close(struct bench_gpu *g);
int bench_gpu_driver(const struct bench_gpu *g);

/* An array on the device, a copy where `from` is not NULL; NULL on failure. bench_gpu_free may be given NULL. */
void *bench_gpu_array(struct bench_gpu *g, const void *from, size_t size, struct rnea_error *e);
void bench_gpu_free(struct bench_gpu *g, void *array);

/* Copy one back. Errors: DRIVER. */
enum rnea_code bench_gpu_back(struct bench_gpu *g, void *to, const void *array, size_t size, struct rnea_error *e);

/* A graph of `launches` launches over the sets in turn; `sets` has `set_count` arrays of pointers. NULL on failure. */
void *bench_gpu_graph(struct bench_gpu *g, const struct rnea_robot *robot, void *const *const *sets, size_t set_count,
	size_t count, size_t launches, struct rnea_error *e);
void bench_gpu_drop(struct bench_gpu *g, void *graph);

/* Seconds of one replay, right behind another. */
enum rnea_code bench_gpu_replay(struct bench_gpu *g, void *graph, double *seconds, struct rnea_error *e);

#endif
