/* openat, futimens, flock */
#define _DEFAULT_SOURCE
#define _POSIX_C_SOURCE 200809L
#include "cache/cache.h"
#include "cache/cache_prune.h"
#include "core/scratch.h"
#include <errno.h>
#include <fcntl.h>
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

/* What an entry begins with; the key and the image follow. In the machine's own order of bytes, so that another order
   is another magic. */
struct header {
	uint64_t magic, key_size, data_size, checksum;
};

/* To be changed with the format. */
static const uint64_t magic = UINT64_C(0x31306568636e7201);

/* FNV-1a: h = (h ^ byte) prime. It need not withstand anybody: a key is compared whole, a folder or file that somebody
   else could write to is not used, and the checksum is against damage, of which every single byte changes it. */
static const uint64_t hash_start = UINT64_C(0xcbf29ce484222325);

static uint64_t hash_add(uint64_t h, const void *data, size_t size)
{
	const unsigned char *byte = data;

	for (size_t i = 0; i < size; i++)
		h = (h ^ byte[i]) * UINT64_C(0x100000001b3);
	return h;
}

/* ---- what is wrong ---- */

/* In place of an errno: the folder is another user's, or others can write to it. */
enum { NOT_PRIVATE = -1 };

/* Say what is wrong with the folder, or with the entry `name` in it; 0. */
static int refuse(struct cache_why *why, const char *folder, const char *name, int error)
{
	const char *what = error == NOT_PRIVATE ? "it is not this user's alone, and what lies there is run" : strerror(error);

	if (why)
		snprintf(why->text, sizeof why->text, "%s%s%s: %s", folder, name ? "/" : "", name ? name : "", what);
	return 0;
}

/* ---- the folder ---- */

/* Of this user, and nobody else can write to it. */
static int is_private(const struct stat *s)
{
	return s->st_uid == geteuid() && (s->st_mode & (S_IWGRP | S_IWOTH)) == 0;
}

static void set_folder(struct cache *c, const char *folder, const char *below)
{
	char here[sizeof c->folder] = "";
	int length;

	/* a relative name means the same after chdir */
	if (folder[0] != '/' && !getcwd(here, sizeof here))
		return;
	length = snprintf(c->folder, sizeof c->folder, "%s%s%s%s", here, *here ? "/" : "", folder, below);
	if (length < 0 || (size_t)length >= sizeof c->folder)
		c->folder[0] = '\0';
}

/* With another user's HOME, as sudo may leave it, the folder would be one that its owner cannot use; and a HOME that is
   not there is not to be made. */
static void set_folder_home(struct cache *c)
{
	const char *home = getenv("HOME");
	struct stat s;

	if (home && home[0] == '/' && stat(home, &s) == 0 && s.st_uid == geteuid())
		set_folder(c, home, "/.cache/rnea");
}

void cache_open(struct cache *c, const char *folder)
{
	const char *xdg = getenv("XDG_CACHE_HOME");

	memset(c, 0, sizeof *c);
	if (!folder)
		folder = getenv("RNEA_CACHE");
	if (folder) {
		if (*folder)
			set_folder(c, folder, "");
		return;
	}
	/* the XDG base directory specification: a relative name is to be ignored */
	if (xdg && xdg[0] == '/')
		set_folder(c, xdg, "/rnea");
	else
		set_folder_home(c);
}

/* The folder, checked and held open, so that what was checked is what is used; -1 and *error if there is none to be used. */
static int open_folder(const char *path, int *error)
{
	int folder = *path ? open(path, O_RDONLY | O_DIRECTORY | O_CLOEXEC) : -1;
	struct stat s;

	*error = folder < 0 ? errno : NOT_PRIVATE;
	if (folder < 0 || (fstat(folder, &s) == 0 && is_private(&s)))
		return folder;
	close(folder);
	return -1;
}

/* One folder; *error: why the first one after those that are there was not made. */
static void make_one(const char *path, int *error)
{
	if (mkdir(path, S_IRWXU) == 0 || errno == EEXIST)
		*error = 0;
	else if (!*error)
		*error = errno;
}

/* Also the parents; where that fails the folder cannot be opened afterwards, for the reason that is returned. */
static int make_folder(const char *path)
{
	char part[sizeof((struct cache *)0)->folder];
	int error = 0;

	snprintf(part, sizeof part, "%s", path);
	for (char *s = part; *s; s++)
		if (*s == '/' && s != part) {
			*s = '\0';
			make_one(part, &error);
			*s = '/';
		}
	make_one(part, &error);
	return error;
}

static int open_or_make_folder(const char *path, int *error)
{
	int folder = open_folder(path, error), why;

	if (folder >= 0 || *error != ENOENT)
		return folder;
	why = make_folder(path);
	folder = open_folder(path, error);
	if (folder < 0 && *error == ENOENT && why)
		*error = why;
	return folder;
}

/* ---- entries ---- */

/* Sizes that fit each other, the key and the file; only then is memory taken for them. */
static int read_header(int file, size_t key_size, struct header *h)
{
	struct stat s;

	if (fstat(file, &s) != 0 || !S_ISREG(s.st_mode) || !is_private(&s) || s.st_size < 0 ||
		s.st_size > CACHE_BYTES || scratch_take(file, h, sizeof *h))
		return 0;
	return h->magic == magic && h->key_size == key_size && h->data_size <= CACHE_BYTES && key_size <= CACHE_BYTES &&
	       sizeof *h + key_size + h->data_size == (uint64_t)s.st_size;
}

