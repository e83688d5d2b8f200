/* RTLD_NOLOAD, RTLD_NODELETE and dlinfo */
#define _GNU_SOURCE
#include "core/library.h"
#include <dlfcn.h>
#include <glob.h>
#include <link.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

static void remember(struct library *l, const char *name, const char *why)
{
	size_t used = strlen(l->tried);

	snprintf(l->tried + used, sizeof l->tried - used, "%s%s%s%s%s", used ? "; " : "", name, *why ? " (" : "", why,
		*why ? ")" : "");
}

static int take(struct library *l, const char *name)
{
	snprintf(l->path, sizeof l->path, "%s", name);
	return 1;
}

/* Keep a handle of dlopen; where the library is only to be found, the name of its file instead. */
static int take_handle(struct library *l, const char *name, void *handle)
{
	struct link_map *map;

	if (!handle)
		return 0;
	if (!l->only_find) {
		l->handle = handle;
		return take(l, name);
	}
	/* one whose file has no name is found nevertheless: the search must not go on to another */
	take(l, dlinfo(handle, RTLD_DI_LINKMAP, &map) == 0 && *map->l_name ? map->l_name : name);
	dlclose(handle);
	return 1;
}

static int is_file(const char *path)
{
	struct stat s;

	return stat(path, &s) == 0 && S_ISREG(s.st_mode) && access(path, R_OK) == 0;
}

int library_try(struct library *l, const char *name)
{
	int is_path = strchr(name, '/') != NULL;
	const char *why;

	if (*l->path)
		return 1;
	if (l->only_find && is_path)
		return is_file(name) && take(l, name);
	if (take_handle(l, name, dlopen(name, RTLD_NOW | RTLD_LOCAL | RTLD_NODELETE)))
		return 1;
	why = dlerror();
	/* a file that is there and does not load is worth its reason; the rest are simply not there */
	remember(l, name, why && is_path && access(name, F_OK) == 0 ? why : "");
	return 0;
}

int library_try_loaded(struct library *l, const char *soname)
{
	return *l->path || take_handle(l, soname, dlopen(soname, RTLD_NOW | RTLD_LOCAL | RTLD_NODELETE | RTLD_NOLOAD));
}

int library_try_pattern(struct library *l, const char *pattern)
{
	glob_t found;

	if (*l->path)
		return 1;
	if (glob(pattern, 0, NULL, &found) != 0) {
		remember(l, pattern, "");
		return 0;
	}
	for (size_t i = found.gl_pathc; i-- > 0 && !*l->path;)
		library_try(l, found.gl_pathv[i]);
	globfree(&found);
	return *l->path != '\0';
}

int library_identity(const struct library *l, char *text, size_t size)
{
	/* a path that had to be cut is of no file */
	char *path = strlen(l->path) + 1 < sizeof l->path ? realpath(l->path, NULL) : NULL;
	struct stat s;
	int length = -1;

	if (path && stat(path, &s) == 0)
		length = snprintf(text, size, "%s %lld %lld%09ld %llu", path, (long long)s.st_size,
			(long long)s.st_mtim.tv_sec, s.st_mtim.tv_nsec, (unsigned long long)s.st_ino);
	free(path);
	if (length >= 0 && (size_t)length < size)
		return 1;
	if (size)
		text[0] = '\0';
	return 0;
}

int library_symbol(const struct library *l, const char *symbol, void *slot)
{
	void *address = dlsym(l->handle, symbol);

	/* ISO C has no cast from an object pointer to a function pointer */
	memcpy(slot, &address, sizeof address);
	return address != NULL;
}

void library_close(struct library *l)
{
	if (l->handle)
		dlclose(l->handle);
	l->handle = NULL;
}
