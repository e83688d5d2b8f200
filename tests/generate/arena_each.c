/* gen/base/arena.h over again, for tests: every request is a block of its own, so that an allocator can refuse each of them,
   and a sanitizer sees where each of them ends. */
#include "base/arena.h"
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

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

void arena_free(struct arena *a)
{
	while (a->large) {
		struct arena_block *next = a->large->next;

		a->allocator.release(a->allocator.context, a->large);
		a->large = next;
	}
}

/* Filled with what is neither 0 nor a pointer. */
void *arena_take(struct arena *a, size_t count, size_t size)
{
	size_t bytes = size && count > (SIZE_MAX - sizeof *a->large) / size ? SIZE_MAX : count * size;
	struct arena_block *b = NULL;

	if (bytes != SIZE_MAX)
		b = a->allocator.alloc(a->allocator.context, sizeof *b + bytes);
	if (!b) {
		a->failed = 1;
		return NULL;
	}
	b->next = a->large;
	a->large = b;
	return memset(b->data, 0xa5, bytes);
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
	size_t wider = *capacity ? *capacity * 2 : 2;
	void *p = count < *capacity ? array : arena_take(a, wider, size);

	if (!p || p == array)
		return p;
	if (count)
		memcpy(p, array, count * size);
	arena_release(a, array);
	*capacity = wider;
	return p;
}
