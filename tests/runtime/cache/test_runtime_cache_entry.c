/* What is kept, what is a miss, and what is removed. */
#define _GNU_SOURCE
#include "test_runtime_cache.h"
#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

/* An entry: magic, size of the key, size of the image, checksum; the key; the image. */
enum { HEADER = 32, KEY_SIZE_AT = 8, DATA_SIZE_AT = 16, CHECKSUM_AT = 24 };

START_TEST(keeps_images)
{
	struct cache c = cache_in("c");
	char *data;
	size_t size;

	/* of this key FNV-1a is known: 0x85944171f73967e8 */
	ck_assert_ptr_nonnull(strstr(entry_path(&c, "foobar", 6), "/rnea-85944171f73967e8"));
	ck_assert_int_eq(get_is(&c, "foobar", "image"), 0);
	ck_assert_int_eq(put_text(&c, "foobar", "image"), 1);
	ck_assert_int_eq(access(entry_path(&c, "foobar", 6), F_OK), 0);
	ck_assert_int_eq(get_is(&c, "foobar", "image"), 1);
	ck_assert_int_eq(get_is(&c, "fooba", "image"), 0);
	ck_assert_int_eq(put_text(&c, "foobar", "a longer image"), 1);
	ck_assert_int_eq(get_is(&c, "foobar", "a longer image"), 1);
	ck_assert_int_eq(put_text(&c, "foobar", ""), 1);
	ck_assert_int_eq(get_is(&c, "foobar", ""), 1);
	ck_assert_int_eq(put_text(&c, "", "of no key"), 1);
	ck_assert_int_eq(get_is(&c, "", "of no key"), 1);
	/* any bytes; and what follows the last is a NUL */
	ck_assert_int_eq(cache_put(&c, "a\0b", 3, "\0\377\0", 3, NULL), 1);
	ck_assert_int_eq(cache_put(&c, "a\0c", 3, "x\0", 2, NULL), 1);
	ck_assert_int_eq(cache_get(&c, "a\0b", 3, &data, &size), 1);
	ck_assert_uint_eq(size, 3);
	ck_assert_mem_eq(data, "\0\377\0\0", 4);
	free(data);
	ck_assert_int_eq(get_is(&c, "a", ""), 0);
	ck_assert_int_eq(count_entries(c.folder), 4);
	ck_assert_int_eq(count_temporaries(c.folder), 0);
}
END_TEST

/* The file at the name of `key`, in which the key is `other`, with the checksum that belongs to it. */
static void forge(const struct cache *c, const char *key, const char *other)
{
	size_t size;
	char *content = entry_read(entry_path(c, key, strlen(key)), &size);
	uint64_t sum;

	memcpy(content + HEADER, other, strlen(other));
	sum = fnv(FNV_START, content + HEADER, size - HEADER);
	memcpy(content + CHECKSUM_AT, &sum, sizeof sum);
	entry_write(entry_path(c, key, strlen(key)), content, size);
	free(content);
}

START_TEST(compares_the_key)
{
	struct cache c = cache_in("c");

	ck_assert_int_eq(put_text(&c, "key 1", "image"), 1);
	forge(&c, "key 1", "key 1");
	ck_assert_int_eq(get_is(&c, "key 1", "image"), 1);
	forge(&c, "key 1", "key 2");
	ck_assert_int_eq(get_is(&c, "key 1", "image"), 0);
	ck_assert_int_eq(put_text(&c, "key 1", "image"), 1);
	ck_assert_int_eq(get_is(&c, "key 1", "image"), 1);
	/* an entry that was renamed */
	ck_assert_int_eq(put_text(&c, "key 2", "of key 2"), 1);
	ck_assert_int_eq(put_text(&c, "key", "of key"), 1);
	char *from = strdup(entry_path(&c, "key 2", 5));
	ck_assert_int_eq(rename(from, entry_path(&c, "key 1", 5)), 0);
	ck_assert_int_eq(get_is(&c, "key 1", "of key 2"), 0);
	ck_assert_int_eq(put_text(&c, "key 2", "of key 2"), 1);
	ck_assert_int_eq(rename(from, entry_path(&c, "key", 3)), 0);
	ck_assert_int_eq(get_is(&c, "key", "of key 2"), 0);
	free(from);
}
END_TEST

