#include "base/arena.h"
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#define BLOCK_SIZE ((size_t)64 * 1024)

struct arena_block {
	struct arena_block *next;
	size_t size;
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

void arena_free(struct arena *a)
{
	while (a->blocks) {
		struct arena_block *next = a->blocks->next;
		a->allocator.release(a->allocator.context, a->blocks);
		a->blocks = next;
	}
	a->used = 0;
}

static struct arena_block *block_new(struct arena *a, size_t size)
{
	struct arena_block *b;

	if (size > SIZE_MAX - sizeof *b)
		return NULL;
	b = a->allocator.alloc(a->allocator.context, sizeof *b + size);
	if (!b)
		return NULL;
	b->size = size;
	b->next = a->blocks;
	a->blocks = b;
	a->used = 0;
	return b;
}

void *arena_take(struct arena *a, size_t count, size_t size)
{
	const size_t align = sizeof(max_align_t);
	size_t bytes;
	char *p;

	if (size && count > (SIZE_MAX - align) / size)
		goto fail;
	bytes = (count * size + align) / align * align; /* at least one unit, so that a count of 0 has an address */
	if (!a->blocks || bytes > a->blocks->size - a->used)
		if (!block_new(a, bytes > BLOCK_SIZE ? bytes : BLOCK_SIZE))
			goto fail;
	p = (char *)a->blocks->data + a->used;
	a->used += bytes;
	return p;
fail:
	a->failed = 1;
	return NULL;
}

void *arena_alloc(struct arena *a, size_t count, size_t size)
{
	void *p = arena_take(a, count, size);

	return p ? memset(p, 0, count * size) : NULL;
}

/* Larger blocks than BLOCK_SIZE have one owner. */
void arena_release(struct arena *a, void *p)
{
	for (struct arena_block **at = &a->blocks; p && *at; at = &(*at)->next) {
		struct arena_block *b = *at;

		if ((void *)b->data != p || b->size <= BLOCK_SIZE)
			continue;
		if (b == a->blocks)
			a->used = b->next ? b->next->size : 0; /* how much of that is used is not known */
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
