#ifndef RNEA_CACHE_H
#define RNEA_CACHE_H
/* What was compiled before, in files. A cache never fails: what cannot be read is not there, what cannot be written is
   not kept, and who asks is told why.

   An entry is one file, named by a hash of its key. It holds the key itself, whole, and the image, with their lengths
   and a checksum: a key that only shares the hash, and a file that is damaged or cut short, are misses. Files are
   written under a temporary name in the same folder and renamed, so that any number of processes may read and write at
   once. The folder is used only if it belongs to this user and nobody else can write to it: what lies there is run.

   The folder holds at most CACHE_ENTRIES entries of CACHE_BYTES bytes together: putting one removes those that were
   neither put nor got for longest, and what a writer that was killed left unfinished more than an hour ago. */

#include <stddef.h>

enum { CACHE_ENTRIES = 512, CACHE_BYTES = 512 << 20 };

struct cache {
	char folder[1024]; /* "": there is none */
};

struct cache_why {
	char text[1200];
};

/* Choose the folder: `folder` if it is not NULL ("": none), else RNEA_CACHE, else XDG_CACHE_HOME/rnea, else
   HOME/.cache/rnea if HOME is this user's. It is made, with its parents, when the first entry is to be made. */
void cache_open(struct cache *c, const char *folder);

/* The image kept under `key`: 1 and *data (malloc, *size bytes and a NUL), or 0, NULL and 0. */
int cache_get(const struct cache *c, const void *key, size_t key_size, char **data, size_t *size);

/* Keep an image, in place of whatever is there but a folder that is not empty: 1, or 0 and *why (NULL: not wanted) names
   the folder or file and says what is wrong with it; "" where no folder was chosen. */
int cache_put(const struct cache *c, const void *key, size_t key_size, const void *data, size_t size, struct cache_why *why);

/* Whose turn it is to make an entry, where several processes miss the same at once: a file that is locked, and gone afterwards.
   Who is killed has given its turn away. */
struct cache_turn {
	int folder, file; /* -1: none */
	char name[80];
};

/* 1: it is the caller's turn, which ends with cache_turn_end, or turns cannot be taken here; 0: another process, or another
   thread, is at it. */
int cache_turn_begin(const struct cache *c, const void *key, size_t key_size, struct cache_turn *turn);
void cache_turn_end(struct cache_turn *turn);

#endif