START_TEST(flipped_bits_are_misses)
{
	struct cache c = cache_in("c");
	char *path, *content;
	size_t size;

	ck_assert_int_eq(put_text(&c, "the key", "the image that is kept"), 1);
	path = strdup(entry_path(&c, "the key", 7));
	content = entry_read(path, &size);
	ck_assert_uint_eq(size, HEADER + 7 + 22);
	for (size_t at = 0; at < size; at++)
		for (int bit = 0; bit < 9; bit++) {
			char kept = content[at];

			content[at] = (char)(kept ^ (bit < 8 ? 1 << bit : 0xff));
			entry_write(path, content, size);
			ck_assert_msg(!get_is(&c, "the key", "the image that is kept"), "byte %zu, bit %d", at, bit);
			content[at] = kept;
		}
	entry_write(path, content, size);
	ck_assert_int_eq(get_is(&c, "the key", "the image that is kept"), 1);
	free(content);
	free(path);
}
END_TEST

START_TEST(other_lengths_are_misses)
{
	struct cache c = cache_in("c");
	char *path, *content;
	size_t size;

	ck_assert_int_eq(put_text(&c, "the key", "the image that is kept"), 1);
	path = strdup(entry_path(&c, "the key", 7));
	content = entry_read(path, &size);
	for (size_t length = 0; length < size + 5000; length++) {
		if (length > size)
			content[length - 1] = (char)length;
		entry_write(path, content, length);
		ck_assert_msg(get_is(&c, "the key", "the image that is kept") == (length == size), "%zu bytes", length);
	}
	free(content);
	free(path);
}
END_TEST

/* Sizes of the image as a damaged entry may state them, in a file that has them or has not: no memory is asked for. */
START_TEST(damaged_sizes_take_no_memory)
{
	struct cache c = cache_in("c");
	uint64_t sizes[] = {UINT64_C(1) << 60, UINT64_MAX, UINT64_MAX - HEADER - 7 + 1, UINT64_C(1) << 31,
		UINT64_C(1) << 40, (UINT64_C(1) << 32) + 5, CACHE_BYTES, CACHE_BYTES - HEADER - 6, UINT64_C(1) << 63};
	char *path, *content;
	int lengthened = 0;
	size_t size;

	ck_assert_int_eq(put_text(&c, "the key", "image"), 1);
	path = strdup(entry_path(&c, "the key", 7));
	content = entry_read(path, &size);
	for (size_t i = 0; i < 4 * (sizeof sizes / sizeof *sizes); i++) {
		memcpy(content + (i & 1 ? KEY_SIZE_AT : DATA_SIZE_AT), &sizes[i / 4], 8);
		entry_write(path, content, size);
		faults.allocated = 0;
		/* where no file can be so long it stays short */
		if (i & 2 && truncate(path, (off_t)(sizes[i / 4] + HEADER + 7)) == 0)
			lengthened++;
		ck_assert_int_eq(get_is(&c, "the key", "image"), 0);
		ck_assert_uint_lt(faults.allocated, 1000000);
		memcpy(content + KEY_SIZE_AT, &(uint64_t){7}, 8);
		memcpy(content + DATA_SIZE_AT, &(uint64_t){5}, 8);
	}
	ck_assert_int_gt(lengthened, 0);
	entry_write(path, content, size);
	ck_assert_int_eq(get_is(&c, "the key", "image"), 1);
	free(content);
	free(path);
}
END_TEST

START_TEST(only_files_of_this_user_alone)
{
	struct cache c = cache_in("c");
	char *path;

	ck_assert_int_eq(put_text(&c, "key", "image"), 1);
	path = strdup(entry_path(&c, "key", 3));
	ck_assert_int_eq(chmod(path, 0620), 0);
	ck_assert_int_eq(get_is(&c, "key", "image"), 0);
	ck_assert_int_eq(chmod(path, 0602), 0);
	ck_assert_int_eq(get_is(&c, "key", "image"), 0);
	ck_assert_int_eq(chmod(path, 0644), 0);
	ck_assert_int_eq(get_is(&c, "key", "image"), 1);
	if (geteuid() == 0) {
		ck_assert_int_eq(chown(path, 12345, 12345), 0);
		ck_assert_int_eq(get_is(&c, "key", "image"), 0);
		ck_assert_int_eq(chown(path, 0, 0), 0);
	} else {
		puts("skipped: only_files_of_this_user_alone: giving a file away takes root");
	}
	ck_assert_int_eq(rename(path, inside("elsewhere")), 0);
	ck_assert_int_eq(symlink(inside("elsewhere"), path), 0);
	ck_assert_int_eq(get_is(&c, "key", "image"), 0);
	ck_assert_int_eq(put_text(&c, "key", "second"), 1); /* in place of the link, not through it */
	ck_assert_int_eq(get_is(&c, "key", "second"), 1);
	ck_assert_int_eq(unlink(path), 0);
	ck_assert_int_eq(mkfifo(path, 0600), 0);
	ck_assert_int_eq(get_is(&c, "key", "image"), 0); /* and does not wait for a writer */
	ck_assert_int_eq(unlink(path), 0);
	free(path);
}
END_TEST

