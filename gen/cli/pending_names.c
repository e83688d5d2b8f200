#define _POSIX_C_SOURCE 200809L
#include "cli/pending_names.h"
#include "base/text.h"
#include "cli/pending.h"
#include <errno.h>
#include <limits.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

enum {
	LINKS = 40, /* that lead to one another, as many as Linux follows */
	KEPT = 100  /* bytes of a file's name in its temporary one */
};

int pending_number(const char *path)
{
	static const char *const folders[] = {"/dev/fd/", "/proc/self/fd/"};
	char *end;
	long fd = -1;

	if (!strcmp(path, "/dev/stdout") || !strcmp(path, "/dev/stderr"))
		return !strcmp(path, "/dev/stdout") ? STDOUT_FILENO : STDERR_FILENO;
	for (size_t i = 0; i < sizeof folders / sizeof *folders; i++)
		if (!strncmp(path, folders[i], strlen(folders[i]))) {
			fd = strtol(path + strlen(folders[i]), &end, 10);
			return *end || end == path + strlen(folders[i]) || fd < 0 || fd > INT_MAX ? -1 : (int)fd;
		}
	return -1;
}

int pending_target(const char *path, char target[PENDING_PATH])
{
	char text[PENDING_PATH];
	const char *slash;
	size_t folder, length = strlen(path);
	ssize_t n;

	if (length >= PENDING_PATH)
		return ENAMETOOLONG;
	memcpy(target, path, length + 1);
	for (int i = 0; i < LINKS; i++) {
		/* what is no link, or not there, or cannot be seen is the file: opening it tells more */
		if (pending_number(target) >= 0 || (n = readlink(target, text, sizeof text)) < 0)
			return 0;
		slash = strrchr(target, '/');
		folder = *text == '/' || !slash ? 0 : (size_t)(slash - target) + 1;
		if (folder + (size_t)n >= PENDING_PATH)
			return ENAMETOOLONG;
		memcpy(target + folder, text, (size_t)n);
		target[folder + (size_t)n] = '\0';
	}
	return ELOOP;
}

static char *join(const char *path, size_t length, const char *suffix)
{
	size_t more = strlen(suffix) + 1;
	char *name = malloc(length + more);

	if (name) {
		memcpy(name, path, length);
		memcpy(name + length, suffix, more);
	}
	return name;
}

/* Short, for a name may be as long as the folder allows. */
char *pending_temporary_name(const char *path)
{
	const char *slash = strrchr(path, '/'), *name = slash ? slash + 1 : path;
	size_t kept = strlen(name);

	if (kept > KEPT)
		for (kept = KEPT; kept && text_is_inside(name[kept]); kept--) /* characters of UTF-8 stay whole */
			;
	return join(path, (size_t)(name - path) + kept, ".XXXXXX");
}

char *pending_part_name(const char *path)
{
	return join(path, strlen(path), ".part");
}

int pending_is_in_place(const char *path)
{
	char target[PENDING_PATH];
	struct stat st;

	return (!pending_target(path, target) && pending_number(target) >= 0) || (!stat(path, &st) && !S_ISREG(st.st_mode));
}
