/* A scene's text, line by line. */
#include "scene/scene_words.h"
#include "base/nearest.h"
#include <stdio.h>
#include <string.h>

struct reader {
	struct scene *s;
	struct arena *a;
	struct rneagen_error *e;
	size_t capacity;
	int line, told;   /* this line; the same in messages: 0 for an option */
	const char *file; /* whose lines these are; NULL: nobody's */
	int file_line;    /* of that file, or of all that are no options */
};

/* Where a comment begins: at a # that nothing or a blank stands before. */
static size_t without_comment(const char *line)
{
	size_t i = 0;

	for (; line[i]; i++)
		if (line[i] == '#' && (i == 0 || strchr(SCENE_BLANKS, line[i - 1])))
			break;
	return i;
}

static int find_key(const char *word, size_t length)
{
	for (int key = 0; key < SCENE_KEY_COUNT; key++)
		if (strlen(SCENE_WORDS[key].name) == length && !memcmp(SCENE_WORDS[key].name, word, length))
			return key;
	return -1;
}

/* Options that say how a text is written, and not what of the robot is modelled. */
#define OPTIONS " base bounded gravity layout limbs mimic name only order parts precision segments strict target trig "

/* Where a message says that something is. */
static const char *here(const struct reader *r)
{
	struct text t;

	text_init(&t, r->a);
	if (r->told && r->file)
		text_printf(&t, "%s:%d", r->file, r->told);
	else
		text_printf(&t, "%s: scene line %d", r->s->file, r->told ? r->told : r->line);
	return text_string(&t);
}

/* "friction=0.1" */
static int is_joined(const char *word)
{
	return strchr(word, '=') && find_key(word, strcspn(word, "=")) >= 0;
}

static enum rneagen_code refuse_word(const struct reader *r, const char *word, size_t length)
{
	const char *copy = arena_string(r->a, word, length), *meant;
	char whole[16];

	if (!copy)
		return error_memory(r->e);
	if (is_joined(copy))
		return error_set(r->e, RNEAGEN_SCENE, "%s: '%.255s': a blank stands between a word and its value: '%.*s %.255s'", here(r), copy,
			(int)strcspn(copy, "="), copy, strchr(copy, '=') + 1);
	if (snprintf(whole, sizeof whole, " %s ", copy) < (int)sizeof whole && strstr(OPTIONS, whole))
		return error_set(r->e, RNEAGEN_SCENE, "%s: '%s' is no word of a scene, but an option: --%s, in CMake a keyword, in Python %s=",
			here(r), copy, copy, copy);
	meant = nearest_name(copy, SCENE_WORDS, SCENE_KEY_COUNT, sizeof *SCENE_WORDS);
	return error_set(r->e, RNEAGEN_SCENE, "%s: '%.255s' is not known%s%s%s", here(r), copy, meant ? "; did you mean '" : "",
		meant ? meant : "", meant ? "'?" : "");
}

/* NAME=VALUE at the last =; of a frame that is added at the first, since its value has a link's name. */
static enum rneagen_code split(const struct reader *r, struct scene_choice *c, const char *value)
{
	const char *at = c->key == SCENE_ADD_FRAME ? strchr(value, '=') : strrchr(value, '=');

	if (!at && c->key == SCENE_ARMATURE)
		return scene_refuse(r->s, c, r->e, "takes JOINT=KG_M2, not '%.255s'; files are for the command, --armature FILE", value);
	if (!at || at == value || !at[1])
		return scene_refuse(r->s, c, r->e, "takes NAME=%s, not '%.255s'",
			c->key == SCENE_ADD_FRAME ? "LINK,x,y,z,r,p,y" : "VALUE", value);
	/* blanks at the ends of a name may be the name's: see settled, and request_add_frame for that of the value */
	c->name = arena_string(r->a, value, (size_t)(at - value));
	c->value = c->key == SCENE_ADD_FRAME ? arena_string(r->a, at + 1, strlen(at + 1)) : scene_trimmed(r->a, at + 1, strlen(at + 1));
	return c->name && c->value ? RNEAGEN_OK : error_memory(r->e);
}

