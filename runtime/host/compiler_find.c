/* realpath and confstr */
#define _GNU_SOURCE
#include "host/compiler.h"
#include <errno.h>
#include <limits.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/utsname.h>
#include <unistd.h>

/* ---- where it is ---- */

/* 0 if this user may run the file at `path`, else the errno that says why not. */
static int cannot_run(const char *path)
{
	struct stat about;

	if (stat(path, &about) != 0)
		return errno;
	if (S_ISDIR(about.st_mode))
		return EISDIR;
	return access(path, X_OK) == 0 ? 0 : errno;
}

/* The first program called `name` in the folders of `search`; an empty one is the working directory. */
static int find_along(struct compiler *c, const char *name, const char *search)
{
	for (const char *folder = search, *end;; folder = end + 1) {
		int n = (int)strcspn(folder, ":"), length;

		end = folder + n;
		length = snprintf(c->path, sizeof c->path, "%.*s/%s", n ? n : 1, n ? folder : ".", name);
		if (length > 0 && (size_t)length < sizeof c->path && !cannot_run(c->path))
			return 1;
		if (!*end)
			return 0;
	}
}

static enum rnea_code find_named(struct compiler *c, const char *name, const char *search, struct rnea_error *e)
{
	int length, why;

	if (!strchr(name, '/'))
		return find_along(c, name, search) ? RNEA_OK
						   : rnea_error_set(e, RNEA_NO_COMPILER,
							     "no C compiler: RNEA_CC names \"%s\", which is not a "
							     "program in PATH (%s)",
							     name, search);
	length = snprintf(c->path, sizeof c->path, "%s", name);
	why = length < 0 || (size_t)length >= sizeof c->path ? ENAMETOOLONG : cannot_run(name);
	return why ? rnea_error_set(e, RNEA_NO_COMPILER, "no C compiler: %s (from RNEA_CC): %s", name, strerror(why))
		   : RNEA_OK;
}

const char *compiler_path(char standard[COMPILER_PATH_SIZE])
{
	const char *path = getenv("PATH");
	size_t length = path ? 0 : confstr(_CS_PATH, standard, COMPILER_PATH_SIZE);

	if (!path && (length == 0 || length > COMPILER_PATH_SIZE))
		snprintf(standard, COMPILER_PATH_SIZE, "/bin:/usr/bin");
	return path ? path : standard;
}

static enum rnea_code find(struct compiler *c, struct rnea_error *e)
{
	static const char *const names[] = {"cc", "gcc", "clang"};
	char standard[COMPILER_PATH_SIZE];
	const char *chosen = getenv("RNEA_CC"), *search = compiler_path(standard);

	if (chosen && *chosen)
		return find_named(c, chosen, search, e);
	for (size_t i = 0; i < sizeof names / sizeof *names; i++)
		if (find_along(c, names[i], search))
			return RNEA_OK;
	return rnea_error_set(
		e, RNEA_NO_COMPILER, "no C compiler: tried cc, gcc, clang in PATH (%s); RNEA_CC names another", search);
}

/* ---- what it is ---- */

struct identity {
	char *text;
	size_t used, size;
};

static int append(struct identity *to, const char *text, size_t length)
{
	if (length >= to->size - to->used)
		return 0;
	memcpy(to->text + to->used, text, length);
	to->text[to->used += length] = '\0';
	return 1;
}

/* The program: another one, or a newer one, has another path, inode, size or time. A wrapper such as ccache is taken
   for the compiler itself. */
static int identify_program(const char *path, struct identity *to)
{
	char line[PATH_MAX + 256], resolved[PATH_MAX];
	struct stat about;
	int length;

	if (!realpath(path, resolved) || stat(resolved, &about) != 0)
		return 0;
	length = snprintf(line, sizeof line, "%s\n%ju %ju %jd %jd.%09ld %jd.%09ld\n", resolved, (uintmax_t)about.st_dev,
		(uintmax_t)about.st_ino, (intmax_t)about.st_size, (intmax_t)about.st_mtim.tv_sec, about.st_mtim.tv_nsec,
		(intmax_t)about.st_ctim.tv_sec, about.st_ctim.tv_nsec);
	return length > 0 && append(to, line, (size_t)length);
}

/* Whether a line of /proc/cpuinfo says what the processor can do, on x86, ARM, RISC-V, POWER and others. */
static int is_about_instructions(const char *line)
{
	static const char *const keys[] = {"vendor_id", "cpu family", "model", "stepping", "flags", "Features",
		"CPU implementer", "CPU architecture", "CPU variant", "CPU part", "CPU revision", "isa", "uarch",
		"cpu\t", "features", "ASEs implemented"};

	for (size_t i = 0; i < sizeof keys / sizeof *keys; i++)
		if (strncmp(line, keys[i], strlen(keys[i])) == 0)
			return 1;
	return 0;
}

/* The processor, for which -march=native compiles: what is said of the first. */
static int identify_processor(struct identity *to)
{
	FILE *f = fopen("/proc/cpuinfo", "re");
	struct utsname about;
	char line[4096];
	int known = 0, fits = 1;

	if (!f)
		return 0;
	while (fits && fgets(line, sizeof line, f) && (line[0] != '\n' || !known))
		if (is_about_instructions(line)) {
			fits = append(to, line, strlen(line));
			known = 1;
		}
	fclose(f);
	return known && fits && uname(&about) == 0 && append(to, about.machine, strlen(about.machine));
}

enum rnea_code compiler_find(struct compiler *c, struct rnea_error *e)
{
	struct identity to = {c->identity, 0, sizeof c->identity};

	memset(c, 0, sizeof *c);
	if (find(c, e))
		return e->code;
	/* what is not known for sure is not kept for later */
	if (!identify_program(c->path, &to) || !identify_processor(&to))
		c->identity[0] = '\0';
	return RNEA_OK;
}
