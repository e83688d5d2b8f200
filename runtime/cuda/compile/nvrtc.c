#include "cuda/compile/nvrtc.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* Newest first. */
static const char *const sonames[] = {
	"libnvrtc.so.14", "libnvrtc.so.13", "libnvrtc.so.12", "libnvrtc.so.11.2", "libnvrtc.so"};

enum { SONAME_COUNT = sizeof sonames / sizeof *sonames };

static const char *variable(const char *name)
{
	const char *value = getenv(name);

	return value && *value ? value : NULL;
}

static void try_directory(struct library *l, const char *prefix, const char *below)
{
	char pattern[1024];

	if (!prefix || snprintf(pattern, sizeof pattern, "%s%s/libnvrtc.so*", prefix, below) >= (int)sizeof pattern)
		return;
	library_try_pattern(l, pattern);
}

/* Wheels put it in nvidia/cu13/lib or nvidia/cuda_nvrtc/lib below site-packages (dist-packages on Debian). */
static void try_python(struct library *l, const char *prefix)
{
	try_directory(l, prefix, "/lib*/python3*/*-packages/nvidia/cu*/lib");
}

/* The environment that the first python3 on PATH belongs to: DIR of DIR/bin/python3. */
static void try_python_on_path(struct library *l)
{
	const char *path = variable("PATH");
	char program[1024];

	for (size_t n; path; path = path[n] ? path + n + 1 : NULL) {
		n = strcspn(path, ":");
		if (snprintf(program, sizeof program, "%.*s/python3", (int)n, path) >= (int)sizeof program ||
			access(program, X_OK) != 0 || n < 4 || strncmp(path + n - 4, "/bin", 4) != 0)
			continue;
		program[n - 4] = '\0';
		try_python(l, program);
		return;
	}
}

static void try_wheels(struct library *l)
{
	const char *home = variable("HOME");
	char local[1024];

	try_python(l, variable("VIRTUAL_ENV"));
	try_python(l, variable("CONDA_PREFIX"));
	try_python_on_path(l);
	if (home && snprintf(local, sizeof local, "%s/.local", home) < (int)sizeof local)
		try_python(l, local);
	try_python(l, "/usr/local");
	try_python(l, "/usr");
}

/* The search, both for opening and for the identity. */
static enum rnea_code find_library(struct library *l, struct rnea_error *e)
{
	const char *chosen = variable("RNEA_NVRTC");

	if (chosen) {
		if (library_try(l, chosen))
			return RNEA_OK;
		return rnea_error_set(e, RNEA_NO_COMPILER, "no NVRTC; tried %s (from RNEA_NVRTC)", l->tried);
	}
	for (int i = 0; i < SONAME_COUNT; i++)
		library_try_loaded(l, sonames[i]);
	try_directory(l, variable("CUDA_HOME"), "/lib64");
	try_directory(l, variable("CUDA_PATH"), "/lib64");
	try_directory(l, "/usr/local/cuda", "/lib64");
	try_directory(l, "/usr/local/cuda-*", "/lib64");
	try_wheels(l);
	for (int i = 0; i < SONAME_COUNT; i++)
		library_try(l, sonames[i]);
	if (*l->path)
		return RNEA_OK;
	return rnea_error_set(e, RNEA_NO_COMPILER, "no NVRTC; tried %s (RNEA_NVRTC names another)", l->tried);
}

int nvrtc_identity(char *text, size_t size)
{
	struct library l = {.only_find = 1};
	struct rnea_error e = {0};

	/* without a library there is no path either */
	find_library(&l, &e);
	return library_identity(&l, text, size);
}

enum rnea_code nvrtc_open(struct nvrtc *n, struct rnea_error *e)
{
	const char *missing = NULL;
	int status;

	memset(n, 0, sizeof *n);
	if (find_library(&n->library, e))
		return e->code;
#define NVRTC_LOAD(result, field, symbol, parameters)                                                                  \
	if (!library_symbol(&n->library, symbol, &n->api.field))                                                       \
		missing = symbol;
	NVRTC_FUNCTIONS(NVRTC_LOAD)
#undef NVRTC_LOAD
	if (missing)
		return rnea_error_set(e, RNEA_COMPILER,
			"NVRTC (%s): it has no function %s; NVRTC 11.2 or later is needed", n->library.path, missing);
	if ((status = n->api.version(&n->major, &n->minor)) != 0)
		return rnea_error_set(e, RNEA_COMPILER, "NVRTC (%s): nvrtcVersion: %s", n->library.path,
			n->api.get_error_string(status));
	return RNEA_OK;
}

void nvrtc_close(struct nvrtc *n)
{
	library_close(&n->library);
}
