#define _POSIX_C_SOURCE 200809L
#include "cli/pending.h"
#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

enum { PENDING_LIMIT = 68 }; /* more than a kernel has arrays */

/* Names for the handler, which can take no argument; changed only while the signals are blocked. */
static char *volatile names[PENDING_LIMIT];

static const int SIGNALS[] = {SIGINT, SIGTERM, SIGHUP};
enum { SIGNAL_COUNT = sizeof SIGNALS / sizeof *SIGNALS };

/* Remove what is pending, then die of the signal as if there were no handler. */
static void handle(int number)
{
	for (int i = 0; i < PENDING_LIMIT; i++)
		if (names[i])
			unlink(names[i]);
	signal(number, SIG_DFL);
	raise(number);
}

static sigset_t block_signals(void)
{
	sigset_t set, before;

	sigemptyset(&set);
	for (int i = 0; i < SIGNAL_COUNT; i++)
		sigaddset(&set, SIGNALS[i]);
	pthread_sigmask(SIG_BLOCK, &set, &before);
	return before;
}

/* A signal that the caller of the program ignores, as nohup does, stays ignored. */
static void install_handler(void)
{
	struct sigaction action = {.sa_handler = handle}, before;

	sigemptyset(&action.sa_mask);
	for (int i = 0; i < SIGNAL_COUNT; i++)
		if (!sigaction(SIGNALS[i], NULL, &before) && before.sa_handler == SIG_DFL)
			sigaction(SIGNALS[i], &action, NULL);
}

static int replace_name(const char *old, char *name)
{
	for (int i = 0; i < PENDING_LIMIT; i++) {
		if (names[i] == old) {
			names[i] = name;
			return 1;
		}
	}
	return 0;
}

/* Is the file of the temporary name still the one that was opened? Another run may have replaced what it takes for remains. */
static int is_own(const struct pending *p)
{
	struct stat st;

	if (stat(p->temporary, &st))
		return 0;
	if (st.st_dev == p->device && st.st_ino == p->inode)
		return 1;
	errno = ESTALE;
	return 0;
}

/* Rename to `path`, or remove if that is NULL. Till then the name stays with the handler. */
static int end_name(struct pending *p, const char *path)
{
	sigset_t before = block_signals();
	int own = is_own(p), bad = own ? (path ? rename(p->temporary, path) : unlink(p->temporary)) : -1, why = errno;

	replace_name(p->temporary, NULL);
	pthread_sigmask(SIG_SETMASK, &before, NULL);
	if (bad && path && own)
		unlink(p->temporary);
	free(p->temporary);
	p->temporary = NULL;
	errno = why;
	return bad;
}

enum rneagen_code pending_fail(const char *path, struct rneagen_error *e)
{
	return error_set(e, RNEAGEN_WRITE, "%s: cannot be written: %s", path, strerror(errno));
}

/* mkstemp, with the mode of a file made by fopen. */
static FILE *create(char *name)
{
	int fd = mkstemp(name);
	mode_t mask = umask(0);
	FILE *f;

	umask(mask);
	if (fd < 0)
		return NULL;
	fchmod(fd, 0666 & ~mask);
	f = fdopen(fd, "wb");
	if (!f) {
		close(fd);
		unlink(name);
	}
	return f;
}

static char *join(const char *path, const char *suffix)
{
	size_t length = strlen(path), more = strlen(suffix) + 1;
	char *name = malloc(length + more);

	if (name) {
		memcpy(name, path, length);
		memcpy(name + length, suffix, more);
	}
	return name;
}

static void note_file(struct pending *p)
{
	struct stat st;

	if (!fstat(fileno(p->f), &st)) {
		p->device = st.st_dev;
		p->inode = st.st_ino;
	}
}

/* A file by p->temporary, made by `make`, which the handler knows of if `removes`. */
static enum rneagen_code open_temporary(struct pending *p, FILE *(*make)(char *), int removes, struct rneagen_error *e)
{
	sigset_t before;

