#define _POSIX_C_SOURCE 200809L
#include "reference/read.h"

#include <expat.h>
#include <locale.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { NAME_SIZE = 32 };

struct reader {
	struct raw_robot *raw;
	int depth;
	char section[NAME_SIZE], part[NAME_SIZE];	// the open elements at depths 1 and 2
	char *message;
	size_t size;
	bool decimals, failed;
};

void *raw_memory(void *old, size_t count, size_t size)
{
	void *p = size && count > SIZE_MAX / size ? NULL : realloc(old, count * size + 1);

	if (!p)
		abort();
	return p;
}

char *raw_copy(const char *s)
{
	size_t n = strlen(s) + 1;

	return memcpy(raw_memory(NULL, n, 1), s, n);
}

static void fail(struct reader *x, const char *what, const char *where)
{
	if (!x->failed)
		snprintf(x->message, x->size, "%s: %s", where, what);
	x->failed = true;
}

static const char *attribute(const char **attributes, const char *key)
{
	for (; *attributes; attributes += 2)
		if (!strcmp(attributes[0], key))
			return attributes[1];
	return NULL;
}

static char *needed(struct reader *x, const char **attributes, const char *key)
{
	const char *value = attribute(attributes, key);

	if (!value)
		fail(x, "missing attribute", key);
	return raw_copy(value ? value : "");
}

static void numbers(struct reader *x, const char **attributes, const char *key, int n, wide *out)
{
	const char *s = attribute(attributes, key);

	for (int i = 0; s && i < n; i++) {
		char *end;

		out[i] = x->decimals ? wide_read(s, &end) : (wide)strtod(s, &end);
		if (end == s)
			fail(x, "not a number", key);
		s = end;
	}
}

static void begin_link(struct reader *x, const char **attributes)
{
	struct raw_robot *raw = x->raw;

	raw->links = raw_memory(raw->links, (size_t)raw->nlinks + 1, sizeof *raw->links);
	raw->links[raw->nlinks++] = (struct raw_link){.name = needed(x, attributes, "name")};
}

static void begin_joint(struct reader *x, const char **attributes)
{
	struct raw_robot *raw = x->raw;

	raw->joints = raw_memory(raw->joints, (size_t)raw->njoints + 1, sizeof *raw->joints);
	raw->joints[raw->njoints++] = (struct raw_joint){
		.name = needed(x, attributes, "name"),
		.type = needed(x, attributes, "type"),
		.axis = {1, 0, 0},
		.multiplier = 1,
	};
}

static void in_inertial(struct reader *x, const char *element, const char **attributes)
{
	static const char *const entries[6] = {"ixx", "ixy", "ixz", "iyy", "iyz", "izz"};
	struct raw_link *l = &x->raw->links[x->raw->nlinks - 1];

	if (!strcmp(element, "mass"))
		numbers(x, attributes, "value", 1, &l->mass);
	if (!strcmp(element, "origin")) {
		numbers(x, attributes, "xyz", 3, l->xyz);
		numbers(x, attributes, "rpy", 3, l->rpy);
	}
	for (int i = 0; i < 6 && !strcmp(element, "inertia"); i++)
		numbers(x, attributes, entries[i], 1, &l->inertia[i]);
}

static void replace(char **old, char *value)
{
	free(*old);
	*old = value;
}

static void in_joint(struct reader *x, const char *element, const char **attributes)
{
	struct raw_joint *j = &x->raw->joints[x->raw->njoints - 1];

	if (!strcmp(element, "origin")) {
		numbers(x, attributes, "xyz", 3, j->xyz);
		numbers(x, attributes, "rpy", 3, j->rpy);
	} else if (!strcmp(element, "axis")) {
		numbers(x, attributes, "xyz", 3, j->axis);
	} else if (!strcmp(element, "parent")) {
		replace(&j->parent, needed(x, attributes, "link"));
	} else if (!strcmp(element, "child")) {
		replace(&j->child, needed(x, attributes, "link"));
	} else if (!strcmp(element, "limit")) {
		numbers(x, attributes, "lower", 1, &j->lower);
		numbers(x, attributes, "upper", 1, &j->upper);
	} else if (!strcmp(element, "dynamics")) {
		numbers(x, attributes, "damping", 1, &j->damping);
		numbers(x, attributes, "friction", 1, &j->friction);
	} else if (!strcmp(element, "mimic")) {
		replace(&j->mimic, needed(x, attributes, "joint"));
		numbers(x, attributes, "multiplier", 1, &j->multiplier);
		numbers(x, attributes, "offset", 1, &j->offset);
	}
}

static void open_element(void *user, const char *element, const char **attributes)
{
	struct reader *x = user;
	int depth = x->depth++;

	if (x->failed)
		return;
	if (depth == 0 && strcmp(element, "robot")) {
		fail(x, "the outermost element is not <robot>", element);
	} else if (depth == 1) {
		snprintf(x->section, sizeof x->section, "%s", element);
		if (!strcmp(element, "link"))
			begin_link(x, attributes);
		if (!strcmp(element, "joint"))
			begin_joint(x, attributes);
	} else if (depth == 2) {
		snprintf(x->part, sizeof x->part, "%s", element);
		if (!strcmp(x->section, "joint"))
			in_joint(x, element, attributes);
	} else if (depth == 3 && !strcmp(x->section, "link") && !strcmp(x->part, "inertial")) {
		in_inertial(x, element, attributes);
	}
}

static void close_element(void *user, const char *element)
{
	(void)element;
	((struct reader *)user)->depth--;
}

static void parse(struct reader *x, const char *urdf, size_t length)
{
	XML_Parser parser = XML_ParserCreate(NULL);

	if (!parser)
		abort();
	XML_SetUserData(parser, x);
	XML_SetElementHandler(parser, open_element, close_element);
	if (length > INT32_MAX || XML_Parse(parser, urdf, (int)length, 1) != XML_STATUS_OK)
		fail(x, XML_ErrorString(XML_GetErrorCode(parser)), "XML");
	XML_ParserFree(parser);
}

static void check_complete(struct reader *x)
{
	for (int i = 0; i < x->raw->njoints && !x->failed; i++)
		if (!x->raw->joints[i].parent || !x->raw->joints[i].child)
			fail(x, "joint without parent or child", x->raw->joints[i].name);
}

bool raw_read(struct raw_robot *raw, const char *urdf, size_t length, bool decimals, char *message, size_t size)
{
	struct reader x = {.raw = raw, .decimals = decimals, .message = message, .size = size};
	locale_t c = newlocale(LC_ALL_MASK, "C", (locale_t)0), old = uselocale(c);

	*raw = (struct raw_robot){0};
	parse(&x, urdf, length);
	check_complete(&x);
	uselocale(old);
	freelocale(c);
	return !x.failed;
}

void raw_free(struct raw_robot *raw)
{
	for (int i = 0; i < raw->nlinks; i++)
		free(raw->links[i].name);
	for (int i = 0; i < raw->njoints; i++) {
		struct raw_joint *j = &raw->joints[i];

		free(j->name);
		free(j->type);
		free(j->parent);
		free(j->child);
		free(j->mimic);
	}
	free(raw->links);
	free(raw->joints);
	*raw = (struct raw_robot){0};
}
