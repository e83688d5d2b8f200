#define _POSIX_C_SOURCE 200809L
#include "urdf/precheck.h"
#include "urdf/walk.h"
#include <stdarg.h>
#include <stdio.h>
#include <string.h>
#include <strings.h>

long walk_line(const struct walk *w)
{
	return (long)XML_GetCurrentLineNumber(w->parser);
}

static void fail(struct walk *w, long line, enum rneagen_code code, const char *fmt, va_list ap)
{
	char what[sizeof w->diagnostic->error->message];

	vsnprintf(what, sizeof what, fmt, ap);
	diagnostic_error(w->diagnostic, code, line, "%s", what);
	XML_StopParser(w->parser, XML_FALSE);
}

void walk_fail(struct walk *w, enum rneagen_code code, const char *fmt, ...)
{
	va_list ap;

	va_start(ap, fmt);
	fail(w, walk_line(w), code, fmt, ap);
	va_end(ap);
}

void walk_fail_at(struct walk *w, long line, enum rneagen_code code, const char *fmt, ...)
{
	va_list ap;

	va_start(ap, fmt);
	fail(w, line, code, fmt, ap);
	va_end(ap);
}

/* Escaped so that every parser reads back the same value. */
static void copy_value(struct text *t, const char *s)
{
	for (; *s; s++)
		if (strchr("&<>\"'", *s) || (unsigned char)*s < 0x20)
			text_printf(t, "&#%d;", *s);
		else
			text_putc(t, *s);
}

/* What urdfdom reads, of whatever element: it looks through all attributes of an element at each new one. */
static int is_read(const char *attribute)
{
	static const char *const known[] = {"name", "version", "type", "link", "joint", "xyz", "rpy", "value", "ixx",
		"ixy", "ixz", "iyy", "iyz", "izz", "effort", "velocity", "lower", "upper", "damping", "friction",
		"multiplier", "offset", "soft_lower_limit", "soft_upper_limit", "k_position", "k_velocity",
		"reference_position", "rising", "falling"};

	for (size_t i = 0; i < sizeof known / sizeof *known; i++)
		if (!strcmp(attribute, known[i]))
			return 1;
	return 0;
}

static void copy_tag(struct text *t, const char *element, const char *const *attributes)
{
	text_printf(t, "<%s", element);
	for (; *attributes; attributes += 2) {
		if (!is_read(attributes[0]))
			continue;
		text_printf(t, " %s=\"", attributes[0]);
		copy_value(t, attributes[1]);
		text_put(t, "\"");
	}
	text_put(t, ">");
}

#define XACRO_ADVICE "the file is xacro, not yet URDF; run xacro on it and give the result"

static void refuse_expressions(struct walk *w, const char *element, const char *const *attributes)
{
	for (; *attributes; attributes += 2)
		if (strstr(attributes[1], "${") || strstr(attributes[1], "$("))
			walk_fail(w, RNEAGEN_XACRO, "%s '%s': <%s> %s=\"%.100s\": " XACRO_ADVICE, w->owner,
				w->owner_name, element, attributes[0], attributes[1]);
}

static void XMLCALL on_start(void *data, const XML_Char *element, const XML_Char **attributes)
{
	struct walk *w = data;
	const char *const *values = (const char *const *)attributes;
	enum place place = SKIPPED;

	if (w->diagnostic->error->code)
		return;
	if (w->depth == LIMIT_XML_DEPTH) {
		walk_fail(w, RNEAGEN_LIMIT, "elements are nested more than %d deep; a URDF needs about 5",
			LIMIT_XML_DEPTH);
		return;
	}
	if (!strncmp(element, "xacro:", 6))
		walk_fail(w, RNEAGEN_XACRO, "<%.100s>: " XACRO_ADVICE, element);
	if (w->places[w->depth] < VALUE)
		refuse_expressions(w, element, values);
	if (!w->diagnostic->error->code)
		place = elements_enter(w, element, values);
	w->places[++w->depth] = place;
	if (place != SKIPPED)
		copy_tag(&w->outline->urdf, element, values);
	if (w->diagnostic->arena->failed) {
		error_memory(w->diagnostic->error);
		XML_StopParser(w->parser, XML_FALSE);
	}
}

