#ifndef RNEAGEN_TEXT_H
#define RNEAGEN_TEXT_H
/* A growable string with sticky failure: append as much as you like, check `failed` once at the end. */

#include "base/arena.h"
#include "base/error.h"

struct text {
	struct arena *arena;
	char *s; /* NUL-terminated once something was appended; NULL before */
	size_t length, capacity;
	int failed;
};

void text_init(struct text *t, struct arena *a);
void text_put(struct text *t, const char *s);
void text_putn(struct text *t, const char *s, size_t length);
void text_putc(struct text *t, char c);
void text_printf(struct text *t, const char *fmt, ...) RNEAGEN_PRINTF(2, 3);

/* A string by itself; "" when memory runs out, which the arena knows. */
const char *text_format(struct arena *a, const char *fmt, ...) RNEAGEN_PRINTF(2, 3);

/* Append `s`, each of its lines that says something a tab further in. */
void text_put_indented(struct text *t, const char *s);

/* Begin again, in the room that there is. */
void text_clear(struct text *t);

/* The string so far, "" when empty; never NULL. */
const char *text_string(const struct text *t);

/* Append `s` so that it can stand inside a C comment or a double-quoted C or JSON string whatever it holds.
   Comment: control characters, backslashes and the slash of a comment's mark become \xHH. JSON: RFC 8259 escapes;
   bytes above 0x7f pass as they are (names are checked to be UTF-8 when the URDF is read). */
void text_put_comment(struct text *t, const char *s);
void text_put_json(struct text *t, const char *s);

/* Append `s` as one word of a POSIX shell, in single quotes where it needs them. */
void text_put_shell(struct text *t, const char *s);

/* What a command has before the name of a file, which may begin as options do: "./" or nothing. */
const char *text_before_file(const char *name);

/* A number from 0 to 2^31 - 1 by which strings that differ are told apart (FNV-1a). */
int text_digest(const char *s);

/* Of UTF-8: a byte that does not begin a character. */
static inline int text_is_inside(char c)
{
	return ((unsigned char)c & 0xc0) == 0x80;
}

#endif
