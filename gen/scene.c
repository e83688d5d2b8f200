#define _POSIX_C_SOURCE 200809L
#include "scene.h"
#include "c_locale.h"
#include "nearest.h"
#include "number.h"
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

static const struct word {
	const char *name;
	int takes; /* a value: 0 no, 1 yes, 2 may */
	enum scene_kind kind;
} WORDS[] = {
#define SCENE_KEY_ROW(key, word, takes, kind) [SCENE_##key] = {word, takes, kind},
	SCENE_KEYS(SCENE_KEY_ROW)
#undef SCENE_KEY_ROW
};

static const char BLANKS[] = " \t\r";

const char *scene_word(enum scene_key key)
{
	return WORDS[key].name;
}

enum rneagen_code scene_refuse(
	const struct scene *s, const struct scene_choice *c, struct rneagen_error *e, const char *fmt, ...)
{
	char what[sizeof e->message];
	va_list ap;

	va_start(ap, fmt);
	vsnprintf(what, sizeof what, fmt, ap);
	va_end(ap);
	return error_set(e, RNEAGEN_SCENE, "%s: scene line %d, %s: %s", s->file, c->line, WORDS[c->key].name, what);
}

/* ---- reading ---- */

struct reader {
	struct scene *s;
	struct arena *a;
	struct rneagen_error *e;
	size_t capacity;
	int line;
};

/* A copy of `length` bytes without the blanks around them; NULL on failure. */
static const char *trimmed(struct arena *a, const char *s, size_t length)
{
	for (; length && strchr(BLANKS, *s); s++)
		length--;
	while (length && strchr(BLANKS, s[length - 1]))
		length--;
	return arena_string(a, s, length);
}

/* Where a line's comment begins: at a # that nothing or a blank stands before. */
static size_t without_comment(const char *line, size_t length)
{
	for (size_t i = 0; i < length; i++)
		if (line[i] == '#' && (i == 0 || strchr(BLANKS, line[i - 1])))
			return i;
	return length;
}

static int find_key(const char *word, size_t length)
{
	for (int key = 0; key < SCENE_KEY_COUNT; key++)
		if (strlen(WORDS[key].name) == length && !memcmp(WORDS[key].name, word, length))
			return key;
	return -1;
}

static enum rneagen_code refuse_word(const struct reader *r, const char *word, size_t length)
{
	const char *copy = arena_string(r->a, word, length), *meant;

	if (!copy)
		return error_memory(r->e);
	meant = nearest_name(copy, WORDS, SCENE_KEY_COUNT, sizeof *WORDS);
	return error_set(r->e, RNEAGEN_SCENE, "%s: scene line %d: '%.255s' is not known%s%s%s", r->s->file, r->line, copy,
		meant ? "; did you mean '" : "", meant ? meant : "", meant ? "'?" : "");
}

/* NAME=VALUE at the last =; NAME:sample or NAME:batch at the last colon. */
static enum rneagen_code split(const struct reader *r, struct scene_choice *c, const char *value)
{
	const char *at = strrchr(value, WORDS[c->key].kind == SCENE_PAIR ? '=' : ':');

	c->name = value;
	if (WORDS[c->key].kind == SCENE_FREED && (!at || (strcmp(at, ":sample") && strcmp(at, ":batch"))))
		return RNEAGEN_OK;
	if (!at || at == value || !at[1])
		return scene_refuse(r->s, c, r->e, "takes %s, not '%.255s'",
			WORDS[c->key].kind == SCENE_PAIR ? "NAME=VALUE" : "NAME, NAME:sample or NAME:batch", value);
	c->name = trimmed(r->a, value, (size_t)(at - value));
	c->value = trimmed(r->a, at + 1, strlen(at + 1));
	return c->name && c->value ? RNEAGEN_OK : error_memory(r->e);
}

/* One value cannot be chosen twice. */
static enum rneagen_code check_once(const struct reader *r, const struct scene_choice *c)
{
	enum scene_kind kind = WORDS[c->key].kind;

