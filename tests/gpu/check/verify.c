#include "arrays.h"
#include <dlfcn.h>
#include <math.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

void item_fail(struct item *it, const char *fmt, ...)
{
	va_list ap;

	if (*it->failure)
		return;
	va_start(ap, fmt);
	vsnprintf(it->failure, sizeof it->failure, fmt, ap);
	va_end(ap);
}

int item_matches(struct item *it, const struct reference *r)
{
	const struct rnea_info *info = rnea_info(it->robot);

	for (size_t i = 0; i < info->input_count + info->output_count; i++) {
		const struct rnea_argument *a = &info->arguments[i];
		const struct samples *s = reference_find(r, a->name);

		if (s && s->rows == a->rows && !a->per_batch)
			continue;
		item_fail(it, "array \"%s\" has %zu rows, in the reference %zu", a->name, a->rows, s ? s->rows : 0);
		return 0;
	}
	return 1;
}

static int launched(const struct gpu *g, struct item *it, const char *function, void *const *pointers, size_t count)
{
	struct rnea_error e;

	if (rnea_launch_kernel(it->robot, function, pointers, count, g->stream, &e) != RNEA_OK) {
		item_fail(it, "%s", e.message);
		return 0;
	}
	GPU(g, cuStreamSynchronize, (g->stream));
	return 1;
}

/* What the inputs were, bit by bit: they are the caller's. */
static void check_inputs(const struct gpu *g, struct item *it, const struct arrays *a, const struct reference *r)
{
	const struct rnea_info *info = rnea_info(it->robot);

	for (size_t i = 0; i < info->input_count; i++) {
		const struct rnea_argument *input = &info->arguments[i];
		char *again = malloc(a->array[i].bytes);

		samples_tile(reference_find(r, input->name), again, a->count, input->scalar, info->layout);
		if (!gpu_array_read(g, &a->array[i], a->host) || memcmp(again, a->host, a->array[i].bytes) != 0)
			item_fail(it, "the launch wrote to %s", input->name);
		free(again);
	}
}

static void verify_count(const struct gpu *g, struct item *it, const struct reference *r, size_t count)
{
	struct arrays a = arrays_new(g, rnea_info(it->robot), r, count);

	if (launched(g, it, "rnea", a.pointers, count)) {
		check_torque(g, it, &a, a.n - 1, r, "rnea");
		check_inputs(g, it, &a, r);
	}
	arrays_free(g, &a);
}

/* It would catch slices that move 16 bytes at a time where their arrays do not begin at such. */
static void verify_shifted(const struct gpu *g, struct item *it, const struct reference *r)
{
	struct arrays a = arrays_new_shifted(g, rnea_info(it->robot), r, r->q.count);

	if (launched(g, it, "rnea", a.pointers, a.count))
		check_torque(g, it, &a, a.n - 1, r, "arrays that begin anywhere");
	arrays_free(g, &a);
}

/* Every element of v, a and f was written, and nothing around them. */
static void check_written(const struct gpu *g, struct item *it, const struct gpu_array *array, const char *name)
{
	int wide = rnea_info(it->robot)->precision == RNEA_F64, good;
	size_t n = array->bytes / (wide ? sizeof(double) : sizeof(float));
	void *host = malloc(array->bytes);

	good = gpu_array_read(g, array, host);
	for (size_t i = 0; i < n && good; i++)
		good = isfinite(wide ? ((double *)host)[i] : (double)((float *)host)[i]);
	if (!good)
		item_fail(it, "fpass: %s is not written, or is written outside of", name);
	free(host);
}

/* fpass, then bpass: the same torques. */
static void verify_passes(const struct gpu *g, struct item *it, const struct reference *r)
{
	const struct rnea_info *info = rnea_info(it->robot);
	struct arrays a = arrays_new(g, info, r, r->q.count);
	size_t in = info->input_count,
	       bytes = arrays_bytes(&(struct rnea_argument){.rows = 6 * info->nb, .scalar = info->precision}, a.count);
	struct gpu_array pass[3] = {gpu_array_new(g, bytes), gpu_array_new(g, bytes), gpu_array_new(g, bytes)};
	static const char *const names[] = {"v", "a", "f"};
	void *forward[ARRAYS_LIMIT + 3], *backward[3] = {a.pointers[0], (void *)(uintptr_t)pass[2].data, a.pointers[a.n - 1]};

	memcpy(forward, a.pointers, in * sizeof *forward);
	for (int i = 0; i < 3; i++)
		forward[in + (size_t)i] = (void *)(uintptr_t)pass[i].data;
	if (!rnea_argument_count(it->robot, "fpass"))
		item_fail(it, "the text has no fpass kernel");
	else if (launched(g, it, "fpass", forward, a.count) &&
		 launched(g, it, "bpass", backward, a.count)) {
		for (int i = 0; i < 3; i++)
			check_written(g, it, &pass[i], names[i]);
		check_torque(g, it, &a, a.n - 1, r, "fpass and bpass");
	}
	for (int i = 0; i < 3; i++)
		gpu_array_free(g, &pass[i]);
	arrays_free(g, &a);
}

