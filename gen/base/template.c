#include "base/template.h"
#include <string.h>

static const char *slot_value(const struct slot *slots, size_t count, const char *name, size_t length)
{
	for (size_t i = 0; i < count; i++)
		if (strlen(slots[i].name) == length && !memcmp(slots[i].name, name, length))
			return slots[i].value;
	return NULL;
}

/* The length of @NAME@ at s; 0 if there is no slot here. */
static size_t slot_length(const char *s)
{
	size_t n;

	if (*s != '@')
		return 0;
	n = strspn(s + 1, "ABCDEFGHIJKLMNOPQRSTUVWXYZ_0123456789");
	return n && s[n + 1] == '@' ? n + 2 : 0;
}

/* Up to the slot of this name, or, where it is NULL, all. */
static const char *expand(struct text *out, const char *tmpl, const char *end, const struct slot *slots, size_t count)
{
	const char *s = tmpl;

	while (*s) {
		size_t length = slot_length(s);
		const char *value;

		if (!length) {
			text_putc(out, *s++);
			continue;
		}
		if (end && strlen(end) == length - 2 && !memcmp(s + 1, end, length - 2))
			return s + length;
		value = slot_value(slots, count, s + 1, length - 2);
		if (!value)
			break;
		text_put(out, value);
		if (!*value && s[length] == '\n' && (s == tmpl || s[-1] == '\n'))
			length++;
		s += length;
	}
	if (*s || end)
		out->failed = out->arena->failed = 1; /* whoever takes the string of an inner text sees it too */
	return "";
}

void template_expand(struct text *out, const char *tmpl, const struct slot *slots, size_t count)
{
	expand(out, tmpl, NULL, slots, count);
}

const char *template_expand_to(struct text *out, const char *tmpl, const char *end, const struct slot *slots, size_t count)
{
	return expand(out, tmpl, end, slots, count);
}