	for (int i = 0; i < r->s->line_count && (kind == SCENE_VALUE || kind == SCENE_NAME); i++)
		if (r->s->lines[i].key == c->key)
			return scene_refuse(r->s, c, r->e, "is also given in line %d; give it once", r->s->lines[i].line);
	return RNEAGEN_OK;
}

/* One of two words. */
static enum rneagen_code check_word(const struct reader *r, const struct scene_choice *c, const char *value)
{
	static const char *const words[SCENE_KEY_COUNT][2] = {
		[SCENE_BESIDE] = {"lock", "drop"}, [SCENE_FEXT_FRAME] = {"link", "world"}};
	const char *const *w = words[c->key];

	if (*w && strcmp(value, w[0]) && strcmp(value, w[1]))
		return scene_refuse(r->s, c, r->e, "takes %s or %s, not '%.255s'", w[0], w[1], value);
	return RNEAGEN_OK;
}

static enum rneagen_code add_choice(struct reader *r, enum scene_key key, const char *value)
{
	struct scene_choice c = {.key = key, .name = "", .line = r->line};
	struct scene_choice *wider;

	if (WORDS[key].takes == 1 && !*value)
		return scene_refuse(r->s, &c, r->e, "needs a value");
	if (WORDS[key].takes == 0 && *value)
		return scene_refuse(r->s, &c, r->e, "takes no value, and '%.255s' is one", value);
	if (check_once(r, &c) || check_word(r, &c, value))
		return r->e->code;
	if (WORDS[key].kind == SCENE_PAIR || WORDS[key].kind == SCENE_FREED)
		split(r, &c, value);
	else if (WORDS[key].kind == SCENE_VALUE)
		c.value = *value ? value : NULL;
	else
		c.name = value;
	wider = arena_grow(r->a, r->s->lines, (size_t)r->s->line_count, &r->capacity, sizeof *wider);
	if (!wider)
		return error_memory(r->e);
	r->s->lines = wider;
	wider[r->s->line_count++] = c;
	return r->e->code;
}

static enum rneagen_code read_line(struct reader *r, const char *line, size_t length)
{
	size_t end = without_comment(line, length), word;
	const char *all = trimmed(r->a, line, end), *value;
	int key;

	r->line++;
	if (!all)
		return error_memory(r->e);
	if (!*all)
		return RNEAGEN_OK;
	word = strcspn(all, BLANKS);
	key = find_key(all, word);
	if (key < 0)
		return refuse_word(r, all, word);
	value = all + word + strspn(all + word, BLANKS);
	return add_choice(r, (enum scene_key)key, value);
}

enum rneagen_code scene_read(
	struct scene *s, const char *text, const char *file, struct arena *a, struct rneagen_error *e)
{
	struct reader r = {.s = s, .a = a, .e = e};

	*s = (struct scene){.file = file};
	while (text && *text) {
		size_t length = strcspn(text, "\n");

		if (read_line(&r, text, length))
			return e->code;
		text += length + (text[length] == '\n');
	}
	return RNEAGEN_OK;
}

/* ---- names ---- */

/* Links and joints begin with their names. */
static int refuse_name(const struct scene *s, const struct scene_choice *c, const char *what, const char *name,
	const void *entries, int count, size_t stride, struct rneagen_error *e)
{
	const char *meant = nearest_name(name, entries, (size_t)count, stride);

	scene_refuse(s, c, e, "no %s '%.255s'%s%s%s", what, name, meant ? "; did you mean '" : "", meant ? meant : "",
		meant ? "'?" : "");
	return -1;
}

int scene_link(const struct scene *s, const struct scene_choice *c, const struct robot *r, const char *name,
	struct rneagen_error *e)
{
	int i = robot_link(r, name);

	return i < 0 ? refuse_name(s, c, "link", name, r->links, r->link_count, sizeof *r->links, e) : i;
}

int scene_joint(const struct scene *s, const struct scene_choice *c, const struct robot *r, const char *name,
	struct rneagen_error *e)
{
	int i = robot_joint(r, name);

	return i < 0 ? refuse_name(s, c, "joint", name, r->joints, r->joint_count, sizeof *r->joints, e) : i;
}

