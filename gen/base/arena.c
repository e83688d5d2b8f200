#include "base/arena.h"
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#define BLOCK_SIZE ((size_t)64 * 1024)

struct arena_block {
	struct arena_block *next;
	max_align_t data[];
};

static void *heap_alloc(void *context, size_t size)
{
	(void)context;
	return malloc(size);
}

static void heap_release(void *context, void *block)
{
	(void)context;
	free(block);
}

void arena_init(struct arena *a, const struct rneagen_allocator *allocator)
{
	static const struct rneagen_allocator heap = {heap_alloc, heap_release, NULL};

	*a = (struct arena){.allocator = allocator ? *allocator : heap};
}

static void release_all(struct arena *a, struct arena_block *b)
{
	while (b) {
		struct arena_block *next = b->next;
		a->allocator.release(a->allocator.context, b);
		b = next;
	}
}

void arena_free(struct arena *a)
{
	release_all(a, a->shared);
	release_all(a, a->large);
	a->shared = a->large = NULL;
	a->used = 0;
}

static struct arena_block *block_new(struct arena *a, struct arena_block **list, size_t size)
{
	struct arena_block *b;

	if (size > SIZE_MAX - sizeof *b)
		return NULL;
	b = a->allocator.alloc(a->allocator.context, sizeof *b + size);
	if (!b)
		return NULL;
	b->next = *list;
	*list = b;
	return b;
}

/* A block of its own, for more than a shared one has room for. */
static void *take_large(struct arena *a, size_t bytes)
{
	struct arena_block *b = block_new(a, &a->large, bytes);

	return b ? b->data : NULL;
}

static void *take_shared(struct arena *a, size_t bytes)
{
	if (!a->shared || bytes > BLOCK_SIZE - a->used) {
		if (!block_new(a, &a->shared, BLOCK_SIZE))
			return NULL;
		a->used = 0;
	}
	a->used += bytes;
	return (char *)a->shared->data + a->used - bytes;
}

void *arena_take(struct arena *a, size_t count, size_t size)
{
	const size_t align = sizeof(max_align_t);
	void *p = NULL;

	if (!size || count <= (SIZE_MAX - align) / size) {
		size_t bytes = (count * size + align) / align * align; /* at least one unit, so that a count of 0 has an address */

		p = bytes > BLOCK_SIZE ? take_large(a, bytes) : take_shared(a, bytes);
	}
	a->failed |= !p;
	return p;
}

void *arena_alloc(struct arena *a, size_t count, size_t size)
{
	void *p = arena_take(a, count, size);

	return p ? memset(p, 0, count * size) : NULL;
}

void arena_release(struct arena *a, void *p)
{
	for (struct arena_block **at = &a->large; p && *at; at = &(*at)->next) {
		struct arena_block *b = *at;

		if ((void *)b->data != p)
			continue;
		*at = b->next;
		a->allocator.release(a->allocator.context, b);
		return;
	}
}

char *arena_string(struct arena *a, const char *s, size_t length)
{
	char *p = arena_alloc(a, length + 1, 1);

	if (p)
		memcpy(p, s, length);
	return p;
}

void *arena_grow(struct arena *a, void *array, size_t count, size_t *capacity, size_t size)
{
	size_t wider = *capacity < 16 ? 24 : *capacity * 2; /* at first: as many bodies have room in a block */
	void *p;

	if (count < *capacity)
		return array;
	p = arena_take(a, wider, size);
	if (!p)
		return NULL;
	if (count)
		memcpy(p, array, count * size);
	arena_release(a, array);
	*capacity = wider;
	return p;
}
