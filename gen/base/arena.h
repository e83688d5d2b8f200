#ifndef RNEAGEN_ARENA_H
#define RNEAGEN_ARENA_H
/* One arena per generation: everything made on the way from URDF to text lives here and is freed at once. */

#include <stddef.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Where an arena takes its blocks from. alloc returns NULL on failure; release takes what alloc gave. */
struct rneagen_allocator {
	void *(*alloc)(void *context, size_t size);
	void (*release)(void *context, void *block);
	void *context;
};

struct arena_block;

struct arena {
	struct rneagen_allocator allocator;
	struct arena_block *shared; /* blocks of one size, newest first */
	struct arena_block *large;  /* blocks of one owner each, newest first: those that can be given back */
	size_t used;                /* bytes taken from the newest shared block */
	int failed;                 /* sticky: some request could not be met */
	const char *reason;         /* why it failed, where that was not memory */
};

/* An empty arena. `allocator` may be NULL: malloc and free. */
void arena_init(struct arena *a, const struct rneagen_allocator *allocator);
void arena_free(struct arena *a);

/* `count` zeroed objects of `size` bytes, aligned for any type; NULL (and a->failed) when memory or size_t runs out.
   A count of 0 gives a valid pointer. */
void *arena_alloc(struct arena *a, size_t count, size_t size);

/* The same, but not zeroed: a program that never writes to what it took need not have memory for it. */
void *arena_take(struct arena *a, size_t count, size_t size);

/* Give back what arena_alloc, arena_take or arena_grow gave and nobody needs any more (NULL: nothing). What shares a block
   with others stays until arena_free. */
void arena_release(struct arena *a, void *p);

/* A NUL-terminated copy of `length` bytes of `s`; NULL on failure. */
char *arena_string(struct arena *a, const char *s, size_t length);

/* Grow an array of `count` objects that holds `*capacity` of them so that one more fits, which is not zeroed; returns the
   array, moved or not: moved, the old one is given back. NULL on failure (the old array is then still valid). */
void *arena_grow(struct arena *a, void *array, size_t count, size_t *capacity, size_t size);

#ifdef __cplusplus
}
#endif
#endif
