/* Times: of small batches by a graph of many launches, of a large one over buffers that the cache cannot hold, and of
   moving the same arrays without computing anything. */
#include "check.h"
#include "cuda/compile/jit.h"
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { SETS_LIMIT = 16, ARRAYS = 4, FLOOR_BLOCK = 256 };

#define FLOOR(name, T)                                                                                                 \
	"extern \"C\" __global__ void " name "(const " T " *__restrict__ q, const " T " *__restrict__ qd, const " T    \
	" *__restrict__ qdd, " T " *__restrict__ tau, size_t n, size_t m)\n{ move(q, qd, qdd, tau, n, m); }\n"

/* n and m count elements, or 16-byte groups of them: m of each array but q, which has n (a quaternion is one row more
   than its rates). The store that never happens keeps the load. */
static const char floor_text[] =
	"template <class T> __device__ T sum(T a, T b, T c) { return a + b + c; }\n"
	"__device__ float4 sum(float4 a, float4 b, float4 c)\n"
	"{ float4 r; r.x = a.x + b.x + c.x; r.y = a.y + b.y + c.y;\n"
	"	r.z = a.z + b.z + c.z; r.w = a.w + b.w + c.w; return r; }\n"
	"__device__ double2 sum(double2 a, double2 b, double2 c)\n"
	"{ double2 r; r.x = a.x + b.x + c.x; r.y = a.y + b.y + c.y; return r; }\n"
	"__device__ float first(float a) { return a; }\n"
	"__device__ double first(double a) { return a; }\n"
	"__device__ float first(float4 a) { return a.x; }\n"
	"__device__ double first(double2 a) { return a.x; }\n"
	"template <class T> __device__ void move(const T *__restrict__ q, const T *__restrict__ qd,\n"
	"	const T *__restrict__ qdd, T *__restrict__ tau, size_t n, size_t m)\n"
	"{\n"
	"	const size_t i = (size_t)blockIdx.x*blockDim.x + threadIdx.x;\n"
	"	if (i < m) tau[i] = sum(q[i], qd[i], qdd[i]);\n"
	"	else if (i < n && first(q[i]) == 1.25e30f) tau[0] = q[i];\n"
	"}\n" FLOOR("floor_f32", "float") FLOOR("floor_f64", "double") FLOOR("floor_f32_vector", "float4")
		FLOOR("floor_f64_vector", "double2") "extern \"C\" __global__ void floor_empty(void)\n{ }\n";

void floor_open(const struct gpu *g, struct floor *f)
{
	struct jit_request r = {.source = floor_text, .file = "floor.cu", .arch = g->arch};
	struct jit_image image;
	struct rnea_error e = {0};

	memset(f, 0, sizeof *f);
	if (jit_compile(&r, &image, &e) != RNEA_OK) {
		fprintf(stderr, "the floor does not compile: %s\n", e.message);
		return;
	}
	GPU(g, cuModuleLoadDataEx, (&f->module, image.data, 0, NULL, NULL));
	GPU(g, cuModuleGetFunction, (&f->scalar[RNEA_F32], f->module, "floor_f32"));
	GPU(g, cuModuleGetFunction, (&f->scalar[RNEA_F64], f->module, "floor_f64"));
	GPU(g, cuModuleGetFunction, (&f->vector[RNEA_F32], f->module, "floor_f32_vector"));
	GPU(g, cuModuleGetFunction, (&f->vector[RNEA_F64], f->module, "floor_f64_vector"));
	GPU(g, cuModuleGetFunction, (&f->empty, f->module, "floor_empty"));
	jit_free(&image);
}

void floor_close(const struct gpu *g, struct floor *f)
{
	if (f->module)
		GPU(g, cuModuleUnload, (f->module));
}

/* ---- sets of arrays ---- */

struct set {
	CUdeviceptr data[ARRAYS];
	void *pointers[ARRAYS];
};

struct sets {
	struct set set[SETS_LIMIT];
	size_t n, bytes[ARRAYS];
};

static void set_new(const struct gpu *g, struct sets *s)
{
	struct set *new = &s->set[s->n++];

	for (int i = 0; i < ARRAYS; i++) {
		GPU(g, cuMemAlloc, (&new->data[i], s->bytes[i]));
		new->pointers[i] = (void *)(uintptr_t)new->data[i];
		if (s->n > 1)
			GPU(g, cuMemcpyDtoD, (new->data[i], s->set[0].data[i], s->bytes[i]));
		else
			GPU(g, cuMemsetD8Async, (new->data[i], 0, s->bytes[i], g->stream));
	}
}

/* One set, or as many as fill the cache four times over and at least two; the states of the reference in each. */
static struct sets sets_new(
	const struct gpu *g, const struct rnea_info *info, const struct reference *r, size_t count, int beyond_cache)
{
	size_t size = info->precision == RNEA_F64 ? sizeof(double) : sizeof(float), total = 0, wanted = 1;
	struct sets s = {0};

	for (int i = 0; i < ARRAYS; i++)
		total += s.bytes[i] = info->arguments[i].rows * count * size;
	if (beyond_cache)
		wanted = 2 + 4 * g->l2_bytes / total;
	set_new(g, &s);
	for (int i = 0; i < ARRAYS - 1; i++) {
		void *host = malloc(s.bytes[i]);

		samples_tile(reference_find(r, info->arguments[i].name), host, count, info->precision, info->layout);
		GPU(g, cuMemcpyHtoD, (s.set[0].data[i], host, s.bytes[i]));
		free(host);
	}
	while (s.n < wanted && s.n < SETS_LIMIT)
		set_new(g, &s);
	GPU(g, cuCtxSynchronize, ());
	return s;
}

