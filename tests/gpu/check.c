/* gpu_check FOLDER RESULTS.csv [--counts A,B,C] [--large N] [--replays N] [--chain N] [--block N]
   Open, verify and time every text that FOLDER/manifest.txt lists. Exit status 0: all is right; 1: something is wrong;
   77: no driver. */
#include "check.h"
#include <pthread.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

enum { ITEM_LIMIT = 512, THREAD_LIMIT = 64 };

struct work {
	const char *folder;
	struct item *items;
	size_t count;
	struct rnea_options options;
	atomic_size_t next;
};

/* A line of the manifest: text, folder of the reference, "aot" or "-". */
static size_t read_manifest(const char *folder, struct item *items)
{
	char path[1024], line[1024], aot[8];
	size_t n = 0;
	FILE *f;

	snprintf(path, sizeof path, "%s/manifest.txt", folder);
	if (!(f = fopen(path, "r"))) {
		fprintf(stderr, "%s: cannot be opened\n", path);
		return 0;
	}
	while (n < ITEM_LIMIT && fgets(line, sizeof line, f)) {
		struct item *it = &items[n];

		if (sscanf(line, "%255s %255s %7s", it->text, it->reference, aot) != 3)
			continue;
		it->aot = strcmp(aot, "aot") == 0;
		n++;
	}
	fclose(f);
	return n;
}

static double seconds_now(void)
{
	struct timespec t;

	clock_gettime(CLOCK_MONOTONIC, &t);
	return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
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

static void check_item(
	const struct gpu *g, const struct settings *s, const struct floor *f, const char *folder, struct item *it)
{
	char path[1024];
	struct reference r;

	snprintf(path, sizeof path, "%s/%s", folder, it->reference);
	if (!it->robot || !reference_read(&r, path)) {
		item_fail(it, "%s: no reference data", path);
		return;
	}
	verify(g, s, it, &r);
	snprintf(path, sizeof path, "%s/aot/%.*s.so", folder, (int)strcspn(it->text, "."), it->text);
	if (it->aot && access(path, R_OK) == 0)
		verify_aot(g, it, &r, path);
	else if (it->aot)
		printf("skipped: %s: not built by nvcc\n", it->text);
	if (s->replays > 0)
		measure(g, s, f, it, &r);
	reference_free(&r);
	printf("%s %s\n", *it->failure ? "FAIL" : "ok  ", it->text);
	fflush(stdout);
}

static int read_options(struct settings *s, int argc, char **argv)
{
	for (int i = 3; i < argc; i += 2) {
		if (i + 1 == argc)
			return 0;
		if (strcmp(argv[i], "--large") == 0)
			s->large = strtoull(argv[i + 1], NULL, 10);
		else if (strcmp(argv[i], "--replays") == 0)
			s->replays = atoi(argv[i + 1]);
		else if (strcmp(argv[i], "--chain") == 0)
			s->chain = atoi(argv[i + 1]);
		else if (strcmp(argv[i], "--block") == 0)
			s->block = (unsigned)atoi(argv[i + 1]);
		else if (strcmp(argv[i], "--counts") != 0 ||
			 sscanf(argv[i + 1], "%zu,%zu,%zu", &s->counts[0], &s->counts[1], &s->counts[2]) != 3)
			return 0;
	}
	return argc >= 3;
}

int main(int argc, char **argv)
{
	static struct item items[ITEM_LIMIT];
	struct settings s = {.counts = {1, 1000, 1000003}, .large = 1 << 20, .replays = 21, .chain = 200};
	struct work w = {.items = items};
	struct gpu g;
	struct floor f;
	int failures;

	if (!read_options(&s, argc, argv)) {
		fputs("usage: gpu_check FOLDER RESULTS.csv [--counts A,B,C] [--large N] [--replays N] [--chain N] "
		      "[--block N]\n",
			stderr);
		return 2;
	}
	w.folder = argv[1];
	w.options.block = s.block;
	if (!(w.count = read_manifest(w.folder, items)))
		return 2;
	gpu_start(&g);
	floor_open(&g, &f);
	open_all(&w);
	for (size_t i = 0; i < w.count; i++)
		check_item(&g, &s, &f, w.folder, &items[i]);
	failures = report(&g, &s, items, w.count, argv[2]);
	for (size_t i = 0; i < w.count; i++)
		rnea_close(items[i].robot);
	floor_close(&g, &f);
	gpu_stop(&g);
	return failures != 0;
}
