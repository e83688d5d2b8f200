/* gpu_check FOLDER RESULTS.csv [OPTION VALUE]...
   Open, verify and time every text that FOLDER/manifest.txt lists. Exit status 0: all is right; 1: something is wrong;
   77: no driver.
     --manifest NAME    another file of FOLDER instead of manifest.txt
     --aot NAME         another folder of FOLDER instead of aot, of what nvcc has built
     --counts A,B,...   batches whose torques are checked
     --elements N       of tau, for the texts that the manifest calls large; 0: none
     --large N          samples for the time per sample
     --replays N        of a graph, for the median; 0: no times
     --chain N          launches in a graph for the latency
     --block N          samples per block
     --latency TEXT     of this text alone, in a context where no other has run: its latencies, a row at the end of
                        RESULTS.csv; no checks
     --cache FOLDER     empty: the time to open with a cache and without, for the texts that the manifest calls build */
#include "check.h"
#include <pthread.h>
#include <stdatomic.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { ITEM_LIMIT = 512, THREAD_LIMIT = 64 };

/* The median of fewer says nothing. */
enum { FEW_REPLAYS = 7 };

struct work {
	const char *folder;
	struct item *items;
	size_t count;
	struct rnea_options options;
	atomic_size_t next;
};

/* A line of the manifest: text, folder of the reference, "-" or of "aot", "strict", "large", "listed", "build" and "alone" those
   that apply. */
static size_t read_manifest(const char *folder, const char *name, struct item *items)
{
	char path[1024], line[1024], marks[32];
	size_t n = 0;
	FILE *f;

	snprintf(path, sizeof path, "%s/%s", folder, name);
	if (!(f = fopen(path, "r"))) {
		fprintf(stderr, "%s: cannot be opened\n", path);
		return 0;
	}
	while (n < ITEM_LIMIT && fgets(line, sizeof line, f)) {
		struct item *it = &items[n];

		if (sscanf(line, "%255s %255s %31s", it->text, it->reference, marks) != 3)
			continue;
		it->is_strict = strstr(marks, "strict") != NULL;
		it->aot = strstr(marks, "aot") != NULL;
		it->is_large = strstr(marks, "large") != NULL;
		it->is_listed = strstr(marks, "listed") != NULL;
		it->is_built = strstr(marks, "build") != NULL;
		it->is_alone = strstr(marks, "alone") != NULL;
		n++;
	}
	fclose(f);
	return n;
}

/* The text of this name alone, if it is there. */
static size_t keep_one(struct item *items, size_t count, const char *text)
{
	for (size_t i = 0; i < count; i++)
		if (strcmp(items[i].text, text) == 0) {
			items[0] = items[i];
			return 1;
		}
	fprintf(stderr, "%s: not in the manifest\n", text);
	return 0;
}

/* Has the text a kernel of small batches that the robot does without? The runtime says nothing of that. */
static int lacks_limbs(const char *path, const struct rnea_robot *robot)
{
	char line[512];
	int has = rnea_info(robot)->functions->limbs.warps > 0;
	FILE *f = fopen(path, "r");

	while (!has && f && fgets(line, sizeof line, f))
		if (strncmp(line, "#define RNEA_LIMBS ", strlen("#define RNEA_LIMBS ")) == 0) {
			fclose(f);
			return 1;
		}
	if (f)
		fclose(f);
	return 0;
}

static void *open_some(void *argument)
{
	struct work *w = argument;

	for (size_t i; (i = w->next++) < w->count;) {
		struct item *it = &w->items[i];
		double start = seconds_now();
		char path[1024];
		struct rnea_error e;

		snprintf(path, sizeof path, "%s/%s", w->folder, it->text);
		if (rnea_open_file(path, &w->options, &it->robot, &e) != RNEA_OK)
			item_fail(it, "%s", e.message);
		else if (lacks_limbs(path, it->robot))
			item_fail(it, "the kernel of small batches did not compile, or did not load");
		else
			it->limit = item_limit(it);
		it->seconds = seconds_now() - start;
	}
	return NULL;
}

/* Most of opening is compiling: one thread for each processor. */
static void open_all(struct work *w)
{
	long processors = sysconf(_SC_NPROCESSORS_ONLN);
	int n = processors < 1 ? 1 : processors > THREAD_LIMIT ? THREAD_LIMIT : (int)processors;
	pthread_t threads[THREAD_LIMIT];
	double start = seconds_now();

	for (int i = 0; i < n; i++)
		if (pthread_create(&threads[i], NULL, open_some, w) != 0)
			n = i;
	if (n == 0)
		open_some(w);
	for (int i = 0; i < n; i++)
		pthread_join(threads[i], NULL);
	printf("opened %zu texts in %.1f s with %d threads\n", w->count, seconds_now() - start, n);
	fflush(stdout);
}

/* The reference of an item that was opened; 0 if there is none that fits it, or no robot. */
static int read_reference(const char *folder, struct item *it, struct reference *r)
{
	char path[1024];

	snprintf(path, sizeof path, "%s/%.255s", folder, it->reference);
	if (!it->robot || !reference_read(r, path)) {
		item_fail(it, "%s: no reference data", path);
		return 0;
	}
	if (item_matches(it, r))
		return 1;
	reference_free(r);
	return 0;
}

/* Returns 0 where a launch takes longer at the end than at the beginning: then some latencies do too. */
static int measure_latencies(const struct gpu *g, const struct settings *s, struct floor *f, const struct work *w)
{
	double after;

	f->empty_graph = measure_empty(g, s, f);
	for (size_t i = 0; i < w->count; i++) {
		struct reference r;

		if (read_reference(w->folder, &w->items[i], &r)) {
			measure_latency(g, s, &w->items[i], &r);
			reference_free(&r);
		}
	}
	after = measure_empty(g, s, f);
	if (after <= 1.1 * f->empty_graph || s->replays < FEW_REPLAYS)
		return 1;
	printf("FAIL latencies: a launch of an empty kernel took %.3f us before, and takes %.3f now\n", f->empty_graph * 1e6,
		after * 1e6);
	return 0;
}