/* ---- what is removed ---- */

static void set_age(const char *path, long seconds)
{
	struct timespec times[2] = {{.tv_sec = time(NULL) - seconds}, {.tv_sec = time(NULL) - seconds}};

	ck_assert_msg(utimensat(AT_FDCWD, path, times, 0) == 0, "%s: %s", path, strerror(errno));
}

static const char *key_of(int i)
{
	static char key[16];

	snprintf(key, sizeof key, "key %d", i);
	return key;
}

static void put_aged(const struct cache *c, int i, long age)
{
	ck_assert_int_eq(put_text(c, key_of(i), "image"), 1);
	set_age(entry_path(c, key_of(i), strlen(key_of(i))), age);
}

static int has(const struct cache *c, int i)
{
	return access(entry_path(c, key_of(i), strlen(key_of(i))), F_OK) == 0;
}

START_TEST(removes_the_oldest)
{
	struct cache c = cache_in("c");

	for (int i = 0; i < CACHE_ENTRIES; i++)
		put_aged(&c, i, 1000000 - 10 * i);
	ck_assert_int_eq(count_entries(c.folder), CACHE_ENTRIES);
	ck_assert_int_eq(get_is(&c, key_of(0), "image"), 1); /* is now the last one used */
	for (int i = 0; i < 5; i++)
		put_aged(&c, CACHE_ENTRIES + i, 0);
	ck_assert_int_eq(count_entries(c.folder), CACHE_ENTRIES);
	ck_assert(has(&c, 0));
	for (int i = 1; i < CACHE_ENTRIES + 5; i++)
		ck_assert_msg(has(&c, i) == (i > 5), "entry %d", i);
	/* a folder is no entry, however old: it takes nobody's place */
	ck_assert_int_eq(mkdir(inside("c/rnea-0123456789abcdef"), 0700), 0);
	set_age(inside("c/rnea-0123456789abcdef"), 10000000);
	put_aged(&c, 3, 0);
	ck_assert(has(&c, 3) && !has(&c, 6));
	ck_assert_int_eq(rmdir(inside("c/rnea-0123456789abcdef")), 0);
	ck_assert_int_eq(unlink(entry_path(&c, key_of(3), 5)), 0);
	/* of an age below zero: not kept for ever */
	set_age(entry_path(&c, key_of(100), strlen(key_of(100))), -1000000);
	put_aged(&c, 1, 0);
	put_aged(&c, 2, 0);
	ck_assert(!has(&c, 100) && has(&c, 7));
}
END_TEST

/* Entries that are large, though not on the disk. */
START_TEST(removes_bytes)
{
	struct cache c = cache_in("c");

	for (int i = 0; i < 6; i++) {
		put_aged(&c, i, 1000 - i);
		if (i)
			ck_assert_int_eq(truncate(entry_path(&c, key_of(i), 5), CACHE_BYTES / 4), 0);
		set_age(entry_path(&c, key_of(i), 5), 1000 - i);
	}
	/* 1 to 5 have 5 quarters: with 0, which is older, 1 and 2 go, for the new one has some bytes as well */
	put_aged(&c, 7, 0);
	for (int i = 0; i < 6; i++)
		ck_assert_msg(has(&c, i) == (i > 2), "entry %d", i);
	ck_assert(has(&c, 7));
	ck_assert_int_eq(cache_put(&c, "key 8", 5, "", CACHE_BYTES, NULL), 0); /* more than all: not even looked at */
	ck_assert_int_eq(cache_put(&c, "key 8", SIZE_MAX, "", SIZE_MAX, NULL), 0);
	ck_assert_int_eq(cache_put(&c, "", 0, "", SIZE_MAX - 31, NULL), 0);
	ck_assert(has(&c, 3) && has(&c, 7));
}
END_TEST