static void XMLCALL on_end(void *data, const XML_Char *element)
{
	struct walk *w = data;
	enum place place;

	if (w->diagnostic->error->code)
		return;
	place = w->places[w->depth--];
	if (place == INERTIAL)
		values_end_inertial(w);
	if (place == JOINT)
		values_end_joint(w);
	if (place == LINK || place == JOINT)
		elements_leave(w);
	if (place != SKIPPED)
		text_printf(&w->outline->urdf, "</%s>\n", element);
}

/* At the first sign of it, before any entity can be expanded or any other file be meant. */
static void XMLCALL on_doctype(
	void *data, const XML_Char *name, const XML_Char *system, const XML_Char *public, int subset)
{
	(void)name;
	if (system || public || subset)
		walk_fail(data, RNEAGEN_XML, "a DOCTYPE with declarations is not read; remove it");
}

static void XMLCALL on_declaration(void *data, const XML_Char *version, const XML_Char *encoding, int standalone)
{
	static const char *const known[] = {"UTF-8", "UTF8", "US-ASCII", "ASCII"};

	(void)standalone;
	if (!version || !encoding)
		return;
	for (size_t i = 0; i < sizeof known / sizeof *known; i++)
		if (!strcasecmp(encoding, known[i]))
			return;
	walk_fail(data, RNEAGEN_XML, "the encoding \"%.60s\" is not supported; convert the file to UTF-8", encoding);
}

/* What can be said of the bytes before any parse. */
static enum rneagen_code check_bytes(const char *xml, size_t length, const struct diagnostic *p)
{
	const char *nul = length ? memchr(xml, '\0', length) : NULL;

	if (!length)
		return diagnostic_error(p, RNEAGEN_XML, 0, "the file is empty; give a URDF");
	if (length > LIMIT_FILE_BYTES)
		return diagnostic_error(p, RNEAGEN_LIMIT, 0,
			"%zu bytes, and at most %d are read; leave out what is not needed", length, LIMIT_FILE_BYTES);
	if (length > 1 && (!memcmp(xml, "\xff\xfe", 2) || !memcmp(xml, "\xfe\xff", 2) || !memcmp(xml, "<\0", 2) ||
				  !memcmp(xml, "\0<", 2)))
		return diagnostic_error(p, RNEAGEN_XML, 0, "the file is UTF-16; convert it to UTF-8");
	if (nul)
		return diagnostic_error(p, RNEAGEN_XML, 0, "byte %zu is NUL; give plain text", (size_t)(nul - xml));
	return RNEAGEN_OK;
}

/* The parse stopped, and not by walk_fail: expat's own errors. */
static void fail_expat(struct walk *w, size_t length)
{
	enum XML_Error code = XML_GetErrorCode(w->parser);
	XML_Index at = XML_GetCurrentByteIndex(w->parser);
	int in_file = at >= 0 && (size_t)at < length;

	if (code == XML_ERROR_NO_MEMORY)
		error_memory(w->diagnostic->error);
	else if (code == XML_ERROR_INVALID_TOKEN && in_file && (unsigned char)w->xml[at] >= 0x80)
		walk_fail(w, RNEAGEN_XML, "byte 0x%02x is not UTF-8; convert the file to UTF-8",
			(unsigned char)w->xml[at]);
	else
		walk_fail(w, RNEAGEN_XML, "not well-formed XML: %s%s", XML_ErrorString(code),
			in_file || !w->depth ? "" : ": the file ends too early");
}

enum rneagen_code precheck(struct outline *o, const char *xml, size_t length, const struct diagnostic *p)
{
	struct walk w = {.outline = o, .xml = xml, .diagnostic = p, .owner = "robot", .owner_name = ""};

	*o = (struct outline){.name = ""};
	text_init(&o->urdf, p->arena);
	text_put(&o->urdf, "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n");
	if (check_bytes(xml, length, p))
		return p->error->code;
	w.parser = XML_ParserCreate("UTF-8");
	if (!w.parser)
		return error_memory(p->error);
	XML_SetUserData(w.parser, &w);
	XML_SetElementHandler(w.parser, on_start, on_end);
	XML_SetStartDoctypeDeclHandler(w.parser, on_doctype);
	XML_SetXmlDeclHandler(w.parser, on_declaration);
	if (XML_Parse(w.parser, xml, (int)length, 1) != XML_STATUS_OK && !p->error->code)
		fail_expat(&w, length);
	XML_ParserFree(w.parser);
	if (p->arena->failed)
		error_memory(p->error);
	return p->error->code;
}