/* Does the whole of a list name one thing? Wanted quantities have the name after a dot. */
static int is_one_name(enum scene_key key, const char *list, const struct robot *r)
{
	const char *comma = strchr(list, ','), *dot = key == SCENE_WANT ? strchr(list, '.') : NULL, *name = dot ? dot + 1 : list;

	if (!comma || (dot && comma < dot))
		return !comma;
	return (key != SCENE_LOCK_ALL_BUT && robot_link(r, name) >= 0) ||
		((key == SCENE_LOCK_ALL_BUT || key == SCENE_WANT) && robot_joint(r, name) >= 0);
}

/* ---- lists ---- */

static enum rneagen_code expand_line(struct scene *s, const struct scene_choice *line, const struct robot *r, struct arena *a,
	struct rneagen_error *e)
{
	const char *at = line->name;

	if (WORDS[line->key].kind != SCENE_NAMES || is_one_name(line->key, at, r)) {
		s->choices[s->count++] = *line;
		return RNEAGEN_OK;
	}
	for (size_t length; at; at = at[length] ? at + length + 1 : NULL) {
		struct scene_choice *c = &s->choices[s->count];

		length = strcspn(at, ",");
		*c = *line;
		c->name = trimmed(a, at, length);
		if (!c->name)
			return error_memory(e);
		if (!*c->name)
			return scene_refuse(s, line, e, "'%.255s' has an empty name", line->name);
		s->count++;
	}
	return RNEAGEN_OK;
}

enum rneagen_code scene_expand(struct scene *s, const struct robot *r, struct arena *a, struct rneagen_error *e)
{
	size_t most = (size_t)s->line_count;

	for (int i = 0; i < s->line_count; i++)
		for (const char *at = s->lines[i].name; *at; at++)
			most += *at == ',';
	s->count = 0;
	s->choices = arena_alloc(a, most, sizeof *s->choices);
	if (!s->choices)
		return error_memory(e);
	for (int i = 0; i < s->line_count; i++)
		if (expand_line(s, &s->lines[i], r, a, e))
			return e->code;
	return RNEAGEN_OK;
}

const struct scene_choice *scene_next(const struct scene *s, enum scene_key key, const struct scene_choice *before)
{
	for (int i = before ? (int)(before - s->choices) + 1 : 0; i < s->count; i++)
		if (s->choices[i].key == key)
			return &s->choices[i];
	return NULL;
}

/* ---- values, and how a scene is written ---- */

static int read_number(const char **s, double *value)
{
	char word[128];
	size_t length = strcspn(*s, ",");

	if (length >= sizeof word)
		return 0;
	memcpy(word, *s, length);
	word[length] = '\0';
	*s += length;
	return number_read(word, value, 1);
}

enum rneagen_code scene_numbers(
	const struct scene *s, const struct scene_choice *c, double *values, int count, struct rneagen_error *e)
{
	const char *at = c->value ? c->value : "";
	struct c_locale l;
	int good = 1;

	if (!c_locale_enter(&l))
		return error_memory(e);
	for (int i = 0; i < count && good; i++) {
		good = read_number(&at, &values[i]) && *at == (i + 1 < count ? ',' : '\0');
		at += *at == ',';
	}
	c_locale_leave(&l);
	if (good)
		return RNEAGEN_OK;
	return count == 1 ? scene_refuse(s, c, e, "takes a finite number, not '%.255s'", c->value ? c->value : "")
			  : scene_refuse(s, c, e, "takes %d finite numbers with commas between, not '%.255s'", count,
				    c->value ? c->value : "");
}

void scene_put_option(const struct scene_choice *line, struct text *t)
{
	const struct word *w = &WORDS[line->key];
	struct text value;

	text_init(&value, t->arena);
	text_put(&value, line->name);
	if (w->kind == SCENE_PAIR)
		text_putc(&value, '=');
	if (w->kind == SCENE_FREED && line->value)
		text_putc(&value, ':');
	text_put(&value, line->value ? line->value : "");
	t->failed |= value.failed;
	text_printf(t, "--%s", w->name);
	if (value.length) {
		text_putc(t, w->takes == 2 ? '=' : ' ');
		text_put_shell(t, text_string(&value));
	}
}