/* Of killed writers; of one at work; of somebody else. */
START_TEST(removes_temporaries)
{
	static const struct {
		const char *name;
		long age;
		int stays;
	} files[] = {
		{"rnea-tmp-123-1700000000000000000-0", 4000, 0},
		{"rnea-tmp-124-1700000000000000000-0", 0, 1},
		{"rnea-tmp-125-1700000000000000000-0", 3000, 1},
		{"rnea-tmp-126-1700000000000000000-0", -1000, 1},
		{"rnea-tmp-127-1700000000000000000-0", -4000, 0},
		{"rnea-", 1000000, 1},
		{"rnea-0123456789abcde", 1000000, 1},
		{"rnea-0123456789ABCDEF", 1000000, 1},
		{"rnea-0123456789abcdef.c", 1000000, 1},
		{"tmp-123", 1000000, 1},
		{"thesis.tex", 1000000, 1},
	};
	struct cache c = cache_in("c");
	char name[128];

	put_aged(&c, 0, 0);
	for (size_t i = 0; i < sizeof files / sizeof *files; i++) {
		snprintf(name, sizeof name, "c/%s", files[i].name);
		entry_write(inside(name), "text", 4);
		if (files[i].age > 100000)
			ck_assert_int_eq(truncate(inside(name), CACHE_BYTES), 0);
		set_age(inside(name), files[i].age);
	}
	put_aged(&c, 1, 0);
	ck_assert(has(&c, 0) && has(&c, 1));
	for (size_t i = 0; i < sizeof files / sizeof *files; i++) {
		snprintf(name, sizeof name, "c/%s", files[i].name);
		ck_assert_msg((access(inside(name), F_OK) == 0) == files[i].stays, "%s", name);
	}
}
END_TEST

/* Catches a get that takes more than the entry is long: it is read once, in two pieces, whatever else is in the folder. */
START_TEST(reads_an_entry_once)
{
	enum { SIZE = 300 << 10, KEY = 60 << 10 };
	char *image = calloc(1, SIZE), *key = calloc(1, KEY), *data;
	struct cache c = cache_in("c");
	struct faults seen;
	size_t size;
	int found;

	for (int i = 0; i < CACHE_ENTRIES; i++)
		ck_assert_int_eq(put_text(&c, key_of(i), "image"), 1);
	memset(image, 'i', SIZE);
	memset(key, 'k', KEY);
	ck_assert_int_eq(cache_put(&c, key, KEY, image, SIZE, NULL), 1);
	faults_clear();
	found = cache_get(&c, key, KEY, &data, &size);
	seen = faults;
	ck_assert_int_eq(found, 1);
	ck_assert_int_eq(seen.calls[FAULT_READ], 2);
	ck_assert_int_eq(seen.calls[FAULT_OPEN], 1);
	ck_assert_int_eq(seen.calls[FAULT_MALLOC], 1);
	ck_assert_uint_eq(seen.allocated, KEY + SIZE + 1);
	ck_assert_uint_eq(size, SIZE);
	ck_assert_mem_eq(data, image, SIZE);
	free(data);
	free(image);
	free(key);
}
END_TEST

Suite *suite_cache_entry(void)
{
	Suite *s = suite_create("cache entry");
	TCase *t = tcase_create("cache entry");

	tcase_set_timeout(t, 120);
	tcase_add_checked_fixture(t, sandbox_make, sandbox_remove);
	tcase_add_test(t, keeps_images);
	tcase_add_test(t, compares_the_key);
	tcase_add_test(t, flipped_bits_are_misses);
	tcase_add_test(t, other_lengths_are_misses);
	tcase_add_test(t, damaged_sizes_take_no_memory);
	tcase_add_test(t, only_files_of_this_user_alone);
	tcase_add_test(t, removes_the_oldest);
	tcase_add_test(t, removes_bytes);
	tcase_add_test(t, removes_temporaries);
	tcase_add_test(t, reads_an_entry_once);
	suite_add_tcase(s, t);
	return s;
}
