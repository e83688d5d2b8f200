#include "base/text.h"
#include <stdarg.h>
#include <stdio.h>
#include <stdint.h>
#include <string.h>

void text_init(struct text *t, struct arena *a)
{
	*t = (struct text){.arena = a};
}

/* Room for `extra` more bytes and the NUL. */
static int text_reserve(struct text *t, size_t extra)
{
	size_t wider = t->capacity ? t->capacity : 256;
	char *s;

	if (t->failed)
		return 0;
	if (extra < t->capacity - t->length && t->capacity)
		return 1;
	while (wider - t->length <= extra)
		wider *= 2;
	s = arena_take(t->arena, wider, 1);
	if (!s) {
		t->failed = 1;
		return 0;
	}
	if (t->length)
		memcpy(s, t->s, t->length);
	arena_release(t->arena, t->s);
	t->s = s;
	t->capacity = wider;
	return 1;
}

void text_putn(struct text *t, const char *s, size_t length)
{
	if (!text_reserve(t, length))
		return;
	memcpy(t->s + t->length, s, length);
	t->length += length;
	t->s[t->length] = '\0';
}

void text_put(struct text *t, const char *s)
{
	text_putn(t, s, strlen(s));
}

void text_putc(struct text *t, char c)
{
	text_putn(t, &c, 1);
}

void text_clear(struct text *t)
{
	t->length = 0;
	if (t->s)
		*t->s = '\0';
}

/* Into the room that there is, and again where that was too little. */
static void put_arguments(struct text *t, const char *fmt, va_list ap)
{
	size_t room = t->failed ? 0 : t->capacity - t->length;
	va_list again;
	int n;

	va_copy(again, ap);
	n = vsnprintf(room ? t->s + t->length : NULL, room, fmt, ap);
	if (n < 0)
		t->failed = 1;
	else if (text_reserve(t, (size_t)n)) {
		if ((size_t)n >= room)
			vsnprintf(t->s + t->length, (size_t)n + 1, fmt, again);
		t->length += (size_t)n;
	}
	if (t->failed && room)
		t->s[t->length] = '\0';
	va_end(again);
}

void text_printf(struct text *t, const char *fmt, ...)
{
	va_list ap;

	va_start(ap, fmt);
	put_arguments(t, fmt, ap);
	va_end(ap);
}

const char *text_format(struct arena *a, const char *fmt, ...)
{
	struct text t;
	va_list ap;

	text_init(&t, a);
	va_start(ap, fmt);
	put_arguments(&t, fmt, ap);
	va_end(ap);
	return text_string(&t);
}

void text_put_indented(struct text *t, const char *s)
{
	for (size_t length; *s; s += length) {
		length = strcspn(s, "\n");
		text_put(t, length ? "\t" : "");
		length += s[length] != '\0';
		text_putn(t, s, length);
	}
}

const char *text_string(const struct text *t)
{
	return t->s ? t->s : "";
}

void text_put_comment(struct text *t, const char *s)
{
	for (; *s; s++) {
		unsigned char c = (unsigned char)*s;

		if (c < 0x20 || c >= 0x7f || c == '\\' || c == '/' || c == '?')
			text_printf(t, "\\x%02x", c);
		else
			text_putc(t, (char)c);
	}
}

void text_put_json(struct text *t, const char *s)
{
	text_putc(t, '"');
	for (; *s; s++) {
		unsigned char c = (unsigned char)*s;

		if (c == '"' || c == '\\')
			text_printf(t, "\\%c", c);
		else if (c < 0x20 || c == 0x7f)
			text_printf(t, "\\u%04x", c);
		else
			text_putc(t, (char)c);
	}
	text_putc(t, '"');
}

void text_put_shell(struct text *t, const char *s)
{
	static const char plain[] = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-+./,:=@%";

	if (*s && strspn(s, plain) == strlen(s)) {
		text_put(t, s);
		return;
	}
	text_putc(t, '\'');
	for (; *s; s++)
		if (*s == '\'')
			text_put(t, "'\\''");
		else
			text_putc(t, *s);
	text_putc(t, '\'');
}

const char *text_before_file(const char *name)
{
	return name[0] == '-' && name[1] ? "./" : "";
}

int text_digest(const char *s)
{
	uint32_t h = 2166136261u;

	for (; *s; s++)
		h = (h ^ (unsigned char)*s) * 16777619u;
	return (int)(h >> 1);
}