static int read_entry(int file, const void *key, size_t key_size, char **data, size_t *size)
{
	struct header h;
	size_t rest;
	char *all;

	if (!read_header(file, key_size, &h))
		return 0;
	rest = key_size + (size_t)h.data_size;
	if (!(all = malloc(rest + 1)))
		return 0;
	if (scratch_take(file, all, rest) || hash_add(hash_start, all, rest) != h.checksum ||
		memcmp(all, key, key_size) != 0) {
		free(all);
		return 0;
	}
	*size = (size_t)h.data_size;
	memmove(all, all + key_size, *size);
	all[*size] = '\0';
	*data = all;
	return 1;
}

int cache_get(const struct cache *c, const void *key, size_t key_size, char **data, size_t *size)
{
	char name[CACHE_NAME_SIZE];
	int error, folder = open_folder(c->folder, &error), file, found;

	*data = NULL;
	*size = 0;
	if (folder < 0)
		return 0;
	cache_name_entry(name, hash_add(hash_start, key, key_size));
	file = openat(folder, name, O_RDONLY | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC);
	close(folder);
	if (file < 0)
		return 0;
	/* used now: pruning removes what was not */
	if ((found = read_entry(file, key, key_size, data, size)) != 0)
		futimens(file, NULL);
	close(file);
	return found;
}

static int make_temporary(int folder, char name[CACHE_NAME_SIZE])
{
	int file = -1;

	for (int attempt = 0; file < 0 && attempt < 100; attempt++) {
		cache_name_temporary(name, attempt);
		file = openat(folder, name, O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, S_IRUSR | S_IWUSR);
		if (file < 0 && errno != EEXIST && errno != EINTR)
			break;
	}
	return file;
}

/* Not synchronised with the disk: what a crash of the machine leaves behind does not have its checksum. */
static int write_entry(int file, const void *key, size_t key_size, const void *data, size_t size)
{
	struct header h = {.magic = magic, .key_size = key_size, .data_size = size};
	int error;

	h.checksum = hash_add(hash_add(hash_start, key, key_size), data, size);
	if ((error = scratch_fill(file, &h, sizeof h)) == 0 && (error = scratch_fill(file, key, key_size)) == 0)
		error = scratch_fill(file, data, size);
	if (close(file) != 0 && !error)
		error = errno;
	return error;
}

/* A folder in the entry's place would stay there for ever; one that holds something is somebody's. */
static int put_in_place(int folder, const char *temporary, const char *name)
{
	if (renameat(folder, temporary, folder, name) == 0)
		return 0;
	if ((errno == EISDIR || errno == ENOTEMPTY || errno == EEXIST) && unlinkat(folder, name, AT_REMOVEDIR) == 0 &&
		renameat(folder, temporary, folder, name) == 0)
		return 0;
	return errno;
}

static int keep(const char *path, int folder, const void *key, size_t key_size, const void *data, size_t size,
	struct cache_why *why)
{
	char name[CACHE_NAME_SIZE], temporary[CACHE_NAME_SIZE];
	int file = make_temporary(folder, temporary), error;

	if (file < 0)
		return refuse(why, path, NULL, errno);
	if ((error = write_entry(file, key, key_size, data, size)) != 0) {
		unlinkat(folder, temporary, 0);
		return refuse(why, path, NULL, error);
	}
	cache_name_entry(name, hash_add(hash_start, key, key_size));
	if ((error = put_in_place(folder, temporary, name)) == 0)
		return 1;
	unlinkat(folder, temporary, 0);
	return refuse(why, path, name, error);
}

/* Writing more than the process may put into a file would not fail but kill it. */
static int may_write(size_t key_size, size_t size)
{
	struct rlimit limit;
	uint64_t total;

	if (key_size > CACHE_BYTES || size > CACHE_BYTES)
		return 0;
	total = sizeof(struct header) + (uint64_t)key_size + size;
	return total <= CACHE_BYTES && getrlimit(RLIMIT_FSIZE, &limit) == 0 &&
	       (limit.rlim_cur == RLIM_INFINITY || total <= limit.rlim_cur);
}

int cache_put(const struct cache *c, const void *key, size_t key_size, const void *data, size_t size, struct cache_why *why)
{
	int folder, kept, error;

	if (why)
		why->text[0] = '\0';
	if (!c->folder[0])
		return 0;
	if (!may_write(key_size, size))
		return refuse(why, c->folder, NULL, EFBIG);
	if ((folder = open_or_make_folder(c->folder, &error)) < 0)
		return refuse(why, c->folder, NULL, error);
	kept = keep(c->folder, folder, key, key_size, data, size, why);
	cache_prune(folder);
	close(folder);
	return kept;
}

/* ---- turns ---- */

int cache_turn_begin(const struct cache *c, const void *key, size_t key_size, struct cache_turn *turn)
{
	int error;

	*turn = (struct cache_turn){.folder = -1, .file = -1};
	if (!c->folder[0] || (turn->folder = open_or_make_folder(c->folder, &error)) < 0)
		return 1;
	cache_name_turn(turn->name, hash_add(hash_start, key, key_size));
	turn->file = openat(turn->folder, turn->name, O_RDWR | O_CREAT | O_NOFOLLOW | O_CLOEXEC, S_IRUSR | S_IWUSR);
	if (turn->file < 0 || flock(turn->file, LOCK_EX | LOCK_NB) == 0 || errno != EWOULDBLOCK)
		return 1;
	close(turn->file);
	turn->file = -1;
	cache_turn_end(turn);
	return 0;
}

/* Unlocked by word, for a forked child may have the file open too. */
void cache_turn_end(struct cache_turn *turn)
{
	if (turn->file >= 0) {
		unlinkat(turn->folder, turn->name, 0);
		flock(turn->file, LOCK_UN);
		close(turn->file);
	}
	if (turn->folder >= 0)
		close(turn->folder);
	turn->folder = turn->file = -1;
}
