#define _POSIX_C_SOURCE 200809L
#include "support/read.h"
#include <check.h>
#include <dirent.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

char *read_file(const char *path, size_t *length)
{
	FILE *f = fopen(path, "rb");
	char *s = NULL;
	long size;

	if (f && !fseek(f, 0, SEEK_END) && (size = ftell(f)) >= 0 && !fseek(f, 0, SEEK_SET)) {
		s = calloc((size_t)size + 1, 1);
		if (s && fread(s, 1, (size_t)size, f) != (size_t)size) {
			free(s);
			s = NULL;
		}
		*length = (size_t)size;
	}
	if (f)
		fclose(f);
	return s;
}

char *read_text(const char *directory, const char *name, size_t *length)
{
	char path[1024], *text;

	snprintf(path, sizeof path, "%s/%s", directory, name);
	text = read_file(path, length);
	ck_assert_msg(text != NULL, "%s cannot be read", path);
	return text;
}

char *robot_text(const char *name)
{
	char file[256];
	size_t length;

	snprintf(file, sizeof file, "%s.urdf", name);
	return read_text(TEST_DIR "/robots", file, &length);
}

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
	size_t length;
	char *text = read_text(directory, name, &length);

	read_memory(r, text, length, name);
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

static int is_urdf(const struct dirent *entry)
{
	const char *dot = strrchr(entry->d_name, '.');

	return dot && !strcmp(dot, ".urdf");
}

int for_each_urdf(const char *folder, void (*f)(const char *path, const char *name, void *context), void *context)
{
	struct dirent **entries;
	int n = scandir(folder, &entries, is_urdf, alphasort);
	char path[4096];

	for (int i = 0; i < n; i++) {
		snprintf(path, sizeof path, "%s/%s", folder, entries[i]->d_name);
		f(path, entries[i]->d_name, context);
		free(entries[i]);
	}
	if (n >= 0)
		free(entries);
	return n;
}
