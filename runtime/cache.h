#ifndef RNEA_CACHE_H
#define RNEA_CACHE_H
/* What was compiled before, in files. A cache never fails: what cannot be read is not there, what cannot be written is
   not kept.

   An entry is one file, named by a hash of its key. It holds the key itself, whole, and the image, with their lengths
   and a checksum: a key that only shares the hash, and a file that is damaged or cut short, are misses. Files are
   written under a temporary name in the same folder and renamed, so that any number of processes may read and write at
   once. The folder is used only if it belongs to this user and nobody else can write to it: what lies there is run. */

#include <stddef.h>

struct cache {
	char folder[1024]; /* "": there is none */
};

/* Choose the folder: `folder` if it is not NULL ("": none), else RNEA_CACHE, else XDG_CACHE_HOME/rnea, else
   HOME/.cache/rnea. It is made when the first entry is put into it. */
void cache_open(struct cache *c, const char *folder);

/* The image kept under `key`: 1 and *data (malloc, *size bytes and a NUL), or 0, NULL and 0. */
int cache_get(const struct cache *c, const void *key, size_t key_size, char **data, size_t *size);

/* Keep an image; 1 if it was kept. */
int cache_put(const struct cache *c, const void *key, size_t key_size, const void *data, size_t size);

#endif
