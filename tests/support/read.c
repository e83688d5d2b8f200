#define _POSIX_C_SOURCE 200809L
#include "support/read.h"
#include <check.h>
#include <dirent.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

void read_memory(struct read *r, const char *xml, size_t length, const char *file)
{
	char *copy = malloc(length ? length : 1); /* exactly as long, so that a sanitizer sees reads beyond the end */

	ck_assert_ptr_nonnull(copy);
	memcpy(copy, xml, length);
	*r = (struct read){0};
	arena_init(&r->arena, NULL);
	robot_read(&r->robot, copy, length, file, &r->arena, &r->error);
	free(copy);
}

void read_robot(struct read *r, const char *directory, const char *name)
{
	char path[1024];
	char *text = NULL;
	long size;
	FILE *f;

	snprintf(path, sizeof path, "%s/%s", directory, name);
	f = fopen(path, "rb");
	ck_assert_msg(f != NULL, "cannot open %s", path);
	ck_assert_int_eq(fseek(f, 0, SEEK_END), 0);
	size = ftell(f);
	ck_assert_int_ge(size, 0);
	rewind(f);
	text = malloc((size_t)size + 1);
	ck_assert_ptr_nonnull(text);
	ck_assert_uint_eq(fread(text, 1, (size_t)size, f), (size_t)size);
	fclose(f);
	read_memory(r, text, (size_t)size, name);
	free(text);
}

void read_free(struct read *r)
{
	arena_free(&r->arena);
}

static int compare(const void *a, const void *b)
{
	return strcmp(*(char *const *)a, *(char *const *)b);
}

char **names_list(const char *directory, int *count)
{
	enum { MOST = 1000 };
	char **names = calloc(MOST + 1, sizeof *names);
	DIR *d = opendir(directory);
	const struct dirent *entry;
	int n = 0;

	ck_assert_ptr_nonnull(names);
	ck_assert_msg(d != NULL, "cannot open the directory %s", directory);
	while ((entry = readdir(d)) && n < MOST) {
		const char *end = strrchr(entry->d_name, '.');

		if (end && !strcmp(end, ".urdf"))
			names[n++] = strdup(entry->d_name);
	}
	closedir(d);
	qsort(names, (size_t)n, sizeof *names, compare);
	*count = n;
	return names;
}

void names_free(char **names)
{
	for (char **n = names; *n; n++)
		free(*n);
	free(names);
}
