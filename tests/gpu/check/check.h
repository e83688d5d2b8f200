#ifndef CHECK_H
#define CHECK_H
/* The checks on one generated text, and what they find. */

#include "core/seconds.h"
#include "data.h"
#include "gpu.h"

enum { SIZE_LIMIT = 12 };

struct settings {
	size_t counts[SIZE_LIMIT]; /* of samples, for the torques; size_count of them */
	size_t size_count;
	size_t large;              /* of samples, for the time per sample */
	size_t elements;           /* of tau, more than 32 bits count; 0: not tried */
	const char *cache;         /* an empty folder, for the time to open with a cache and without; NULL: no such time */
	int replays;               /* of a graph, for the median; 0: no times */
	unsigned block;            /* threads per block; 0: as each text has it */
	const char *latency;       /* the one text whose latencies are wanted, and no checks; NULL: all, and checks */
	const char *manifest;      /* a file of the folder of the texts */
	const char *aot;           /* a folder there, of what nvcc has built of them */
	int chain;                 /* launches in a graph for the latency, the most for the time per sample */
};

/* Seconds for one sample of a launch, and for moving its rows without computing anything; 0: not measured. */
struct rate {
	double launch, floor;
};

/* One line of the manifest. */
struct item {
	char text[256];      /* the file below the folder of the texts */
	char reference[256]; /* the folder of its reference data, likewise */
	int is_strict;       /* whether its bits are to be those of the same text on the processor */
	int aot;             /* whether there is a shared object built by nvcc beside it */
	int is_large;        /* whether it runs over settings->elements */
	int is_listed;       /* whether it is timed over more samples still, for the tables */
	int is_built;        /* whether the time to open is taken with a cache and without */
	int is_alone;        /* whether it has the main function alone, without fpass and bpass */
	/* what is found */
	struct rnea_robot *robot; /* NULL: it did not open, and `failure` says why */
	double seconds;           /* to open */
	char failure[512];        /* the first thing that is wrong, or "" */
	double max_error, rms_error;
	double limit; /* item_limit */
	double latency[2]; /* s for a launch of 1 and of 1024 samples */
	double host;          /* s of the host for a launch into a stream */
	double cold, cached;  /* s to open alone, with an empty cache and with a full one */
	double run_one[2], run_many[2]; /* s for rnea_run over 1 sample and settings->large, pageable and page-locked */
	double copies;        /* s for copying what the latter copies, one after the other */
	struct rate large, larger; /* at settings->large samples and at four times as many */
};

/* The bound on struct difference's `scaled`. */
double item_limit(const struct item *it);

/* Whether reference and text agree on the shape of the signature. */
int item_matches(struct item *it, const struct reference *r);

/* Record what is wrong, unless something was before. */
void item_fail(struct item *it, const char *fmt, ...) __attribute__((format(printf, 2, 3)));

/* The torques at every count, the passes, a replayed graph, a bad sample between good ones, what is refused. */
void verify(const struct gpu *g, const struct settings *s, struct item *it, const struct reference *r);

/* Two streams at once: of this robot over different data, and of this robot and another (partner_r NULL: none). */
void verify_streams(const struct gpu *g, struct item *it, const struct reference *r, struct item *partner,
	const struct reference *partner_r);

/* The torques of so many samples that tau has more than `elements` elements; skipped where the device is too small. */
void verify_large(const struct gpu *g, struct item *it, const struct reference *r, size_t elements);

/* rnea_run on arrays in host memory, pageable and page-locked, between guards, at every count. */
void verify_host(const struct gpu *g, const struct settings *s, struct item *it, const struct reference *r);
void cost_host(const struct gpu *g, const struct settings *s, struct item *it, const struct reference *r);

/* Of a text made with --strict, at `path`: the bits of the torques against those of the same text on the processor. */
void verify_bits(const struct gpu *g, struct item *it, const struct reference *r, const char *path);

/* NAME_rnea_launch of the shared object at `path`, built from the same text by nvcc. */
void verify_aot(const struct gpu *g, struct item *it, const struct reference *r, const char *path);

/* The kernel that does nothing but move the arrays, and one that does nothing at all; NULL module: not compiled. */
struct floor {
	CUmodule module;
	CUfunction scalar[2], vector[2]; /* f32, f64 */
	CUfunction empty;
	double empty_graph, empty_host; /* s for a launch of it, like item's latency and host */
};

void floor_open(const struct gpu *g, struct floor *f);
void floor_close(const struct gpu *g, struct floor *f);

/* The latencies. Once a context has run kernels in several streams, each launch of a graph takes longer (H100, driver 580: 0.18
   us, an empty kernel's too), and stays so: --latency has a context of its own. */
void measure_latency(const struct gpu *g, const struct settings *s, struct item *it, const struct reference *r);

/* s for a launch of an empty kernel in a graph; 0: there is none. */
double measure_empty(const struct gpu *g, const struct settings *s, const struct floor *f);
void measure(const struct gpu *g, const struct settings *s, const struct floor *f, struct item *it,
	const struct reference *r);

/* The median of an array, which is sorted by it. */
double median_of(double *times, size_t n);

/* s of the host for a launch into a stream of the item's kernel over one sample, or of `function` where it is NULL. */
double cost_launch(const struct gpu *g, const struct settings *s, CUfunction function, struct item *it,
	const struct reference *r);

/* Open the text at `path` with the empty folder `cache`, then with what it has left there. */
void cost_build(struct item *it, const char *path, const char *cache);

/* Adds a row to `path`: text, robot, precision, layout, us of an empty kernel, of 1 and of 1024 samples. Returns 1 where it
   failed. */
int report_latency(const struct floor *f, const struct item *it, const char *path);

/* A table on standard output, and the same and more at `path`. Returns the number of items that failed. */
int report(const struct gpu *g, const struct settings *s, const struct floor *f, const struct item *items, size_t count,
	const char *path);

#endif