/* A launch that is captured runs when the graph is replayed, and again when it is replayed again. */
static void verify_capture(const struct gpu *g, struct item *it, const struct reference *r)
{
	struct arrays a = arrays_new(g, rnea_info(it->robot), r, r->q.count);
	struct rnea_error e;
	CUgraphExec graph;

	gpu_capture_begin(g);
	if (rnea_launch(it->robot, a.pointers, a.count, g->stream, &e) != RNEA_OK)
		item_fail(it, "in a capture: %s", e.message);
	graph = gpu_capture_end(g);
	for (int i = 0; i < 2 && !*it->failure; i++) {
		gpu_array_poison(g, &a.array[a.n - 1]);
		gpu_replay(g, graph);
		check_torque(g, it, &a, a.n - 1, r, "replayed graph");
	}
	GPU(g, cuGraphExecDestroy, (graph));
	arrays_free(g, &a);
}

/* Bytes that are not equal, other than sample `bad`'s. */
static size_t changed(const struct rnea_info *info, const char *x, const char *y, size_t rows, size_t count, size_t bad)
{
	size_t size = info->precision == RNEA_F64 ? sizeof(double) : sizeof(float), n = 0;

	for (size_t i = 0; i < rows * count; i++)
		if ((info->layout == RNEA_AOS ? i / rows : i % count) != bad)
			n += memcmp(x + i * size, y + i * size, size) != 0;
	return n;
}

/* A sample that is not finite leaves the bits of all others alone. */
static void verify_bad_sample(const struct gpu *g, struct item *it, const struct reference *r)
{
	const struct rnea_info *info = rnea_info(it->robot);
	struct arrays a = arrays_new(g, info, r, r->q.count);
	const struct gpu_array *tau = &a.array[a.n - 1];
	size_t bad = a.count / 2, size = info->precision == RNEA_F64 ? sizeof(double) : sizeof(float);
	char *before = malloc(tau->bytes), *after = malloc(tau->bytes);

	if (launched(g, it, "rnea", a.pointers, a.count)) {
		gpu_array_read(g, tau, before);
		for (size_t row = 0; row < info->nq; row++)
			GPU(g, cuMemsetD8,
				(a.array[0].data + size * (info->layout == RNEA_AOS ? bad * info->nq + row
										    : row * a.count + bad),
					0xff, size));
		gpu_array_poison(g, tau);
		launched(g, it, "rnea", a.pointers, a.count);
		gpu_array_read(g, tau, after);
		if (changed(info, before, after, info->nv, a.count, bad))
			item_fail(it, "a sample that is not finite changes others");
	}
	free(before);
	free(after);
	arrays_free(g, &a);
}

/* What needs no samples. */
static void verify_refusals(const struct gpu *g, struct item *it)
{
	void *null[ARRAYS_LIMIT] = {NULL};
	struct rnea_error e;

	if (rnea_launch(it->robot, null, 0, g->stream, &e) != RNEA_OK)
		item_fail(it, "no samples: %s", e.message);
	if (rnea_launch(it->robot, null, 1, g->stream, &e) != RNEA_POINTER)
		item_fail(it, "a null array is not refused");
	if (rnea_launch(it->robot, NULL, 1, g->stream, &e) != RNEA_ARGUMENT)
		item_fail(it, "no arrays are not refused");
}

double item_limit(const struct item *it)
{
	const struct rnea_info *info = rnea_info(it->robot);

	if (strcmp(info->trig, "fast") == 0)
		return 1e-3; /* the hardware's sine has an absolute error */
	if (info->precision == RNEA_F32 && strcmp(info->arithmetic, "f64") == 0)
		return 1.2e-7; /* the torque's own rounding */
	if (strcmp(info->arithmetic, "f32x2") == 0)
		return 1e-12;
	return info->precision == RNEA_F64 ? 5e-14 : 3e-6;
}

void verify(const struct gpu *g, const struct settings *s, struct item *it, const struct reference *r)
{
	for (size_t i = 0; i < s->size_count; i++)
		verify_count(g, it, r, s->counts[i]);
	if (!it->is_alone)
		verify_passes(g, it, r);
	verify_shifted(g, it, r);
	verify_capture(g, it, r);
	verify_bad_sample(g, it, r);
	verify_refusals(g, it);
}

void verify_aot(const struct gpu *g, struct item *it, const struct reference *r, const char *path)
{
	int (*launch)(void *q, void *qd, void *qdd, void *tau, size_t count, void *stream);
	const struct rnea_info *info = rnea_info(it->robot);
	struct arrays a = arrays_new(g, info, r, r->q.count);
	void *library = dlopen(path, RTLD_NOW), *address;
	char symbol[300];
	int status;

	snprintf(symbol, sizeof symbol, "%s_rnea_launch", info->name);
	address = library ? dlsym(library, symbol) : NULL;
	memcpy(&launch, &address, sizeof launch);
	if (!address) {
		item_fail(it, "built by nvcc: %s", dlerror());
	} else if (a.n == 4) {
		status = launch(a.pointers[0], a.pointers[1], a.pointers[2], a.pointers[3], a.count, g->stream);
		if (status)
			item_fail(it, "built by nvcc: %s returned %d", symbol, status);
		GPU(g, cuStreamSynchronize, (g->stream));
		check_torque(g, it, &a, a.n - 1, r, "built by nvcc");
	}
	arrays_free(g, &a);
}