/* One value cannot be chosen twice. */
static enum rneagen_code check_once(const struct reader *r, const struct scene_choice *c)
{
	enum scene_kind kind = SCENE_WORDS[c->key].kind;

	for (int i = 0; i < r->s->line_count && (kind == SCENE_VALUE || kind == SCENE_NAME); i++) {
		const struct scene_choice *other = &r->s->lines[i];

		if (other->key == c->key && !c->told && !other->told)
			return scene_refuse(r->s, c, r->e, "is given twice; give it once");
		if (other->key == c->key)
			return scene_refuse(r->s, c, r->e, "is also given %s; give it once", scene_place(other).s);
	}
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
	struct scene_choice c = {.key = key, .name = "", .line = r->line, .told = r->told, .from = r->file};
	struct scene_choice *wider;

	if (SCENE_WORDS[key].takes == 1 && !*value)
		return scene_refuse(r->s, &c, r->e, "needs a value");
	if (SCENE_WORDS[key].takes == 0 && *value)
		return scene_refuse(r->s, &c, r->e, "takes no value, and '%.255s' is one", value);
	if (check_once(r, &c) || check_word(r, &c, value))
		return r->e->code;
	if (SCENE_WORDS[key].kind == SCENE_PAIR)
		split(r, &c, value);
	else if (SCENE_WORDS[key].kind == SCENE_VALUE)
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
	const struct scene_choice c = {.key = key, .line = r->line, .told = r->told, .from = r->file};
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
	if (*s && strspn(s + 1, SCENE_BLANKS) == without_comment(s + 1))
		return value;
	scene_refuse(r->s, &c, r->e, "a value that begins with a quote must end with one: %.255s", quoted);
	return NULL;
}

/* What follows, up to the next option, are the lines of a file. */
static enum rneagen_code begin_file(struct reader *r, const char *name)
{
	const char *value = name + strspn(name, SCENE_BLANKS);

	r->file_line = 0;
	r->file = *value == '"' ? unquoted(r, SCENE_ROOT, value) : scene_trimmed(r->a, value, strlen(value));
	return r->file ? RNEAGEN_OK : r->e->code ? r->e->code : error_memory(r->e);
}

static enum rneagen_code read_choice(struct reader *r, const char *word)
{
	size_t length = strcspn(word, SCENE_BLANKS);
	int key = find_key(word, length);
	const char *value;

	if (key < 0)
		return refuse_word(r, word, length);
	value = word + length + strspn(word + length, SCENE_BLANKS);
	value = *value == '"' ? unquoted(r, (enum scene_key)key, value) : scene_trimmed(r->a, value, without_comment(value));
	if (!value)
		return r->e->code ? r->e->code : error_memory(r->e);
	return add_choice(r, (enum scene_key)key, value);
}

/* Editors may put a byte order mark before the first line. */
static const char MARK[] = "\xef\xbb\xbf";

static enum rneagen_code read_line(struct reader *r, const char *line, size_t length)
{
	const char *word;
	size_t blanks, mark = r->file_line == 0 && length >= 3 && !memcmp(line, MARK, 3) ? 3 : 0;

	line += mark;
	length -= mark;
	blanks = strspn(line, SCENE_BLANKS);
	r->line++;
	r->told = 0;
	if (blanks < length && !strncmp(line + blanks, "--", 2)) {
		word = scene_trimmed(r->a, line, length);
		if (word && !strncmp(word, SCENE_OF_FILE, strlen(SCENE_OF_FILE)))
			return begin_file(r, word + strlen(SCENE_OF_FILE));
		return word ? read_choice(r, word + 2) : error_memory(r->e);
	}
	r->told = ++r->file_line;
	if (blanks >= length || line[blanks] == '#')
		return RNEAGEN_OK;
	word = scene_trimmed(r->a, line, length);
	return word ? read_choice(r, word) : error_memory(r->e);
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
