#ifndef TESTS_DICE_H
#define TESTS_DICE_H
/* Decisions that depend on bytes alone, which a fuzzer may change. */

#include <stddef.h>
#include <stdint.h>

/* Bytes that decide; where none is left, every decision is the first. */
struct dice {
	const uint8_t *data;
	size_t size;
};

/* One of 0 .. n - 1; 0 for n = 0. */
static inline size_t dice_below(struct dice *d, size_t n)
{
	size_t x = 0;

	for (size_t most = n; n && most > 1 && d->size; most = (most + 255) / 256) {
		x = x << 8 | *d->data++;
		d->size--;
	}
	return n ? x % n : 0;
}

/* One time in n > 1. */
static inline int dice_happen(struct dice *d, size_t n)
{
	return dice_below(d, n) == n - 1;
}

static inline const char *dice_word(struct dice *d, const char *const *words, size_t count)
{
	return words[dice_below(d, count)];
}
#define DICE_WORD(d, ...)                                                                                                    \
	dice_word(d, (const char *const[]){__VA_ARGS__}, sizeof((const char *const[]){__VA_ARGS__}) / sizeof(char *))

#endif
