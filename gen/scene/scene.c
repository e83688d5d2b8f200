#include "scene/scene_words.h"
#include "base/nearest.h"
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

const struct scene_key_word SCENE_WORDS[SCENE_KEY_COUNT] = {
#define SCENE_KEY_ROW(key, word, takes, kind) [SCENE_##key] = {word, takes, kind},
	SCENE_KEYS(SCENE_KEY_ROW)
#undef SCENE_KEY_ROW
};

const char *scene_word(enum scene_key key)
{
	return SCENE_WORDS[key].name;
}

enum rneagen_code scene_refuse(
	const struct scene *s, const struct scene_choice *c, struct rneagen_error *e, const char *fmt, ...)
{
	char what[sizeof e->message];
	va_list ap;

	va_start(ap, fmt);
	vsnprintf(what, sizeof what, fmt, ap);
	va_end(ap);
	if (!c->told)
		return error_set(e, RNEAGEN_SCENE, "%s: --%s: %s", s->file, SCENE_WORDS[c->key].name, what);
	if (c->from)
		return error_set(e, RNEAGEN_SCENE, "%s:%d: %s: %s", c->from, c->told, SCENE_WORDS[c->key].name, what);
	return error_set(e, RNEAGEN_SCENE, "%s: scene line %d, %s: %s", s->file, c->told, SCENE_WORDS[c->key].name, what);
}

struct scene_place scene_place(const struct scene_choice *c)
{
	struct scene_place p = {"by an option"};

	if (c->told)
		snprintf(p.s, sizeof p.s, c->from ? "in line %d of %.255s" : "in line %d", c->told, c->from ? c->from : "");
	return p;
}

const char *scene_trimmed(struct arena *a, const char *s, size_t length)
{
	for (; length && strchr(SCENE_BLANKS, *s); s++)
		length--;
	while (length && strchr(SCENE_BLANKS, s[length - 1]))
		length--;
	return arena_string(a, s, length);
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

/* Has a choice of this key the robot's name after a dot? */
static int has_kind(enum scene_key key)
{
	return key == SCENE_FOLD || key == SCENE_WANT || key == SCENE_FREE || key == SCENE_JVP ||
		key == SCENE_VJP || key == SCENE_BY || key == SCENE_RANGE;
}

/* A name without the blanks around it, unless the robot has one with them. */
static const char *settled(enum scene_key key, const char *word, size_t length, const struct robot *r, struct arena *a)
{
	const char *whole = arena_string(a, word, length), *name = whole;

	if (whole && has_kind(key)) {
		name = strchr(whole, '.');
		name = name ? name + 1 : "";
	}
	if (!whole || robot_link(r, name) >= 0 || robot_joint(r, name) >= 0)
		return whole;
	return scene_trimmed(a, word, length);
}

/* Does the whole of a list name one thing? */
static int is_one_name(enum scene_key key, const char *list, const struct robot *r)
{
	const char *comma = strchr(list, ','), *dot = has_kind(key) ? strchr(list, '.') : NULL, *name = dot ? dot + 1 : list;

	if (!comma || (dot && comma < dot))
		return !comma;
	return (key != SCENE_LOCK_ALL_BUT && robot_link(r, name) >= 0) ||
		((key == SCENE_LOCK_ALL_BUT || has_kind(key)) && robot_joint(r, name) >= 0);
}

/* ---- lists ---- */

/* "mass.hand:sample" is a name and a value. */
static enum rneagen_code split_freed(const struct scene *s, struct scene_choice *c, const struct robot *r, struct arena *a,
	struct rneagen_error *e)
{
	const char *at = strrchr(c->name, ':');

	if (!at || (strcmp(at, ":sample") && strcmp(at, ":batch")))
		return RNEAGEN_OK;
	if (at == c->name)
		return scene_refuse(s, c, e, "takes NAME, NAME:sample or NAME:batch, not '%.255s'", c->name);
	c->value = at + 1;
	c->name = settled(c->key, c->name, (size_t)(at - c->name), r, a);
	return c->name ? RNEAGEN_OK : error_memory(e);
}

/* One of the names of a line, or all that it has. */
static enum rneagen_code put_choice(struct scene *s, const struct scene_choice *line, const char *name, size_t length,
	const struct robot *r, struct arena *a, struct rneagen_error *e)
{
	struct scene_choice *c = &s->choices[s->count++];

	*c = *line;
	c->name = settled(c->key, name, length, r, a);
	if (!c->name)
		return error_memory(e);
	return SCENE_WORDS[c->key].kind == SCENE_FREED ? split_freed(s, c, r, a, e) : RNEAGEN_OK;
}

static enum rneagen_code expand_line(struct scene *s, struct scene_choice *line, const struct robot *r, struct arena *a,
	struct rneagen_error *e)
{
	enum scene_kind kind = SCENE_WORDS[line->key].kind;
	int is_list = kind == SCENE_NAMES || kind == SCENE_FREED;

	if (put_choice(s, line, line->name, strlen(line->name), r, a, e))
		return e->code;
	if (!is_list)
		line->name = s->choices[s->count - 1].name;
	if (!is_list || is_one_name(line->key, s->choices[s->count - 1].name, r))
		return RNEAGEN_OK;
	s->count--;
	for (const char *at = line->name; at;) {
		size_t length = strcspn(at, ",");

		if (put_choice(s, line, at, length, r, a, e))
			return e->code;
		if (!*s->choices[s->count - 1].name)
			return scene_refuse(s, line, e, "'%.255s' has an empty name", line->name);
		at = at[length] ? at + length + 1 : NULL;
	}
	return RNEAGEN_OK;
}

enum rneagen_code scene_expand(struct scene *s, const struct robot *r, struct arena *a, struct rneagen_error *e)
{
	size_t most = (size_t)s->line_count;

	for (int i = 0; i < s->line_count; i++) {
		for (const char *at = s->lines[i].name; *at; at++)
			most += *at == ',';
		if (most > LIMIT_CHOICES)
			return scene_refuse(s, &s->lines[i], e, "more than %d choices in the scene, of a list each name", LIMIT_CHOICES);
	}
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

/* ---- how a scene is written ---- */

void scene_put_option(const struct scene_choice *line, struct text *t)
{
	const struct scene_key_word *w = &SCENE_WORDS[line->key];
	struct text value;

	text_init(&value, t->arena);
	text_printf(&value, "%s%s%s", line->name, w->kind == SCENE_PAIR ? "=" : "", line->value ? line->value : "");
	t->failed |= value.failed;
	text_printf(t, "--%s", w->name);
	if (value.length) {
		text_putc(t, w->takes == 2 ? '=' : ' ');
		text_put_shell(t, text_string(&value));
	}
}
