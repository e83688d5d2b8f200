#include "base/template.h"
#include <stdint.h>
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

/* The file that a template, or the rest of one, is from. */
static const char *file_of(const char *tmpl)
{
	for (const struct template_file *f = template_files; f->name; f++)
		if ((uintptr_t)tmpl - (uintptr_t)f->text < f->size)
			return f->name;
	return "of no file";
}

/* Whoever takes the string of an inner text sees it too. Without memory slots may have no values. */
static void fail(struct text *out, const char *tmpl, const char *slot, size_t length, const char *what)
{
	struct arena *a = out->arena;
	struct text reason;

	if (!a->failed) {
		text_init(&reason, a);
		text_printf(&reason, "%s @%.*s@ in template %s", what, (int)length, slot, file_of(tmpl));
		a->reason = reason.s;
	}
	out->failed = a->failed = 1;
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
		fail(out, tmpl, *s ? s + 1 : end, *s ? slot_length(s) - 2 : strlen(end), *s ? "nothing fills slot" : "there is no slot");
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

const char *template_text(struct arena *a, const char *tmpl, const struct slot *slots, size_t count)
{
	struct text t;

	text_init(&t, a);
	template_expand(&t, tmpl, slots, count);
	return text_string(&t);
}

enum rneagen_code template_error(struct rneagen_error *e, const struct arena *a)
{
	return a->reason ? error_set(e, RNEAGEN_TEMPLATE, "%s", a->reason) : error_memory(e);
}