	if (!p->temporary)
		return error_memory(e);
	install_handler();
	before = block_signals();
	if (removes && !replace_name(NULL, p->temporary))
		error_set(e, RNEAGEN_LIMIT, "%s: more than %d files at once", p->path, PENDING_LIMIT);
	else if (!(p->f = make(p->temporary)))
		pending_fail(p->path, e);
	if (e->code) {
		replace_name(p->temporary, NULL);
		free(p->temporary);
		*p = (struct pending){0};
	} else {
		note_file(p);
	}
	pthread_sigmask(SIG_SETMASK, &before, NULL);
	return e->code;
}

/* The number of the open file that a name of /dev or /proc stands for; -1: it is another name. */
static int find_open(const char *path)
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

/* Another end of an open file: what is there stays, and what is written follows. */
static FILE *open_again(int fd)
{
	int again = dup(fd);
	FILE *f = again < 0 ? NULL : fdopen(again, "wb");

	if (!f && again >= 0)
		close(again);
	return f;
}

int pending_is_in_place(const char *path)
{
	struct stat st;

	return find_open(path) >= 0 || (!stat(path, &st) && !S_ISREG(st.st_mode));
}

enum rneagen_code pending_open(struct pending *p, const char *path, struct rneagen_error *e)
{
	int fd = find_open(path);

	*p = (struct pending){.path = path};
	if (!pending_is_in_place(path)) {
		p->temporary = join(path, ".XXXXXX");
		return open_temporary(p, create, 1, e);
	}
	p->f = fd < 0 ? fopen(path, "wb") : open_again(fd);
	return p->f ? RNEAGEN_OK : pending_fail(path, e);
}

/* In the place of what another run left. A link that stands there is not followed. */
static FILE *create_part(char *name)
{
	int fd = unlink(name) && errno != ENOENT ? -1 : open(name, O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
	FILE *f = fd < 0 ? NULL : fdopen(fd, "wb");

	if (!f && fd >= 0)
		close(fd);
	return f;
}

static FILE *take_part(char *name)
{
	int fd = open(name, O_WRONLY | O_NOFOLLOW | O_CLOEXEC);
	FILE *f = fd < 0 ? NULL : fdopen(fd, "wb");

	if (!f && fd >= 0)
		close(fd);
	return f;
}

enum rneagen_code pending_open_part(struct pending *p, const char *path, int keeps, struct rneagen_error *e)
{
	*p = (struct pending){.path = path, .temporary = join(path, ".part"), .stays = keeps};
	return open_temporary(p, keeps ? take_part : create_part, !keeps, e);
}

enum rneagen_code pending_watch_part(struct pending *p, const char *path, struct rneagen_error *e)
{
	*p = (struct pending){.path = path, .temporary = join(path, ".part")};
	return open_temporary(p, take_part, 1, e);
}

void pending_keep(struct pending *p)
{
	sigset_t before = block_signals();

	if (p->temporary)
		replace_name(p->temporary, NULL);
	pthread_sigmask(SIG_SETMASK, &before, NULL);
	p->stays = 1;
}

void pending_forget(struct pending *p)
{
	pending_keep(p);
	pending_drop(p);
}

enum rneagen_code pending_close(struct pending *p, struct rneagen_error *e)
{
	int bad = ferror(p->f);

	bad |= fclose(p->f);
	p->f = NULL;
	if (!bad)
		return RNEAGEN_OK;
	pending_fail(p->path, e);
	pending_drop(p);
	return e->code;
}

enum rneagen_code pending_publish(struct pending *p, struct rneagen_error *e)
{
	if (!p->temporary || !end_name(p, p->path))
		return RNEAGEN_OK;
	if (errno == ESTALE)
		return error_set(e, RNEAGEN_WRITE, "%s: another run has begun to write it", p->path);
	return pending_fail(p->path, e);
}

void pending_drop(struct pending *p)
{
	if (p->f)
		fclose(p->f);
	p->f = NULL;
	if (p->temporary && !p->stays)
		end_name(p, NULL);
	free(p->temporary);
	p->temporary = NULL;
}
