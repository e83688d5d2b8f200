#include "scene/scene.h"
#include "base/nearest.h"
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
	if (!c->told)
		return error_set(e, RNEAGEN_SCENE, "%s: --%s: %s", s->file, WORDS[c->key].name, what);
	return error_set(e, RNEAGEN_SCENE, "%s: scene line %d, %s: %s", s->file, c->told, WORDS[c->key].name, what);
}

struct scene_place scene_place(const struct scene_choice *c)
{
	struct scene_place p = {"by an option"};

	if (c->told)
		snprintf(p.s, sizeof p.s, "in line %d", c->told);
	return p;
}

/* ---- reading ---- */

struct reader {
	struct scene *s;
	struct arena *a;
	struct rneagen_error *e;
	size_t capacity;
	int line, told, options; /* this line; the same in messages; lines so far that are options */
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

/* Where a comment begins: at a # that nothing or a blank stands before. */
static size_t without_comment(const char *line)
{
	size_t i = 0;

	for (; line[i]; i++)
		if (line[i] == '#' && (i == 0 || strchr(BLANKS, line[i - 1])))
			break;
	return i;
}

static int find_key(const char *word, size_t length)
{
	for (int key = 0; key < SCENE_KEY_COUNT; key++)
		if (strlen(WORDS[key].name) == length && !memcmp(WORDS[key].name, word, length))
			return key;
	return -1;
}

/* Options that say how a text is written, and not what of the robot is modelled. */
#define OPTIONS " base bounded gravity layout limbs mimic name only order parts precision segments strict target trig "

static enum rneagen_code refuse_word(const struct reader *r, const char *word, size_t length)
{
	const char *copy = arena_string(r->a, word, length), *meant;
	int line = r->told ? r->told : r->line;
	char whole[16];

	if (!copy)
		return error_memory(r->e);
	if (snprintf(whole, sizeof whole, " %s ", copy) < (int)sizeof whole && strstr(OPTIONS, whole))
		return error_set(r->e, RNEAGEN_SCENE, "%s: scene line %d: '%s' is no word of a scene, but an option: --%s, in CMake a keyword, "
			"in Python %s=", r->s->file, line, copy, copy, copy);
	meant = nearest_name(copy, WORDS, SCENE_KEY_COUNT, sizeof *WORDS);
	return error_set(r->e, RNEAGEN_SCENE, "%s: scene line %d: '%.255s' is not known%s%s%s", r->s->file, line, copy,
		meant ? "; did you mean '" : "", meant ? meant : "", meant ? "'?" : "");
}

/* NAME=VALUE at the last =; of a frame that is added at the first, since its value has a link's name. */
static enum rneagen_code split(const struct reader *r, struct scene_choice *c, const char *value)
{
	const char *at = c->key == SCENE_ADD_FRAME ? strchr(value, '=') : strrchr(value, '=');

	if (!at || at == value || !at[1])
		return scene_refuse(r->s, c, r->e, "takes NAME=%s, not '%.255s'",
			c->key == SCENE_ADD_FRAME ? "LINK,x,y,z,r,p,y" : "VALUE", value);
	/* blanks at the ends of a name may be the name's: see settled, and request_add_frame for that of the value */
	c->name = arena_string(r->a, value, (size_t)(at - value));
	c->value = c->key == SCENE_ADD_FRAME ? arena_string(r->a, at + 1, strlen(at + 1)) : trimmed(r->a, at + 1, strlen(at + 1));
	return c->name && c->value ? RNEAGEN_OK : error_memory(r->e);
}

/* One value cannot be chosen twice. */
static enum rneagen_code check_once(const struct reader *r, const struct scene_choice *c)
{
	enum scene_kind kind = WORDS[c->key].kind;

	for (int i = 0; i < r->s->line_count && (kind == SCENE_VALUE || kind == SCENE_NAME); i++)
		if (r->s->lines[i].key == c->key)
			return scene_refuse(r->s, c, r->e, "is also given %s; give it once", scene_place(&r->s->lines[i]).s);
	return RNEAGEN_OK;
}

/* One of a few words. */
static enum rneagen_code check_word(const struct reader *r, const struct scene_choice *c, const char *value)
{
	static const char *const words[SCENE_KEY_COUNT][3] = {
		[SCENE_BESIDE] = {"lock", "drop"}, [SCENE_FEXT_FRAME] = {"link", "world"},
		[SCENE_DERIVATIVES] = {"forward", "recursion"}, [SCENE_DYNAMICS] = {"auto", "factor", "articulated"},
		[SCENE_PARAMS] = {"base", "auto", "urdf"}, [SCENE_POSE] = {"rows", "quaternion"},
		[SCENE_FRAME] = {"world", "world-aligned", "link"}};
	const char *const *w = words[c->key];

