#ifndef CHECK_H
#define CHECK_H
/* The checks on one generated text, and what they find. */

#include "data.h"
#include "gpu.h"

enum { SIZE_COUNT = 3 };

struct settings {
	size_t counts[SIZE_COUNT]; /* of samples, for the torques */
	size_t large;              /* of samples, for the time per sample */
	int replays;               /* of a graph, for the median; 0: no times */
	unsigned block;            /* threads per block; 0: as each text has it */
	int chain;                 /* launches in a graph for the latency, the most for the time per sample */
};

/* One line of the manifest. */
struct item {
	char text[256];      /* the file below the folder of the texts */
	char reference[256]; /* the folder of its reference data, likewise */
	int aot;             /* whether there is a shared object built by nvcc beside it */
	/* what is found */
	struct rnea_robot *robot; /* NULL: it did not open, and `failure` says why */
	double seconds;           /* to open */
	char failure[512];        /* the first thing that is wrong, or "" */
	double max_error, rms_error;
	double limit; /* on struct difference's `scaled` */
	double latency[2]; /* s for a launch of 1 and of 1024 samples */
	double launch, floor; /* s for a launch of settings->large samples, and what moving the same arrays takes */
};

/* Record what is wrong, unless something was before. */
void item_fail(struct item *it, const char *fmt, ...) __attribute__((format(printf, 2, 3)));

/* The torques at every count, the passes, a replayed graph, a bad sample between good ones, what is refused. */
void verify(const struct gpu *g, const struct settings *s, struct item *it, const struct reference *r);

/* NAME_rnea_launch of the shared object at `path`, built from the same text by nvcc. */
void verify_aot(const struct gpu *g, struct item *it, const struct reference *r, const char *path);

/* The kernel that does nothing but move the arrays; NULL module: not compiled. */
struct floor {
	CUmodule module;
	CUfunction scalar[2], vector[2]; /* f32, f64 */
};

void floor_open(const struct gpu *g, struct floor *f);
void floor_close(const struct gpu *g, struct floor *f);

void measure(const struct gpu *g, const struct settings *s, const struct floor *f, struct item *it,
	const struct reference *r);

/* A table on standard output, and the same and more at `path`. Returns the number of items that failed. */
int report(const struct gpu *g, const struct settings *s, const struct item *items, size_t count, const char *path);

#endif
