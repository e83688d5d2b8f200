#include "base/nearest.h"
#include <string.h>

enum { LETTERS = 255 };

static int least(int a, int b)
{
	return a < b ? a : b;
}

static size_t letters(const char *s)
{
	size_t n = strlen(s);

	return n < LETTERS ? n : LETTERS;
}

/* d(i, j) = min(d(i-1, j) + 1, d(i, j-1) + 1, d(i-1, j-1) + [a_i != b_j], and d(i-2, j-2) + 1 where two are swapped) */
static int distance(const char *a, const char *b)
{
	int rows[3][LETTERS + 1];
	size_t n = letters(a), m = letters(b);

	for (size_t j = 0; j <= m; j++)
		rows[0][j] = (int)j;
	for (size_t i = 1; i <= n; i++) {
		int *now = rows[i % 3], *up = rows[(i + 2) % 3], *before = rows[(i + 1) % 3];

		now[0] = (int)i;
		for (size_t j = 1; j <= m; j++) {
			now[j] = least(least(up[j], now[j - 1]) + 1, up[j - 1] + (a[i - 1] != b[j - 1]));
			if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1])
				now[j] = least(now[j], before[j - 2] + 1);
		}
	}
	return rows[n % 3][m];
}

static const char *name_at(const void *entries, size_t i, size_t stride)
{
	return *(const char *const *)(const void *)((const char *)entries + i * stride);
}

/* The one with the least distance, which is at most a share of the name's letters. */
static const char *least_distant(const char *word, const void *entries, size_t count, size_t stride, int share)
{
	const char *found = NULL;
	int best = 0;

	for (size_t i = 0; i < count; i++) {
		const char *name = name_at(entries, i, stride);
		int far = distance(word, name);

		if (far <= ((int)letters(name) + 1) / share && (!found || far < best)) {
			found = name;
			best = far;
		}
	}
	return found;
}

/* Does a string of so many letters or more stand in the other? */
static int is_within(const char *part, const char *whole)
{
	return letters(part) >= 3 && strstr(whole, part);
}

/* The shortest one that holds the word, "panda_hand" for "hand", or else the longest one that it holds. */
static const char *holding(const char *word, const void *entries, size_t count, size_t stride)
{
	const char *holds = NULL, *held = NULL;

	for (size_t i = 0; i < count; i++) {
		const char *name = name_at(entries, i, stride);

		if (is_within(word, name) && (!holds || letters(name) < letters(holds)))
			holds = name;
		if (is_within(name, word) && (!held || letters(name) > letters(held)))
			held = name;
	}
	return holds ? holds : held;
}

const char *nearest_name(const char *word, const void *entries, size_t count, size_t stride)
{
	const char *found = least_distant(word, entries, count, stride, 4);

	found = found ? found : holding(word, entries, count, stride);
	return found ? found : least_distant(word, entries, count, stride, 2);
}
