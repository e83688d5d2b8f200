#include "cli/options.h"
#include "base/nearest.h"
#include "cli/files.h"
#include "base/number.h"
#include "scene/scene_lines.h"
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

int option_refuse(const char *command, const char *fmt, ...)
{
	va_list ap;

	fprintf(stderr, "%s: ", command);
	va_start(ap, fmt);
	vfprintf(stderr, fmt, ap);
	va_end(ap);
	fprintf(stderr, "; see %s --help\n", command);
	return 2;
}

int option_refuse_meant(const char *command, const char *kind, const char *word, const char *dashes, const char *meant)
{
	fprintf(stderr, "%s: %s '%s' is not known; did you mean '%s%s'?\n", command, kind, word, dashes, meant);
	return 2;
}

enum { LEAST_LETTERS = 3 }; /* of a name that is taken for another, misspelt */

/* Of an option that getopt_long did not take: another one's name, a name with a value that it does not take, or neither. */
static int refuse_unknown(const char *command, const char *word, const struct option *options)
{
	char name[64];
	size_t count = 0, length = strncmp(word, "--", 2) ? 0 : strcspn(word + 2, "=");
	const char *meant;

	snprintf(name, sizeof name, "%.*s", (int)(length < sizeof name ? length : 0), word + 2);
	while (options[count].name)
		count++;
	meant = strlen(name) >= LEAST_LETTERS ? nearest_name(name, options, count, sizeof *options) : NULL;
	if (!meant)
		return option_refuse(command, "option '%s' is not known", word);
	if (!strcmp(meant, name))
		return option_refuse(command, "option '--%s' takes no value", name);
	return option_refuse_meant(command, "option", word, "--", meant);
}

int option_refuse_key(const char *command, int key, const char *word, const struct option *options)
{
	return key == ':' ? option_refuse(command, "option '%s' needs a value", word) : refuse_unknown(command, word, options);
}

int option_choose(
	const char *command, const char *option, const char *word, const struct option_choice *choices, int *value)
{
	char known[128] = "";

	for (const struct option_choice *c = choices; c->name; c++) {
		if (!strcmp(word, c->name)) {
			*value = c->value;
			return 0;
		}
		strncat(known, *known ? "|" : "", sizeof known - strlen(known) - 1);
		strncat(known, c->name, sizeof known - strlen(known) - 1);
	}
	return option_refuse(command, "--%s takes %s, not '%s'", option, known, word);
}

static int parse_gravity(const char *command, const char *word, double gravity[3])
{
	const char *s = word;

	for (int i = 0; i < 3; i++) {
		char *end;

		gravity[i] = strtod(s, &end);
		if (end == s || *end != (i < 2 ? ',' : '\0') || !(gravity[i] - gravity[i] == 0))
			return option_refuse(command, "--gravity takes three finite numbers X,Y,Z, not '%s'", word);
		s = end + 1;
	}
	return 0;
}

/* Options that take a number, or "auto", which is 0, or another word. */
static const struct counted {
	const char *name, *takes;
	long least, most;
	const char *word;
	int value; /* of the word */
} PARTS = {"parts", "a number from 1 to 65535, or auto", 1, 65535, "auto", RNEAGEN_PARTS_AUTO},
  SEGMENTS = {"segments", "a number of operations from 20 to 1000000, auto or whole", 20, 1000000, "whole",
	RNEAGEN_SEGMENTS_WHOLE},
  LIMBS = {"limbs", "a number of warps from 2 to 16, auto or none", 2, 16, "none", RNEAGEN_LIMBS_NONE};

static int parse_count(const char *command, const struct counted *c, const char *word, int *value)
{
	char *end;
	long n = strtol(word, &end, 10);

	*value = !strcmp(word, "auto") ? 0 : !strcmp(word, c->word) ? c->value : (int)n;
	if (!strcmp(word, "auto") || !strcmp(word, c->word))
		return 0;
	if (end == word || *end || n < c->least || n > c->most)
		return option_refuse(command, "--%s takes %s, not '%s'", c->name, c->takes, word);
	return 0;
}