static void sets_free(const struct gpu *g, struct sets *s)
{
	for (size_t k = 0; k < s->n; k++)
		for (int i = 0; i < ARRAYS; i++)
			GPU(g, cuMemFree, (s->set[k].data[i]));
}

/* ---- graphs ---- */

static CUgraphExec capture_robot(
	const struct gpu *g, struct item *it, const struct sets *s, size_t count, size_t launches)
{
	struct rnea_error e;

	gpu_capture_begin(g);
	for (size_t i = 0; i < launches; i++)
		if (rnea_launch(it->robot, s->set[i % s->n].pointers, count, g->stream, &e) != RNEA_OK)
			item_fail(it, "while measuring: %s", e.message);
	return gpu_capture_end(g);
}

static CUgraphExec capture_floor(
	const struct gpu *g, CUfunction function, const struct sets *s, size_t group, size_t launches)
{
	size_t n = s->bytes[0] / group, m = s->bytes[3] / group, most = n > m ? n : m;

	gpu_capture_begin(g);
	for (size_t i = 0; i < launches; i++) {
		const struct set *set = &s->set[i % s->n];
		void *parameters[] = {(void *)(uintptr_t)&set->data[0], (void *)(uintptr_t)&set->data[1],
			(void *)(uintptr_t)&set->data[2], (void *)(uintptr_t)&set->data[3], &n, &m};

		GPU(g, cuLaunchKernel,
			(function, (unsigned)((most + FLOOR_BLOCK - 1) / FLOOR_BLOCK), 1, 1, FLOOR_BLOCK, 1, 1, 0,
				g->stream, parameters, NULL));
	}
	return gpu_capture_end(g);
}

/* Medians of the replays of several graphs that take turns, so that all see the same clocks. */
static void replay_in_turns(const struct gpu *g, CUgraphExec *graphs, size_t n, int replays, double *median)
{
	double *times = malloc(n * (size_t)replays * sizeof *times);

	for (int k = -(replays / 7); k < replays; k++) /* the first ones warm up */
		for (size_t i = 0; i < n; i++) {
			double seconds = gpu_replay(g, graphs[i]);

			if (k >= 0)
				times[i * (size_t)replays + (size_t)k] = seconds;
		}
	for (size_t i = 0; i < n; i++) {
		median[i] = median_of(times + i * (size_t)replays, (size_t)replays);
		GPU(g, cuGraphExecDestroy, (graphs[i]));
	}
	free(times);
}

static double latency(
	const struct gpu *g, const struct settings *s, struct item *it, const struct reference *r, size_t count)
{
	struct sets sets = sets_new(g, rnea_info(it->robot), r, count, 0);
	CUgraphExec graph = capture_robot(g, it, &sets, count, (size_t)s->chain);
	double median;

	replay_in_turns(g, &graph, 1, s->replays, &median);
	sets_free(g, &sets);
	return median / s->chain;
}

void measure_latency(const struct gpu *g, const struct settings *s, struct item *it, const struct reference *r)
{
	const struct rnea_info *info = rnea_info(it->robot);

	if (info->input_count != ARRAYS - 1 || info->output_count != 1)
		return;
	it->latency[0] = latency(g, s, it, r, 1);
	it->latency[1] = latency(g, s, it, r, 1024);
}

double measure_empty(const struct gpu *g, const struct settings *s, const struct floor *f)
{
	CUgraphExec graph;
	double median;

	if (!f->module)
		return 0;
	gpu_capture_begin(g);
	for (int i = 0; i < s->chain; i++)
		GPU(g, cuLaunchKernel, (f->empty, 1, 1, 1, 1, 1, 1, 0, g->stream, NULL, NULL));
	graph = gpu_capture_end(g);
	replay_in_turns(g, &graph, 1, s->replays, &median);
	return median / s->chain;
}

/* Launches that move some 5 GB, so that the ends of a graph do not show; every set as often as the others. */
static size_t launches_for(const struct settings *s, const struct sets *sets)
{
	size_t total = 0, rounds, limit = (size_t)s->chain / sets->n;

	for (int i = 0; i < ARRAYS; i++)
		total += sets->bytes[i];
	rounds = (size_t)5e9 / (total * sets->n) + 1;
	if (rounds > limit)
		rounds = limit ? limit : 1;
	return rounds * sets->n;
}

static struct rate throughput(const struct gpu *g, const struct settings *s, const struct floor *f, struct item *it,
	const struct reference *r, size_t count)
{
	const struct rnea_info *info = rnea_info(it->robot);
	struct sets sets = sets_new(g, info, r, count, 1);
	size_t scalar = info->precision == RNEA_F64 ? sizeof(double) : sizeof(float), n = 1;
	size_t launches = launches_for(s, &sets);
	CUgraphExec graphs[3] = {capture_robot(g, it, &sets, count, launches)};
	double median[3];
	struct rate rate = {0};

	if (f->module) {
		graphs[n++] = capture_floor(g, f->scalar[info->precision], &sets, scalar, launches);
		graphs[n++] = capture_floor(g, f->vector[info->precision], &sets, 16, launches);
	}
	replay_in_turns(g, graphs, n, s->replays, median);
	rate.launch = median[0] / (double)(launches * count);
	if (f->module)
		rate.floor = fmin(median[1], median[2]) / (double)(launches * count);
	sets_free(g, &sets);
	return rate;
}

void measure(const struct gpu *g, const struct settings *s, const struct floor *f, struct item *it,
	const struct reference *r)
{
	const struct rnea_info *info = rnea_info(it->robot);

	if (info->input_count != ARRAYS - 1 || info->output_count != 1)
		return;
	it->host = cost_launch(g, s, NULL, it, r);
	it->large = throughput(g, s, f, it, r, s->large);
	if (it->is_listed)
		it->larger = throughput(g, s, f, it, r, 4 * s->large);
}
