/* Processes and threads that read, write and remove at the same time, and writers that are killed. Every image says
   what it is: its first bytes are a seed, the rest follows from the seed and the key, so that any that comes back can
   be judged. */
#define _GNU_SOURCE
#include "test_runtime_cache.h"
#include "support/rng.h"
#include <pthread.h>
#include <signal.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

enum { LARGE = 1 << 20 };

static void make_image(char *image, size_t size, uint64_t seed, const char *key)
{
	struct rng r = rng_seed(seed ^ fnv(FNV_START, key, strlen(key)));

	memcpy(image, &seed, sizeof seed);
	for (size_t at = sizeof seed; at < size; at++)
		image[at] = (char)rng_next(&r);
}

static size_t size_of(uint64_t seed, size_t limit)
{
	return sizeof seed + (size_t)(seed % (limit - sizeof seed));
}

static int put_image(const struct cache *c, const char *key, uint64_t seed, size_t limit)
{
	size_t size = size_of(seed, limit);
	char *image = malloc(size);
	int kept;

	make_image(image, size, seed, key);
	kept = cache_put(c, key, strlen(key), image, size, NULL);
	free(image);
	return kept;
}

/* 0: a miss; 1: an image of this key, whole; -1: something else. */
static int get_image(const struct cache *c, const char *key, uint64_t *seed, size_t limit)
{
	char *data, *want;
	size_t size;
	int right = 0;

	if (!cache_get(c, key, strlen(key), &data, &size))
		return 0;
	if (size >= sizeof *seed) {
		memcpy(seed, data, sizeof *seed);
		want = malloc(size);
		make_image(want, size, *seed, key);
		right = size == size_of(*seed, limit) && memcmp(want, data, size) == 0;
		free(want);
	}
	free(data);
	return right ? 1 : -1;
}

static uint64_t print_seed(const char *test)
{
	const char *chosen = getenv("RNEAGEN_SEED");
	uint64_t seed = chosen ? strtoull(chosen, NULL, 0) : (uint64_t)time(NULL);

	printf("%s: seed %llu\n", test, (unsigned long long)seed);
	fflush(stdout);
	return seed;
}

/* Start `count` processes, each of which exits with what work(context, i) returns; every one must return 0. */
static void run_children(int count, int (*work)(const struct cache *, uint64_t), const struct cache *c, uint64_t seed)
{
	pid_t *pids = calloc((size_t)count, sizeof *pids);
	int status;

	for (int i = 0; i < count; i++) {
		ck_assert_int_ge(pids[i] = fork(), 0);
		if (!pids[i])
			_exit(work(c, 1000 * seed + (uint64_t)i));
	}
	for (int i = 0; i < count; i++) {
		ck_assert_int_eq(waitpid(pids[i], &status, 0), pids[i]);
		ck_assert_msg(status == 0, "process %d: status %#x", i, (unsigned)status);
	}
	free(pids);
}

static int work_at_once(const struct cache *c, uint64_t seed)
{
	struct rng r = rng_seed(seed);
	char shared[16], own[32];
	uint64_t put, got;

	snprintf(own, sizeof own, "own %llu", (unsigned long long)seed);
	for (int i = 0; i < 60; i++) {
		snprintf(shared, sizeof shared, "shared %d", rng_below(&r, 8));
		if (!put_image(c, shared, rng_next(&r), 20000))
			return 1;
		snprintf(shared, sizeof shared, "shared %d", rng_below(&r, 8));
		if (get_image(c, shared, &got, 20000) < 0)
			return 2;
		put = rng_next(&r);
		if (!put_image(c, own, put, 20000))
			return 3;
		if (get_image(c, own, &got, 20000) != 1 || got != put)
			return 4;
	}
	return 0;
}

START_TEST(processes_at_once)
{
	struct cache c = cache_in("not/yet/there");
	char key[16];
	uint64_t got;

	run_children(32, work_at_once, &c, print_seed("processes_at_once"));
	for (int i = 0; i < 8; i++) {
		snprintf(key, sizeof key, "shared %d", i);
		ck_assert_int_eq(get_image(&c, key, &got, 20000), 1);
	}
	ck_assert_int_eq(count_entries(c.folder), 32 + 8);
	ck_assert_int_eq(count_temporaries(c.folder), 0);
}
END_TEST

static void *thread_at_once(void *context)
{
	const struct cache *c = ((const void **)context)[0];
	const uint64_t *seed = ((const void **)context)[1];

	return work_at_once(c, *seed) == 0 ? context : NULL;
}

