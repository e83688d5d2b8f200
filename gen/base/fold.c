/* Lines within the margin: a longer one goes on in the next, where C lets it. */
#include "base/fold.h"
#include <string.h>

enum { TAB = 8, LONGEST_INDENT = 64 };

enum place { IN_CODE, IN_COMMENT, IN_STRING };

/* A line, or what is left of it. */
struct line_rest {
	const char *s;
	size_t length;
	size_t column;    /* at which s begins */
	enum place place; /* in which s begins */
	int is_directive;
	/* a string that ends a line of a table: others may stand in lists, where two in a row look like a mistake */
	int is_table;
};

/* Where to cut: what is kept ends at `end`, what goes on begins at `next`; next 0: nowhere. */
struct cut {
	size_t end, next;
	enum place place;
};

static size_t column_after(size_t column, char c)
{
	return c == '\t' ? (column / TAB + 1) * TAB : column + 1;
}

static int starts(const struct line_rest *r, size_t i, const char *word)
{
	size_t n = strlen(word);

	return i + n <= r->length && !memcmp(r->s + i, word, n);
}

/* Before an operator between blanks, or after a comma. */
static int is_strong(const struct line_rest *r, size_t i)
{
	static const char *const before[] = {" + ", " - ", " && ", " || ", " ? ", " : ", " = ", " /* "};

	for (size_t k = 0; k < sizeof before / sizeof *before; k++)
		if (starts(r, i, before[k]))
			return 1;
	return i > 0 && r->s[i] == ' ' && r->s[i - 1] == ',';
}

/* The place of what follows character i, which stands in `place`. */
static enum place place_after(const struct line_rest *r, size_t i, enum place place)
{
	if (place == IN_CODE && starts(r, i, "/*"))
		return IN_COMMENT;
	if (place == IN_COMMENT && i > 0 && r->s[i] == '/' && r->s[i - 1] == '*')
		return IN_CODE;
	if (place != IN_COMMENT && r->s[i] == '"')
		return place == IN_STRING ? IN_CODE : IN_STRING;
	return place;
}

/* Bytes that belong together in a string: an escape. */
static size_t unit(const struct line_rest *r, size_t i, enum place place)
{
	if (place != IN_STRING || r->s[i] != '\\')
		return 1;
	return i + 1 < r->length && r->s[i + 1] >= '0' && r->s[i + 1] <= '7' ? 4 : 2;
}

/* The last cut before the margin, or the first where a word alone passes it; after a parenthesis, or within a string,
   only where there is no better. */
static struct cut find_cut(const struct line_rest *r)
{
	struct cut strong = {0}, weak = {0};
	enum place place = r->place;
	size_t column = r->column, margin = (size_t)(r->is_directive ? FOLD_MARGIN - 2 : FOLD_MARGIN), n;

	for (size_t i = 0; i < r->length && (column <= margin || !(strong.next + weak.next)); i += n) {
		int breaks = place == IN_COMMENT ? r->s[i] == ' ' : place == IN_CODE && r->s[i] == ' ' && is_strong(r, i);

		if (i > 0 && breaks)
			strong = (struct cut){i, i + 1, place};
		else if (i > 0 && place == IN_CODE && (r->s[i - 1] == '(' || r->s[i - 1] == '{'))
			weak = (struct cut){i, i, place};
		else if (i > 1 && place == IN_STRING && r->is_table && column < margin && r->s[i - 1] != '"')
			weak = (struct cut){i, i, place};
		n = unit(r, i, place);
		for (size_t k = i; k < i + n && k < r->length; k++)
			column = column_after(column, r->s[k]);
		place = place_after(r, i, place);
	}
	return strong.next ? strong : weak;
}

/* What stands before the rest of a line: its own indentation, a tab more in code; in a comment as deep as its words. */
static void put_indent(const char *line, size_t length, enum place place, struct text *out)
{
	size_t white = strspn(line, "\t "), begin = white;

	if (place == IN_COMMENT && white < length && line[white] == '*') {
		begin += 1 + strspn(line + white + 1, " ");
		text_putn(out, line, begin < LONGEST_INDENT ? begin : white + 1);
		text_put(out, begin > white + 2 ? "  " : "");
		return;
	}
	text_putn(out, line, white);
	if (place == IN_COMMENT && !memcmp(line + white, "/*", 2))
		text_put(out, "   ");
	else if (place == IN_CODE)
		text_put(out, "\t");
}

static int ends_line(const char *s, size_t length)
{
	return (length > 3 && !memcmp(s + length - 3, "\\n\"", 3)) || (length > 4 && !memcmp(s + length - 4, "\\n\";", 4));
}

/* A line without its end; returns the place in which the next one begins. */
static enum place put_line(const char *line, size_t length, enum place place, struct text *out)
{
	struct line_rest r = {line, length, 0, place, length && *line == '#', ends_line(line, length)};
	struct cut cut;
	size_t width = 0;

	for (;;) {
		width = r.column;
		for (size_t i = 0; i < r.length; i++)
			width = column_after(width, r.s[i]);
		cut = width > FOLD_MARGIN ? find_cut(&r) : (struct cut){0};
		if (!cut.next)
			break;
		text_putn(out, r.s, cut.end);
		text_put(out, cut.place == IN_STRING ? "\"" : r.is_directive && cut.place == IN_CODE ? " \\" : "");
		text_putc(out, '\n');
		size_t start = out->length;
		put_indent(line, length, cut.place, out);
		text_put(out, cut.place == IN_STRING ? "\"" : "");
		r.column = 0;
		for (size_t i = start; i < out->length; i++)
			r.column = column_after(r.column, out->s[i]);
		r = (struct line_rest){r.s + cut.next, r.length - cut.next, r.column, cut.place, r.is_directive, r.is_table};
	}
	text_putn(out, r.s, r.length);
	for (size_t i = 0, n; i < r.length; i += n) {
		n = unit(&r, i, r.place);
		r.place = place_after(&r, i, r.place);
	}
	return r.place == IN_COMMENT ? IN_COMMENT : IN_CODE;
}

static int is_within(const char *s)
{
	size_t column = 0;

	for (; *s && column <= FOLD_MARGIN; s++)
		column = *s == '\n' ? 0 : column_after(column, *s);
	return column <= FOLD_MARGIN;
}

void fold(struct text *out, size_t from)
{
	enum place place = IN_CODE;
	struct text lines;

	if (out->failed || out->length <= from || is_within(out->s + from))
		return;
	text_init(&lines, out->arena);
	for (const char *s = out->s + from; *s;) {
		size_t length = strcspn(s, "\n");

		place = put_line(s, length, place, &lines);
		s += length;
		if (*s)
			text_putc(&lines, *s++);
	}
	out->length = from;
	out->s[from] = '\0';
	text_put(out, text_string(&lines));
	out->failed |= lines.failed;
}

void fold_blank(struct text *out)
{
	size_t length = 0;

	for (size_t i = 0; i < out->length; i++)
		if (out->s[i] != '\n' || length < 2 || out->s[length - 1] != '\n' || out->s[length - 2] != '\n')
			out->s[length++] = out->s[i];
	out->length = length;
	if (out->s)
		out->s[length] = '\0';
}
