/* Mutations that mostly stay XML, beside libFuzzer's own: values of attributes are exchanged or changed, tags are
   removed, repeated and moved. */
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

size_t LLVMFuzzerMutate(uint8_t *data, size_t size, size_t max_size);
size_t LLVMFuzzerCustomMutator(uint8_t *data, size_t size, size_t max_size, unsigned int seed);

struct span {
	size_t at, length;
};

struct editor {
	uint8_t *data;
	size_t size, max;
	uint64_t state;
};

/* xorshift64 */
static size_t below(struct editor *e, size_t n)
{
	e->state ^= e->state << 13;
	e->state ^= e->state >> 7;
	e->state ^= e->state << 17;
	return n ? (size_t)(e->state >> 11) % n : 0;
}

/* Put `length` bytes from elsewhere in place of a span; nothing happens if that was not found or there is no room. */
static void replace(struct editor *e, struct span old, const void *bytes, size_t length)
{
	size_t tail = old.at + old.length;

	if (!old.at || e->size - old.length + length > e->max)
		return;
	memmove(e->data + old.at + length, e->data + tail, e->size - tail);
	if (length)
		memcpy(e->data + old.at, bytes, length);
	e->size = e->size - old.length + length;
}

/* The first span from a random place on that begins after `open` and ends before `close`; length 0 if there is none. */
static struct span find_between(struct editor *e, int open, int close)
{
	size_t from = below(e, e->size);
	const uint8_t *a = memchr(e->data + from, open, e->size - from), *b;
	size_t at;

	if (!a)
		return (struct span){0, 0};
	at = (size_t)(a - e->data) + 1;
	b = at < e->size ? memchr(e->data + at, close, e->size - at) : NULL;
	return b ? (struct span){at, (size_t)(b - e->data) - at} : (struct span){0, 0};
}

/* A value of an attribute: what follows =" */
static struct span find_value(struct editor *e)
{
	struct span s = find_between(e, '=', '>');
	const uint8_t *end;

	if (s.length < 3 || (e->data[s.at] != '"' && e->data[s.at] != '\''))
		return (struct span){0, 0};
	end = memchr(e->data + s.at + 1, e->data[s.at], s.length - 1);
	return end ? (struct span){s.at + 1, (size_t)(end - e->data) - s.at - 1} : (struct span){0, 0};
}

/* From one tag's < to the end of it or of one of the next few. */
static struct span find_tags(struct editor *e)
{
	struct span s = find_between(e, '<', '>');
	size_t end = s.at + s.length + 1;

	if (!s.length)
		return s;
	for (size_t more = below(e, 8); more > 0; more--) {
		const uint8_t *next = end < e->size ? memchr(e->data + end, '>', e->size - end) : NULL;

		if (!next)
			break;
		end = (size_t)(next - e->data) + 1;
	}
	return (struct span){s.at - 1, end - s.at + 1};
}

static void set_value(struct editor *e)
{
	static const char *const values[] = {"0", "1", "-1", "0.5", "1e-9", "1e300", "-1e300", "1.5707963267948966",
		"3.14159265359", "0 0 0", "0 0 1", "0 -1 0", "1e-8 1 0", "1.5708 0 0", "a", "base", "j", "fixed",
		"continuous", "prismatic", "planar", "floating", "revolute", "a&#10;b", "&quot;&lt;"};
	const char *v = values[below(e, sizeof values / sizeof *values)];

	replace(e, find_value(e), v, strlen(v));
}

static void copy(struct editor *e, struct span from, struct span to)
{
	uint8_t *bytes = malloc(from.length + 1);

	if (!bytes)
		return;
	memcpy(bytes, e->data + from.at, from.length);
	replace(e, to, bytes, from.length);
	free(bytes);
}

static void mutate_value(struct editor *e)
{
	struct span s = find_value(e);
	uint8_t bytes[256] = {0};

	if (!s.length || s.length > sizeof bytes / 2)
		return;
	memcpy(bytes, e->data + s.at, s.length);
	replace(e, s, bytes, LLVMFuzzerMutate(bytes, s.length, sizeof bytes));
}

size_t LLVMFuzzerCustomMutator(uint8_t *data, size_t size, size_t max_size, unsigned int seed)
{
	struct editor e = {data, size, max_size, seed * 0x9e3779b97f4a7c15u + 1};
	struct span tags;

	for (size_t edits = 1 + below(&e, 4); edits > 0 && e.size > 8; edits--) {
		switch (below(&e, 8)) {
		case 0:
			set_value(&e);
			break;
		case 1:
			copy(&e, find_value(&e), find_value(&e));
			break;
		case 2:
			mutate_value(&e);
			break;
		case 3:
			replace(&e, find_tags(&e), "", 0);
			break;
		case 4:
			tags = find_tags(&e);
			copy(&e, tags, (struct span){find_tags(&e).at, 0});
			break;
		case 5:
			e.data[below(&e, 2)] = (uint8_t)below(&e, 256); /* options */
			break;
		default:
			return LLVMFuzzerMutate(data, e.size, max_size);
		}
	}
	return e.size ? e.size : LLVMFuzzerMutate(data, size, max_size);
}