/* The names of the files that are being written must differ. */
START_TEST(threads_at_once)
{
	struct cache c = cache_in("c");
	uint64_t first = print_seed("threads_at_once"), seeds[8];
	const void *contexts[8][2];
	pthread_t threads[8];
	void *good;

	for (int i = 0; i < 8; i++) {
		seeds[i] = 1000 * first + (uint64_t)i;
		contexts[i][0] = &c;
		contexts[i][1] = &seeds[i];
		ck_assert_int_eq(pthread_create(&threads[i], NULL, thread_at_once, contexts[i]), 0);
	}
	for (int i = 0; i < 8; i++) {
		ck_assert_int_eq(pthread_join(threads[i], &good), 0);
		ck_assert_ptr_nonnull(good);
	}
	ck_assert_int_eq(count_entries(c.folder), 8 + 8);
	ck_assert_int_eq(count_temporaries(c.folder), 0);
}
END_TEST

/* A writer that is killed in place of the call with number `at` of a kind, the writes being of a quarter of the image. */
struct writer {
	const struct cache *c;
	enum fault call;
	long at;
	uint64_t seed;
};

static int work_killed(void *context)
{
	const struct writer *w = context;

	faults_clear();
	faults.most = LARGE / 4;
	faults.die_at[w->call] = w->at;
	return put_image(w->c, "key", w->seed, LARGE) ? 0 : 1;
}

/* Let every temporary seem two hours old. */
static void age_temporaries(const struct cache *c)
{
	const char *argv[] = {
		"find", c->folder, "-name", "rnea-tmp-*", "-exec", "touch", "-d", "2 hours ago", "{}", "+", NULL};
	int status;
	pid_t pid = fork();

	if (!pid) {
		execvp("find", (char *const *)(uintptr_t)argv);
		_exit(127);
	}
	ck_assert_int_eq(waitpid(pid, &status, 0), pid);
	ck_assert_int_eq(status, 0);
}

/* Which image is found after a writer was killed, and what it left: nothing before its file is there and after it is in
   place, when only the pruning comes. */
static void check_killed(const struct writer *w, uint64_t before)
{
	int left = count_temporaries(w->c->folder), unfinished = 0, done = 0;
	uint64_t got;

	ck_assert_int_eq(run_child(work_killed, (void *)(uintptr_t)w), 128 + SIGKILL);
	if (w->call == FAULT_OPEN || w->call == FAULT_CLOSE)
		done = w->at > 1;
	unfinished = !done && w->call != FAULT_OPEN;
	ck_assert_msg(get_image(w->c, "key", &got, LARGE) == 1, "%d %ld: a wrong image", w->call, w->at);
	ck_assert_msg(got == (done ? w->seed : before), "%d %ld: the image of another writer", w->call, w->at);
	ck_assert_int_eq(count_temporaries(w->c->folder), left + unfinished);
}

/* How many calls of each kind a put makes. */
static void count_calls(const struct cache *c, uint64_t seed, long calls[FAULT_COUNT])
{
	faults_clear();
	faults.most = LARGE / 4;
	ck_assert_int_eq(put_image(c, "key", seed, LARGE), 1);
	memcpy(calls, faults.calls, sizeof faults.calls);
	faults_clear();
}

/* Catches a cache that a killed writer leaves damaged or fills up: one is killed at each of its calls in turn. */
START_TEST(killed_writers)
{
	static const enum fault kinds[] = {FAULT_OPEN, FAULT_WRITE, FAULT_CLOSE, FAULT_RENAME};
	const uint64_t first = LARGE - 100, second = first - 1; /* of large images */
	struct cache c = cache_in("c");
	long calls[FAULT_COUNT], killed = 0;

	count_calls(&c, first, calls);
	ck_assert_int_eq(calls[FAULT_RENAME], 1);
	ck_assert_int_ge(calls[FAULT_WRITE], 2 + 4); /* the header, the key, quarters of the image */
	for (size_t k = 0; k < sizeof kinds / sizeof *kinds; k++)
		for (long at = 1; at <= calls[kinds[k]]; at++, killed++) {
			const struct writer w = {&c, kinds[k], at, second};

			ck_assert_int_eq(put_image(&c, "key", first, LARGE), 1);
			check_killed(&w, first);
		}
	printf("%ld writers killed: %d unfinished files\n", killed, count_temporaries(c.folder));
	ck_assert_int_eq(count_temporaries(c.folder), calls[FAULT_WRITE] + 2); /* and at the first close, and at the rename */
	age_temporaries(&c);
	ck_assert_int_eq(put_text(&c, "key", "image"), 1);
	ck_assert_int_eq(count_temporaries(c.folder), 0);
}
END_TEST

/* ---- an entry that goes while it is read ---- */

static struct cache hooked;

static void remove_entry(void)
{
	unlink(entry_path(&hooked, "key", 3));
}

