/* memfd_create */
#define _GNU_SOURCE
#include "host/object.h"
#include "core/scratch.h"
#include <dlfcn.h>
#include <fcntl.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

static void *open_object(const char *path, struct rnea_error *e)
{
	void *handle = dlopen(path, RTLD_NOW | RTLD_LOCAL);
	const char *why = handle ? NULL : dlerror();

	if (!handle)
		rnea_error_set(e, RNEA_COMPILER, "the compiled text cannot be loaded: %s", why ? why : "dlopen failed");
	return handle;
}

/* A path of the open file. The loader takes a path that it has seen for the object that it loaded from there, though
   the descriptor is another file's by now: so the path spells the file's number, one bit for each "./" or ".//". */
static int unique_path(int fd, char *path, size_t size)
{
	struct stat about;
	size_t used;

	if (fstat(fd, &about) != 0)
		return 0;
	used = (size_t)snprintf(path, size, "/proc/self/fd/");
	for (uintmax_t left = (uintmax_t)about.st_ino; left; left >>= 1)
		used += (size_t)snprintf(path + used, size - used, left & 1 ? ".//" : "./");
	snprintf(path + used, size - used, "%d", fd);
	return access(path, F_OK) == 0;
}

/* From memory alone; NULL, and no error, where the system does not have that. */
static void *load_memory(const char *data, size_t size, const char *name, struct rnea_error *e)
{
	char path[256], label[240];
	void *handle = NULL;
	int fd;

	snprintf(label, sizeof label, "rnea-%.200s.so", name);
	if ((fd = memfd_create(label, MFD_CLOEXEC)) < 0)
		return NULL;
	if (scratch_fill(fd, data, size) == 0 && unique_path(fd, path, sizeof path))
		handle = open_object(path, e);
	close(fd);
	return handle;
}

/* From a file with a name of its own, which is gone again when it is loaded. */
static void *load_file(const char *data, size_t size, struct rnea_error *e)
{
	struct scratch s;
	char path[1100];
	void *handle = NULL;
	int why = scratch_make(&s);

	snprintf(path, sizeof path, "%s/text.so", s.folder);
	if (!why)
		why = scratch_write(path, data, size);
	if (!why)
		handle = open_object(path, e);
	else
		rnea_error_set(e, RNEA_COMPILER,
			"the compiled text cannot be loaded: no file for it in TMPDIR or /tmp: %s", strerror(why));
	scratch_remove(&s);
	return handle;
}

enum rnea_code object_load(const char *data, size_t size, const char *name, void **handle, struct rnea_error *e)
{
	*handle = load_memory(data, size, name, e);
	if (!*handle && !e->code)
		*handle = load_file(data, size, e);
	return e->code;
}
