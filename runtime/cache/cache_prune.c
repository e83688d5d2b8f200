/* openat, fdopendir, clock_gettime */
#define _POSIX_C_SOURCE 200809L
#include "cache/cache_prune.h"
#include "cache/cache.h"
#include <dirent.h>
#include <fcntl.h>
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

static const char prefix[] = "rnea-";
static const char temporary[] = "rnea-tmp-";

/* Seconds after which a file that is still being written has lost its writer. */
enum { STALE = 3600 };

struct entry {
	uint64_t hash, size;
	int64_t used; /* nanoseconds since 1970 */
};

struct entries {
	struct entry *list;
	size_t count, capacity;
	uint64_t size;
};

void cache_name_entry(char name[CACHE_NAME_SIZE], uint64_t hash)
{
	snprintf(name, CACHE_NAME_SIZE, "%s%016" PRIx64, prefix, hash);
}

void cache_name_turn(char name[CACHE_NAME_SIZE], uint64_t hash)
{
	snprintf(name, CACHE_NAME_SIZE, "%sturn-%016" PRIx64, temporary, hash);
}

/* The process, the time and the attempt; O_EXCL tells where even these coincide. */
void cache_name_temporary(char name[CACHE_NAME_SIZE], int attempt)
{
	struct timespec now = {0};

	clock_gettime(CLOCK_REALTIME, &now);
	snprintf(name, CACHE_NAME_SIZE, "%s%ld-%ld%09ld-%d", temporary, (long)getpid(), (long)now.tv_sec, now.tv_nsec,
		attempt);
}

static int is_entry(const char *name, uint64_t *hash)
{
	char again[CACHE_NAME_SIZE];

	if (strncmp(name, prefix, strlen(prefix)) != 0)
		return 0;
	*hash = strtoull(name + strlen(prefix), NULL, 16);
	cache_name_entry(again, *hash);
	return strcmp(name, again) == 0;
}

static int append(struct entries *e, const struct entry *one)
{
	size_t capacity = e->capacity ? 2 * e->capacity : 2 * CACHE_ENTRIES;
	struct entry *list;

	if (e->count == e->capacity) {
		if (!(list = realloc(e->list, capacity * sizeof *list)))
			return 0;
		e->list = list;
		e->capacity = capacity;
	}
	e->list[e->count++] = *one;
	e->size += one->size;
	return 1;
}

/* When a file was used; a time to come, of a clock that was wrong, counts as long ago, or the file would stay for ever.
 */
static int64_t time_used(const struct stat *s, time_t now)
{
	if (s->st_mtim.tv_sec > now + STALE)
		return 0;
	return (int64_t)s->st_mtim.tv_sec * 1000000000 + s->st_mtim.tv_nsec;
}

/* List the entry `name`, or remove it if it is a temporary without a writer; 0 when memory runs out. */
static int look_at(int folder, const char *name, time_t now, struct entries *e)
{
	struct entry one;
	struct stat s;

	if (strncmp(name, prefix, strlen(prefix)) != 0 || fstatat(folder, name, &s, AT_SYMLINK_NOFOLLOW) != 0 ||
		S_ISDIR(s.st_mode))
		return 1;
	one.used = time_used(&s, now);
	one.size = (uint64_t)s.st_size;
	if (is_entry(name, &one.hash))
		return append(e, &one);
	if (strncmp(name, temporary, strlen(temporary)) == 0 && one.used / 1000000000 < now - STALE)
		unlinkat(folder, name, 0);
	return 1;
}

static int list_entries(int folder, struct entries *e)
{
	int fd = openat(folder, ".", O_RDONLY | O_DIRECTORY | O_CLOEXEC), complete = 1;
	DIR *directory = fd < 0 ? NULL : fdopendir(fd);
	const struct dirent *d;
	time_t now = time(NULL);

	if (!directory) {
		if (fd >= 0)
			close(fd);
		return 0;
	}
	while (complete && (d = readdir(directory)) != NULL)
		complete = look_at(folder, d->d_name, now, e);
	closedir(directory);
	return complete;
}

static int compare_used(const void *a, const void *b)
{
	int64_t x = ((const struct entry *)a)->used, y = ((const struct entry *)b)->used;

	return (x > y) - (x < y);
}

/* Two processes may do this at once: what one has removed the other does not find, which is as good. */
void cache_prune(int folder)
{
	struct entries e = {0};
	char name[CACHE_NAME_SIZE];

	if (list_entries(folder, &e) && (e.count > CACHE_ENTRIES || e.size > CACHE_BYTES)) {
		qsort(e.list, e.count, sizeof *e.list, compare_used);
		for (size_t i = 0; e.count - i > CACHE_ENTRIES || e.size > CACHE_BYTES; i++) {
			cache_name_entry(name, e.list[i].hash);
			unlinkat(folder, name, 0);
			e.size -= e.list[i].size;
		}
	}
	free(e.list);
}
