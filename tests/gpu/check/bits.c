/* Texts made with --strict: the torques of the GPU have the bits of those of the processor. */
#include "arrays.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* The reference's states with all of q multiplied: angles far outside of what sine and cosine take without a branch. */
static struct reference stretched(const struct reference *r, double factor)
{
	struct reference more = *r;
	size_t n = r->q.count * r->q.rows;

	more.q.values = malloc(n * sizeof(double));
	for (size_t i = 0; more.q.values && i < n; i++)
		more.q.values[i] = factor * r->q.values[i];
	return more;
}

/* The torques by the text compiled for the processor; NULL if that failed. */
static void *host_torques(const struct rnea_robot *host, struct item *it, const struct reference *r, size_t count)
{
	const struct rnea_info *info = rnea_info(host);
	size_t n = info->input_count + 1;
	void *pointers[ARRAYS_LIMIT] = {NULL};
	struct rnea_error e;

	for (size_t i = 0; i < n; i++) {
		const struct rnea_argument *a = &info->arguments[i];

		pointers[i] = malloc(arrays_bytes(a, count));
		if (i + 1 < n)
			samples_tile(reference_find(r, a->name), pointers[i], count, a->scalar, info->layout);
	}
	if (rnea_run(host, pointers, count, &e) != RNEA_OK) {
		item_fail(it, "on the processor: %s", e.message);
		free(pointers[n - 1]);
		pointers[n - 1] = NULL;
	}
	for (size_t i = 0; i + 1 < n; i++)
		free(pointers[i]);
	return pointers[n - 1];
}

static void compare(const struct gpu *g, struct item *it, const struct rnea_robot *host, const struct reference *r,
	const char *what)
{
	struct arrays a = arrays_new(g, rnea_info(it->robot), r, r->q.count);
	const struct gpu_array *tau = &a.array[a.n - 1];
	void *want = host_torques(host, it, r, a.count);
	struct rnea_error e;

	if (rnea_launch(it->robot, a.pointers, a.count, g->stream, &e) != RNEA_OK)
		item_fail(it, "%s: %s", what, e.message);
	GPU(g, cuStreamSynchronize, (g->stream));
	if (want && (!gpu_array_read(g, tau, a.host) || memcmp(a.host, want, tau->bytes) != 0))
		item_fail(it, "%s: the torques have not the bits of those that the processor computes", what);
	free(want);
	arrays_free(g, &a);
}

void verify_bits(const struct gpu *g, struct item *it, const struct reference *r, const char *path)
{
	struct rnea_options options = {.backend = RNEA_BACKEND_HOST, .cache = ""};
	struct reference far = stretched(r, 1e5);
	struct rnea_robot *host;
	struct rnea_error e;

	if (rnea_open_file(path, &options, &host, &e) != RNEA_OK) {
		item_fail(it, "for the processor: %s", e.message);
	} else {
		compare(g, it, host, r, "bits");
		compare(g, it, host, &far, "bits at large angles");
		rnea_close(host);
	}
	free(far.q.values);
}