static void replace_entry(void)
{
	put_text(&hooked, "key", "the second image");
}

START_TEST(gone_while_read)
{
	hooked = cache_in("c");
	ck_assert_int_eq(put_text(&hooked, "key", "image"), 1);
	faults.before_read = replace_entry;
	ck_assert_int_eq(get_is(&hooked, "key", "image"), 1);
	ck_assert_int_eq(get_is(&hooked, "key", "the second image"), 1);
	faults.before_read = remove_entry;
	ck_assert_int_eq(get_is(&hooked, "key", "the second image"), 1);
	ck_assert_int_eq(get_is(&hooked, "key", "the second image"), 0);
}
END_TEST

/* Hits and misses of all processes. */
static atomic_long *counts;

static int work_get_or_put(const struct cache *c, uint64_t seed)
{
	struct rng r = rng_seed(seed);
	char key[16];
	uint64_t got;
	int found;

	for (int i = 0; i < 150; i++) {
		snprintf(key, sizeof key, "%d", rng_below(&r, 2 * CACHE_ENTRIES));
		if (seed % 2) {
			if (!put_image(c, key, rng_next(&r), 5000))
				return 1;
			continue;
		}
		if ((found = get_image(c, key, &got, 5000)) < 0)
			return 2;
		counts[found]++;
	}
	return 0;
}

/* As many entries as may be: every put removes one, which somebody may be reading. */
START_TEST(removed_while_read)
{
	struct cache c = cache_in("c");
	uint64_t seed = print_seed("removed_while_read");
	char key[16];

	counts = mmap(NULL, 4096, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
	ck_assert(counts != MAP_FAILED);
	for (int i = 0; i < CACHE_ENTRIES; i++) {
		snprintf(key, sizeof key, "%d", i);
		ck_assert_int_eq(put_image(&c, key, (uint64_t)i, 5000), 1);
	}
	run_children(16, work_get_or_put, &c, seed);
	printf("%ld hits, %ld misses\n", counts[1], counts[0]);
	ck_assert_int_gt(counts[1], 0);
	ck_assert_int_gt(counts[0], 0);
	ck_assert_int_eq(put_image(&c, "last", seed, 5000), 1);
	/* each of several that remove at once may count what another has just removed: never more are left */
	ck_assert_int_le(count_entries(c.folder), CACHE_ENTRIES);
	ck_assert_int_gt(count_entries(c.folder), CACHE_ENTRIES / 2);
	ck_assert_int_eq(count_temporaries(c.folder), 0);
	munmap(counts, 4096);
}
END_TEST

/* ---- turns ---- */

static int take_turn(void *context)
{
	struct cache_turn turn;

	return cache_turn_begin(context, "key", 3, &turn);
}

static int fail_at_turn(void *context)
{
	struct cache_turn turn;

	if (!cache_turn_begin(context, "key", 3, &turn))
		return 1;
	raise(SIGKILL);
	return 0;
}

/* One at a time makes an entry, and who is killed holds nobody up; other entries, and where there is no cache, are free. */
START_TEST(turns)
{
	struct cache c = cache_in("turns"), none = {""};
	struct cache_turn first, second, other;

	ck_assert_int_eq(cache_turn_begin(&c, "key", 3, &first), 1);
	ck_assert_int_eq(cache_turn_begin(&c, "key", 3, &second), 0);
	ck_assert_int_eq(run_child(take_turn, &c), 0);
	ck_assert_int_eq(cache_turn_begin(&c, "other", 5, &other), 1);
	ck_assert_int_eq(cache_turn_begin(&none, "key", 3, &second), 1);
	cache_turn_end(&second);
	cache_turn_end(&other);
	ck_assert(put_text(&c, "key", "made"));
	cache_turn_end(&first);
	ck_assert_int_eq(run_child(fail_at_turn, &c), 128 + SIGKILL);
	ck_assert_int_eq(run_child(take_turn, &c), 1);
	ck_assert_int_eq(cache_turn_begin(&c, "key", 3, &first), 1);
	cache_turn_end(&first);
	ck_assert_int_eq(count_temporaries(c.folder), 0);
	get_is(&c, "key", "made");
}
END_TEST

Suite *suite_cache_race(void)
{
	Suite *s = suite_create("cache race");
	TCase *t = tcase_create("cache race");

	tcase_set_timeout(t, 300);
	tcase_add_checked_fixture(t, sandbox_make, sandbox_remove);
	tcase_add_test(t, processes_at_once);
	tcase_add_test(t, threads_at_once);
	tcase_add_test(t, killed_writers);
	tcase_add_test(t, gone_while_read);
	tcase_add_test(t, removed_while_read);
	tcase_add_test(t, turns);
	suite_add_tcase(s, t);
	return s;
}