static void check_aot(
	const struct gpu *g, const struct settings *s, const char *folder, struct item *it, const struct reference *r)
{
	char path[1024];

	snprintf(path, sizeof path, "%s/%s/%.*s.so", folder, s->aot, (int)strcspn(it->text, "."), it->text);
	if (access(path, R_OK) == 0)
		verify_aot(g, it, r, path);
	else
		printf("skipped: %s: not built by nvcc\n", it->text);
}

static void check_item(const struct gpu *g, const struct settings *s, const struct floor *f, const char *folder,
	struct item *it, struct item *partner)
{
	struct reference r, partner_r;
	char path[1024];
	int has_partner;

	if (!read_reference(folder, it, &r))
		return;
	verify(g, s, it, &r);
	has_partner = partner != it && read_reference(folder, partner, &partner_r);
	verify_streams(g, it, &r, partner, has_partner ? &partner_r : NULL);
	if (has_partner)
		reference_free(&partner_r);
	if (it->is_built)
		verify_host(g, s, it, &r);
	if (it->is_large && s->elements)
		verify_large(g, it, &r, s->elements);
	if (it->aot)
		check_aot(g, s, folder, it, &r);
	if (s->replays > 0)
		measure(g, s, f, it, &r);
	if (s->replays > 0 && it->is_built)
		cost_host(g, s, it, &r);
	snprintf(path, sizeof path, "%s/%.255s", folder, it->text);
	if (it->is_strict)
		verify_bits(g, it, &r, path);
	if (it->is_built && s->cache)
		cost_build(it, path, s->cache);
	reference_free(&r);
	printf("%s %s\n", *it->failure ? "FAIL" : "ok  ", it->text);
	fflush(stdout);
}

/* Returns how many failed. */
static int check_all(const struct gpu *g, const struct settings *s, struct floor *f, struct work *w, const char *results)
{
	for (size_t i = 0; i < w->count; i++)
		check_item(g, s, f, w->folder, &w->items[i], &w->items[(i + w->count / 2) % w->count]);
	if (s->replays > 0 && f->module)
		f->empty_host = cost_launch(g, s, f->empty, NULL, NULL);
	return report(g, s, f, w->items, w->count, results);
}

/* "1,2,3" */
static int read_counts(struct settings *s, const char *text)
{
	char *end = (char *)(uintptr_t)text;

	for (s->size_count = 0; *text && s->size_count < SIZE_LIMIT; text = end + (*end == ',')) {
		size_t count = strtoull(text, &end, 10);

		if (end == text || count == 0)
			return 0;
		s->counts[s->size_count++] = count;
	}
	return !*text && s->size_count;
}

static int read_options(struct settings *s, int argc, char **argv)
{
	for (int i = 3; i < argc; i += 2) {
		const char *value = argv[i + 1];

		if (!value)
			return 0;
		if (strcmp(argv[i], "--large") == 0)
			s->large = strtoull(value, NULL, 10);
		else if (strcmp(argv[i], "--elements") == 0)
			s->elements = strtoull(value, NULL, 10);
		else if (strcmp(argv[i], "--replays") == 0)
			s->replays = atoi(value);
		else if (strcmp(argv[i], "--chain") == 0)
			s->chain = atoi(value);
		else if (strcmp(argv[i], "--block") == 0)
			s->block = (unsigned)atoi(value);
		else if (strcmp(argv[i], "--latency") == 0)
			s->latency = value;
		else if (strcmp(argv[i], "--cache") == 0)
			s->cache = value;
		else if (strcmp(argv[i], "--manifest") == 0)
			s->manifest = value;
		else if (strcmp(argv[i], "--aot") == 0)
			s->aot = value;
		else if (strcmp(argv[i], "--counts") != 0 || !read_counts(s, value))
			return 0;
	}
	return argc >= 3;
}

int main(int argc, char **argv)
{
	static struct item items[ITEM_LIMIT];
	struct settings s = {.counts = {1, 31, 127, 128, 129, 1000, 4097, 1000003},
		.size_count = 8,
		.elements = (size_t)1 << 31,
		.large = 1 << 20,
		.replays = 21,
		.chain = 200,
		.manifest = "manifest.txt",
		.aot = "aot"};
	struct work w = {.items = items, .options = {.backend = RNEA_BACKEND_CUDA, .cache = ""}};
	struct gpu g;
	struct floor f;
	int failures, is_steady = 1;

	if (!read_options(&s, argc, argv)) {
		fputs("usage: gpu_check FOLDER RESULTS.csv [OPTION VALUE]...; the options stand in tests/gpu/check/check.c\n",
			stderr);
		return 2;
	}
	w.folder = argv[1];
	w.options.block = s.block;
	if (!(w.count = read_manifest(w.folder, s.manifest, items)) || (s.latency && !(w.count = keep_one(items, w.count, s.latency))))
		return 2;
	gpu_start(&g);
	floor_open(&g, &f);
	open_all(&w);
	if (s.replays > 0)
		is_steady = measure_latencies(&g, &s, &f, &w);
	failures = s.latency ? report_latency(&f, items, argv[2]) : check_all(&g, &s, &f, &w, argv[2]);
	for (size_t i = 0; i < w.count; i++)
		rnea_close(items[i].robot);
	floor_close(&g, &f);
	gpu_stop(&g);
	return failures != 0 || !is_steady;
}
