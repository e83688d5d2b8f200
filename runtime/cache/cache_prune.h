#ifndef RNEA_CACHE_PRUNE_H
#define RNEA_CACHE_PRUNE_H
/* The names of the files in a cache's folder, and which of them are to go. Files of other names are left alone. */

#include <stddef.h>
#include <stdint.h>

enum { CACHE_NAME_SIZE = 80 };

/* The name of the entry whose key has this hash: "rnea-" and 16 digits. */
void cache_name_entry(char name[CACHE_NAME_SIZE], uint64_t hash);

/* A name for a file that is being written; another for each `attempt`. */
void cache_name_temporary(char name[CACHE_NAME_SIZE], int attempt);

/* The file by which processes take turns at making that entry; stale as a temporary is. */
void cache_name_turn(char name[CACHE_NAME_SIZE], uint64_t hash);

/* Remove what killed writers left, and the entries unused for longest where there are more of them, or of their bytes,
   than cache.h says. */
void cache_prune(int folder);

#endif
