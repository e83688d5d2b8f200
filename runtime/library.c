/* RTLD_NOLOAD and RTLD_NODELETE */
#define _GNU_SOURCE
#include "library.h"
#include <dlfcn.h>
#include <glob.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

static void remember(struct library *l, const char *name, const char *why)
{
	size_t used = strlen(l->tried);

	snprintf(l->tried + used, sizeof l->tried - used, "%s%s%s%s%s", used ? "; " : "", name, *why ? " (" : "", why,
		*why ? ")" : "");
}

static int take(struct library *l, const char *name, void *handle)
{
	if (!handle)
		return 0;
	l->handle = handle;
	snprintf(l->path, sizeof l->path, "%s", name);
	return 1;
}

int library_try(struct library *l, const char *name)
{
	const char *why;

	if (l->handle || take(l, name, dlopen(name, RTLD_NOW | RTLD_LOCAL | RTLD_NODELETE)))
		return 1;
	why = dlerror();
	/* a file that is there and does not load is worth its reason; the rest are simply not there */
	remember(l, name, why && strchr(name, '/') && access(name, F_OK) == 0 ? why : "");
	return 0;
}

int library_try_loaded(struct library *l, const char *soname)
{
	return l->handle || take(l, soname, dlopen(soname, RTLD_NOW | RTLD_LOCAL | RTLD_NODELETE | RTLD_NOLOAD));
}

int library_try_pattern(struct library *l, const char *pattern)
{
	glob_t found;

	if (l->handle)
		return 1;
	if (glob(pattern, 0, NULL, &found) != 0) {
		remember(l, pattern, "");
		return 0;
	}
	for (size_t i = found.gl_pathc; i-- > 0 && !l->handle;)
		library_try(l, found.gl_pathv[i]);
	globfree(&found);
	return l->handle != NULL;
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
