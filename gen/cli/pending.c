#define _POSIX_C_SOURCE 200809L
#include "cli/pending.h"
#include "cli/pending_names.h"
#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

enum { PENDING_LIMIT = 68 }; /* more than a kernel has arrays */

/* Names for the handler, which can take no argument; changed only while the signals are blocked. */
static char *volatile names[PENDING_LIMIT];
static void (*volatile also)(void);

static const int SIGNALS[] = {SIGINT, SIGTERM, SIGHUP, SIGPIPE, SIGXCPU};
enum { SIGNAL_COUNT = sizeof SIGNALS / sizeof *SIGNALS };

/* Remove what is pending, then die of the signal as if there were no handler. */
static void handle(int number)
{
	for (int i = 0; i < PENDING_LIMIT; i++)
		if (names[i])
			unlink(names[i]);
	if (also)
		also();
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

void pending_also(void (*removes)(void))
{
	also = removes;
	install_handler();
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

static void free_names(struct pending *p)
{
	free(p->temporary);
	free(p->target);
	p->temporary = p->target = NULL;
}

/* Rename to its target, or remove. Till then the name stays with the handler. */
static int end_name(struct pending *p, int renames)
{
	sigset_t before = block_signals();
	int own = is_own(p), bad = own ? (renames ? rename(p->temporary, p->target) : unlink(p->temporary)) : -1, why = errno;

	replace_name(p->temporary, NULL);
	pthread_sigmask(SIG_SETMASK, &before, NULL);
	if (bad && renames && own)
		unlink(p->temporary);
	free_names(p);
	errno = why;
	return bad;
}

enum rneagen_code pending_fail(const char *path, struct rneagen_error *e)
{
	return error_set(e, RNEAGEN_WRITE, "%s: cannot be written: %s", path, strerror(errno));
}

/* Of a link, the message says where it leads. */
static enum rneagen_code fail_at(const char *path, const char *target, struct rneagen_error *e)
{
	int why = errno;

	if (!strcmp(path, target))
		return pending_fail(path, e);
	return error_set(e, RNEAGEN_WRITE, "%s, a link to %s: cannot be written: %s", path, target, strerror(why));
}

/* A stream to write, which closes fd; where there is none, fd is closed now. -1 is no file. */
static FILE *stream_of(int fd)
{
	FILE *f = fd < 0 ? NULL : fdopen(fd, "wb");

	if (!f && fd >= 0)
		close(fd);
	return f;
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
	if (!(f = stream_of(fd)))
		unlink(name);
	return f;
}

static void note_file(struct pending *p)
{
	struct stat st;

	if (!fstat(fileno(p->f), &st)) {
		p->device = st.st_dev;
		p->inode = st.st_ino;
	}
}

/* What takes the place of a file has its mode. */
static void take_mode(struct pending *p)
{
	struct stat st;

	if (!stat(p->target, &st) && S_ISREG(st.st_mode))
		fchmod(fileno(p->f), st.st_mode & 0777);
}

/* A file by p->temporary, made by `make`, which the handler knows of if `removes`. */
static enum rneagen_code open_temporary(struct pending *p, FILE *(*make)(char *), int removes, struct rneagen_error *e)
{
	sigset_t before;

	if (!p->temporary || !p->target) {
		free_names(p);
		return error_memory(e);
	}
	install_handler();
	before = block_signals();
	if (removes && !replace_name(NULL, p->temporary))
		error_set(e, RNEAGEN_LIMIT, "%s: more than %d files at once", p->path, PENDING_LIMIT);
	else if (!(p->f = make(p->temporary)))
		fail_at(p->path, p->target, e);
	if (e->code) {
		replace_name(p->temporary, NULL);
		free_names(p);
		*p = (struct pending){0};
	} else {
		note_file(p);
		take_mode(p);
	}
	pthread_sigmask(SIG_SETMASK, &before, NULL);
	return e->code;
}

/* Begin *p: the file of the name, through links. */
static enum rneagen_code begin(struct pending *p, const char *path, char target[PENDING_PATH], struct rneagen_error *e)
{
	int why = pending_target(path, target);

	*p = (struct pending){.path = path};
	errno = why;
	return why ? pending_fail(path, e) : RNEAGEN_OK;
}

enum rneagen_code pending_open(struct pending *p, const char *path, struct rneagen_error *e)
{
	char target[PENDING_PATH];
	int fd;

	if (begin(p, path, target, e))
		return e->code;
	if (!pending_is_in_place(path)) {
		p->target = strdup(target);
		p->temporary = pending_temporary_name(target);
		return open_temporary(p, create, 1, e);
	}
	fd = pending_number(target);
	/* another end of an open file: what is there stays, and what is written follows */
	p->f = fd < 0 ? fopen(path, "wb") : stream_of(dup(fd));
	return p->f ? RNEAGEN_OK : pending_fail(path, e);
}

/* A file that is written in place; a pipe may have no reader yet. */
static int may_write(const char *path)
{
	struct stat st;

	errno = !stat(path, &st) && S_ISDIR(st.st_mode) ? EISDIR : 0;
	return !errno && !access(path, W_OK);
}

enum rneagen_code pending_try(const char *path, struct rneagen_error *e)
{
	struct pending p;

	if (pending_is_in_place(path))
		return may_write(path) ? RNEAGEN_OK : pending_fail(path, e);
	if (!pending_open(&p, path, e))
		pending_drop(&p);
	return e->code;
}

/* In the place of what another run left. A link that stands there is not followed. */
static FILE *create_part(char *name)
{
	return stream_of(unlink(name) && errno != ENOENT ? -1 : open(name, O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666));
}

static FILE *take_part(char *name)
{
	return stream_of(open(name, O_WRONLY | O_NOFOLLOW | O_CLOEXEC));
}

static enum rneagen_code open_part(
	struct pending *p, const char *path, FILE *(*make)(char *), int stays, struct rneagen_error *e)
{
	char target[PENDING_PATH];

	if (begin(p, path, target, e))
		return e->code;
	p->stays = stays;
	p->target = strdup(target);
	p->temporary = pending_part_name(target);
	return open_temporary(p, make, !stays, e);
}

enum rneagen_code pending_open_part(struct pending *p, const char *path, int keeps, struct rneagen_error *e)
{
	return open_part(p, path, keeps ? take_part : create_part, keeps, e);
}

enum rneagen_code pending_watch_part(struct pending *p, const char *path, struct rneagen_error *e)
{
	return open_part(p, path, take_part, 0, e);
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
	if (!p->temporary || !end_name(p, 1))
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
		end_name(p, 0);
	free_names(p);
}