/* Options that take one word of a few, from OPTION_TARGET to OPTION_DUMP. */
static const struct choice {
	const char *option;
	struct option_choice words[12];
} CHOICES[] = {
#define TARGET_WORD(name, word) {word, RNEAGEN_TARGET_##name},
#define PRECISION_WORD(name, word) {word, RNEAGEN_##name},
	{"target", {RNEAGEN_TARGETS(TARGET_WORD)}},
	{"precision", {RNEAGEN_PRECISIONS(PRECISION_WORD)}},
#undef TARGET_WORD
#undef PRECISION_WORD
	{"layout", {{"soa", RNEAGEN_SOA}, {"aos", RNEAGEN_AOS}}},
	{"trig", {{"accurate", RNEAGEN_ACCURATE}, {"bounded", RNEAGEN_BOUNDED}, {"fast", RNEAGEN_FAST}}},
	{"base", {{"fixed", RNEAGEN_FIXED}, {"floating", RNEAGEN_FLOATING}}},
	{"mimic", {{"honour", RNEAGEN_MIMIC_HONOUR}, {"independent", RNEAGEN_MIMIC_INDEPENDENT}}},
	{"dump",
		{{"robot", RNEAGEN_DUMP_ROBOT}, {"scene", RNEAGEN_DUMP_SCENE}, {"tree", RNEAGEN_DUMP_TREE},
			{"params", RNEAGEN_DUMP_PARAMS}, {"request", RNEAGEN_DUMP_REQUEST}, {"dag", RNEAGEN_DUMP_DAG},
			{"plan", RNEAGEN_DUMP_PLAN}, {"parts", RNEAGEN_DUMP_PARTS}, {"segments", RNEAGEN_DUMP_SEGMENTS},
			{"limbs", RNEAGEN_DUMP_LIMBS}, {"kernels", RNEAGEN_DUMP_KERNELS}, {"passes", RNEAGEN_DUMP_PASSES}}},
};

static void set_choice(struct rneagen_options *o, int key, int value)
{
	switch (key) {
	case OPTION_TARGET:
		o->target = (enum rneagen_target)value;
		break;
	case OPTION_PRECISION:
		o->precision = (enum rneagen_precision)value;
		break;
	case OPTION_LAYOUT:
		o->layout = (enum rneagen_layout)value;
		break;
	case OPTION_TRIG:
		o->trig = (enum rneagen_trig)value;
		break;
	case OPTION_BASE:
		o->base = (enum rneagen_base)value;
		break;
	case OPTION_MIMIC:
		o->mimic = (enum rneagen_mimic)value;
		break;
	default:
		o->dump = (enum rneagen_dump)value;
	}
}

/* Lengthen the scene by a line or more. */
static int add_scene(const char *command, struct rneagen_options *o, const char *lines, size_t length)
{
	size_t before = o->scene ? strlen(o->scene) : 0;
	char *s = lines ? realloc((char *)o->scene, before + length + 2) : NULL;

	if (!s) {
		fprintf(stderr, "%s: out of memory\n", command);
		return 1;
	}
	memcpy(s + before, lines, length);
	strcpy(s + before + length, "\n");
	o->scene = s;
	return 0;
}

static int add_text(const char *command, struct rneagen_options *o, const struct text *lines)
{
	return add_scene(command, o, lines->failed ? NULL : text_string(lines), lines->length);
}

/* The first line of a text that begins with dashes, as options do; NULL where none does. */
static const char *find_dashes(const char *text)
{
	for (; text; text = strchr(text, '\n')) {
		text += strspn(text, " \t\r\n");
		if (!strncmp(text, "--", 2))
			return text;
	}
	return NULL;
}

/* A whole file as a string; 1 and a message if it cannot be read, or is no text. */
static int read_text(const char *command, const char *path, struct file_content *f)
{
	struct rneagen_error e = {0};
	char *text;

	if (file_read(path, f, &e))
		fprintf(stderr, "%s: %s\n", command, e.message);
	else if (f->length && memchr(f->bytes, '\0', f->length))
		fprintf(stderr, "%s: %s: holds a byte of 0, and is to be a text\n", command, path);
	else if (!(text = realloc(f->bytes, f->length + 1)))
		fprintf(stderr, "%s: out of memory\n", command);
	else {
		text[f->length] = '\0';
		f->bytes = text;
		return 0;
	}
	return 1;
}

/* The line that names a file, before its own. */
static int add_file_name(const char *command, struct rneagen_options *o, const char *path)
{
	struct arena a;
	struct text line;
	int bad;

	arena_init(&a, NULL);
	text_init(&line, &a);
	scene_put_file(path, &line);
	bad = add_text(command, o, &line);
	arena_free(&a);
	return bad;
}