	for (int i = 0; i < 3 && w[i]; i++)
		if (!strcmp(value, w[i]))
			return RNEAGEN_OK;
	if (!*w)
		return RNEAGEN_OK;
	return scene_refuse(r->s, c, r->e, "takes %s%s%s or %s, not '%.255s'", w[2] ? w[2] : "", w[2] ? ", " : "",
		w[0], w[1], value);
}

static enum rneagen_code add_choice(struct reader *r, enum scene_key key, const char *value)
{
	struct scene_choice c = {.key = key, .name = "", .line = r->line, .told = r->told};
	struct scene_choice *wider;

	if (WORDS[key].takes == 1 && !*value)
		return scene_refuse(r->s, &c, r->e, "needs a value");
	if (WORDS[key].takes == 0 && *value)
		return scene_refuse(r->s, &c, r->e, "takes no value, and '%.255s' is one", value);
	if (check_once(r, &c) || check_word(r, &c, value))
		return r->e->code;
	if (WORDS[key].kind == SCENE_PAIR)
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

/* What stands between quotes, behind which only a comment may follow; \" is a quote, \\ a backslash, \n a line break. */
static const char *unquoted(const struct reader *r, enum scene_key key, const char *quoted)
{
	const struct scene_choice c = {.key = key, .line = r->line, .told = r->told};
	char *value = arena_string(r->a, quoted, strlen(quoted)), *to = value;
	const char *s = quoted + 1;

	if (!value) {
		error_memory(r->e);
		return NULL;
	}
	for (; *s && *s != '"'; s++) {
		int is_break = *s == '\\' && s[1] == 'n';

		s += *s == '\\' && (s[1] == '"' || s[1] == '\\' || s[1] == 'n');
		*to++ = is_break ? '\n' : *s;
	}
	*to = '\0';
	if (*s && strspn(s + 1, BLANKS) == without_comment(s + 1))
		return value;
	scene_refuse(r->s, &c, r->e, "a value that begins with a quote must end with one: %.255s", quoted);
	return NULL;
}

static enum rneagen_code read_line(struct reader *r, const char *line, size_t length)
{
	size_t blanks = strspn(line, BLANKS);
	const char *word, *value;
	int key, is_option;

	r->line++;
	if (blanks >= length || line[blanks] == '#')
		return RNEAGEN_OK;
	word = trimmed(r->a, line, length);
	if (!word)
		return error_memory(r->e);
	is_option = !strncmp(word, "--", 2);
	r->options += is_option;
	r->told = is_option ? 0 : r->line - r->options;
	word += is_option ? 2 : 0;
	length = strcspn(word, BLANKS);
	key = find_key(word, length);
	if (key < 0)
		return refuse_word(r, word, length);
	value = word + length + strspn(word + length, BLANKS);
	value = *value == '"' ? unquoted(r, (enum scene_key)key, value) : trimmed(r->a, value, without_comment(value));
	if (!value)
		return r->e->code ? r->e->code : error_memory(r->e);
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

/* Has a choice of this key the robot's name after a dot? */
static int has_kind(enum scene_key key)
{
	return key == SCENE_FOLD || key == SCENE_WANT || key == SCENE_FREE || key == SCENE_JVP ||
		key == SCENE_VJP || key == SCENE_BY;
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
	return trimmed(a, word, length);
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
	return WORDS[c->key].kind == SCENE_FREED ? split_freed(s, c, r, a, e) : RNEAGEN_OK;
}

static enum rneagen_code expand_line(struct scene *s, struct scene_choice *line, const struct robot *r, struct arena *a,
	struct rneagen_error *e)
{
	enum scene_kind kind = WORDS[line->key].kind;
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
	const struct word *w = &WORDS[line->key];
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