static int take_scene_file(const char *command, struct rneagen_options *o, const char *path)
{
	struct file_content f = {0};
	const char *dashes;
	int bad = read_text(command, path, &f) || add_file_name(command, o, path);
	size_t begin = o->scene ? strlen(o->scene) : 0;

	bad = bad || add_scene(command, o, f.bytes, f.length);
	free(f.bytes);
	dashes = bad ? NULL : find_dashes(o->scene + begin);
	return dashes ? option_refuse(command, "%s: '%.*s': in a file choices stand without their dashes", path,
				(int)strcspn(dashes, " \t\r\n"), dashes)
		      : bad;
}

static int take_scene_line(const char *command, struct rneagen_options *o, enum scene_key key, const char *value)
{
	struct arena a;
	struct text line;
	int bad;

	arena_init(&a, NULL);
	text_init(&line, &a);
	scene_put_line(key, value, &line);
	bad = add_text(command, o, &line);
	arena_free(&a);
	return bad;
}

/* A file of rotor inertias, one joint on a line. */
static int take_armature(const char *command, struct rneagen_options *o, const char *path)
{
	struct file_content f = {0};
	struct rneagen_error e = {0};
	struct arena a;
	struct text lines;
	int bad;

	if (!option_file(OPTION_SCENE + SCENE_ARMATURE, path))
		return take_scene_line(command, o, SCENE_ARMATURE, path);
	bad = read_text(command, path, &f);
	arena_init(&a, NULL);
	text_init(&lines, &a);
	if (!bad && scene_put_armature(path, f.bytes, &lines, &e) == RNEAGEN_SCENE)
		bad = option_refuse(command, "%s", e.message);
	if (!bad && (lines.failed || lines.length))
		bad = add_text(command, o, &lines);
	arena_free(&a);
	free(f.bytes);
	return bad;
}

/* --qd-range X is --range qd=-X,X. */
static int take_short_range(const char *command, struct rneagen_options *o, const char *input, const char *word)
{
	char line[256];
	struct within x;

	if (strlen(word) > 100 || !strchr("0123456789.", *word) || number_read(word, &x, 1) || x.x <= 0)
		return option_refuse(command, "--%s-range takes a positive number, not '%.255s'", input, word);
	snprintf(line, sizeof line, "%s=-%s,%s", input, word, word);
	return take_scene_line(command, o, SCENE_RANGE, line);
}

const char *option_file(int key, const char *word)
{
	if (key == OPTION_SCENE + SCENE_ARMATURE)
		return strchr(word, '=') ? NULL : word;
	return key == OPTION_SCENE_FILE ? word : NULL;
}

void option_free(struct rneagen_options *o)
{
	free((char *)o->scene);
	o->scene = NULL;
}

int option_at_fault(enum rneagen_code code)
{
	return code == RNEAGEN_USAGE || code == RNEAGEN_NAME || code == RNEAGEN_SCENE;
}

int option_generate(const char *command, struct rneagen_options *o, int key, const char *word)
{
	const struct choice *c;
	int value = 0, bad;

	if (key == OPTION_GRAVITY)
		return parse_gravity(command, word, o->gravity);
	if (key == OPTION_ORDER) {
		o->order = word;
		return 0;
	}
	if (key == OPTION_STRICT) {
		o->strict = 1;
		return 0;
	}
	if (key == OPTION_PARTS)
		return parse_count(command, &PARTS, word, &o->parts);
	if (key == OPTION_SEGMENTS)
		return parse_count(command, &SEGMENTS, word, &o->segments);
	if (key == OPTION_LIMBS)
		return parse_count(command, &LIMBS, word, &o->limbs);
	if (key == OPTION_QD_RANGE || key == OPTION_QDD_RANGE)
		return take_short_range(command, o, key == OPTION_QD_RANGE ? "qd" : "qdd", word);
	if (key == OPTION_SCENE_FILE)
		return take_scene_file(command, o, word);
	if (key == OPTION_SCENE + SCENE_ARMATURE)
		return take_armature(command, o, word);
	if (key >= OPTION_SCENE && key < OPTION_SCENE + SCENE_KEY_COUNT)
		return take_scene_line(command, o, (enum scene_key)(key - OPTION_SCENE), word);
	if (key < OPTION_TARGET || key > OPTION_DUMP)
		return -1;
	c = &CHOICES[key - OPTION_TARGET];
	bad = option_choose(command, c->option, word, c->words, &value);
	if (!bad)
		set_choice(o, key, value);
	return bad;
}
