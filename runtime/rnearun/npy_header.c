/* The header of a .npy file: a Python dictionary of three entries. */
#include "rnearun/npy.h"
#include <string.h>

struct reader {
	const char *s, *end;
};

enum { SEEN_DESCR = 1, SEEN_ORDER = 2, SEEN_SHAPE = 4, SEEN_ALL = 7 };

static int is_little(void)
{
	const uint16_t one = 1;
	unsigned char first;

	memcpy(&first, &one, 1);
	return first;
}

static void skip_blanks(struct reader *r)
{
	while (r->s < r->end && (*r->s == ' ' || *r->s == '\n' || *r->s == '\t'))
		r->s++;
}

/* Skip blanks, then take `c` if it comes next. */
static int take(struct reader *r, char c)
{
	skip_blanks(r);
	if (r->s == r->end || *r->s != c)
		return 0;
	r->s++;
	return 1;
}

static int take_word(struct reader *r, const char *word)
{
	size_t n = strlen(word);

	skip_blanks(r);
	if ((size_t)(r->end - r->s) < n || memcmp(r->s, word, n) != 0)
		return 0;
	r->s += n;
	return 1;
}

/* 'abc' or "abc", at most 31 characters, none of them a backslash. */
static int take_string(struct reader *r, char text[32])
{
	size_t n = 0;
	char quote;

	skip_blanks(r);
	if (r->s == r->end || (*r->s != '\'' && *r->s != '"'))
		return 0;
	quote = *r->s++;
	while (r->s < r->end && *r->s != quote && *r->s != '\\' && n < 31)
		text[n++] = *r->s++;
	text[n] = '\0';
	return take(r, quote);
}

static int take_size(struct reader *r, size_t *value)
{
	const char *first;

	skip_blanks(r);
	first = r->s;
	*value = 0;
	for (; r->s < r->end && *r->s >= '0' && *r->s <= '9'; r->s++) {
		size_t digit = (size_t)(*r->s - '0');

		if (*value > (SIZE_MAX - digit) / 10)
			return 0;
		*value = *value * 10 + digit;
	}
	if (r->s == first)
		return 0;
	take(r, 'L'); /* as Python 2 wrote it */
	return 1;
}

/* (), (3,), (3, 4), (3, 4,) */
static int take_shape(struct reader *r, struct npy_shape *shape)
{
	shape->dimensions = 0;
	if (!take(r, '('))
		return 0;
	while (!take(r, ')')) {
		if (shape->dimensions == NPY_DIMENSIONS || !take_size(r, &shape->size[shape->dimensions++]))
			return 0;
		if (!take(r, ',') && shape->dimensions == 1)
			return 0; /* (3) is no tuple */
	}
	return 1;
}

static enum rneagen_code fail_header(const struct npy *n, const char *what, struct rneagen_error *e)
{
	return error_set(e, RNEAGEN_READ, "%s: the header of the array is damaged: %s", n->path, what);
}

static enum rneagen_code parse_descr(struct npy *n, struct reader *r, struct rneagen_error *e)
{
	char type[32];

	skip_blanks(r);
	if (r->s < r->end && *r->s == '[')
		return error_set(
			e, RNEAGEN_READ, "%s: a structured array; save a plain one of float32 or float64", n->path);
	if (!take_string(r, type))
		return fail_header(n, "'descr' is no string", e);
	if (strcmp(type + (*type != '\0'), "f4") != 0 && strcmp(type + (*type != '\0'), "f8") != 0)
		return error_set(
			e, RNEAGEN_READ, "%s: elements of type '%s'; save them as float32 or float64", n->path, type);
	if (*type != '<' && *type != '>')
		return fail_header(n, "'descr' does not tell the byte order", e);
	n->scalar = type[2] == '4' ? RNEA_F32 : RNEA_F64;
	n->swapped = (*type == '<') != is_little();
	return RNEAGEN_OK;
}

static enum rneagen_code parse_entry(struct npy *n, struct reader *r, unsigned *seen, struct rneagen_error *e)
{
	unsigned which = 0;
	char key[32];

	if (!take_string(r, key) || !take(r, ':'))
		return fail_header(n, "no dictionary of strings", e);
	if (!strcmp(key, "descr")) {
		which = SEEN_DESCR;
		if (parse_descr(n, r, e))
			return e->code;
	} else if (!strcmp(key, "fortran_order")) {
		which = SEEN_ORDER;
		n->fortran = take_word(r, "True");
		if (!n->fortran && !take_word(r, "False"))
			return fail_header(n, "'fortran_order' is neither True nor False", e);
	} else if (!strcmp(key, "shape")) {
		which = SEEN_SHAPE;
		if (!take_shape(r, &n->shape))
			return fail_header(n, "'shape' is no tuple of at most 64 sizes", e);
	}
	if (!which || *seen & which)
		return fail_header(n, "its entries are not 'descr', 'fortran_order' and 'shape', once each", e);
	*seen |= which;
	return RNEAGEN_OK;
}

/* samples and columns from the shape, with samples * columns * 8 below 2^63. */
static enum rneagen_code count_samples(struct npy *n, struct rneagen_error *e)
{
	const struct npy_shape *s = &n->shape;
	char text[64];

	npy_shape_text(s, text, sizeof text);
	if (s->dimensions == 0)
		return error_set(e, RNEAGEN_READ, "%s: a single number, no array of samples", n->path);
	n->columns = s->size[s->dimensions - 1];
	if (n->columns == 0)
		return error_set(e, RNEAGEN_READ, "%s: shape %s: samples without elements", n->path, text);
	if (n->columns > NPY_COLUMNS)
		return error_set(e, RNEAGEN_READ, "%s: shape %s: more than %d columns; samples go along the first axis",
			n->path, text, NPY_COLUMNS);
	n->samples = 1;
	for (size_t i = 0; i + 1 < s->dimensions; i++) {
		if (s->size[i] && n->samples > (INT64_MAX / 8 / NPY_COLUMNS) / s->size[i])
			return error_set(
				e, RNEAGEN_READ, "%s: shape %s: more elements than a file can hold", n->path, text);
		n->samples *= s->size[i];
	}
	if (n->fortran && s->dimensions > 2 && n->samples > 1)
		return error_set(e, RNEAGEN_READ,
			"%s: %zu axes in Fortran order; save numpy.ascontiguousarray of it, or two axes", n->path,
			s->dimensions);
	return RNEAGEN_OK;
}

enum rneagen_code npy_parse(struct npy *n, const char *text, size_t length, struct rneagen_error *e)
{
	struct reader r = {text, text + length};
	unsigned seen = 0;

	if (!take(&r, '{'))
		return fail_header(n, "no dictionary", e);
	while (!take(&r, '}')) {
		if (parse_entry(n, &r, &seen, e))
			return e->code;
		skip_blanks(&r);
		if (!take(&r, ',') && (r.s == r.end || *r.s != '}'))
			return fail_header(n, "the dictionary does not end", e);
	}
	skip_blanks(&r);
	if (r.s < r.end)
		return fail_header(n, "something follows the dictionary", e);
	if (seen != SEEN_ALL)
		return fail_header(n, "its entries are not 'descr', 'fortran_order' and 'shape', once each", e);
	return count_samples(n, e);
}

void npy_shape_text(const struct npy_shape *shape, char *text, size_t size)
{
	size_t length = 0;

	snprintf(text, size, "(");
	for (size_t i = 0; i < shape->dimensions; i++) {
		length = strlen(text);
		snprintf(text + length, size - length, "%s%zu", i ? ", " : "", shape->size[i]);
	}
	length = strlen(text);
	snprintf(text + length, size - length, shape->dimensions == 1 ? ",)" : ")");
}

/* Magic, version, length, dictionary, blanks and a newline: a multiple of 64 bytes together. */
size_t npy_put_header(FILE *f, enum rnea_scalar scalar, const struct npy_shape *shape)
{
	char sizes[NPY_DIMENSIONS * 24], text[sizeof sizes + 128];
	size_t length, whole;

	npy_shape_text(shape, sizes, sizeof sizes);
	length = (size_t)snprintf(text, sizeof text, "{'descr': '%cf%c', 'fortran_order': False, 'shape': %s, }",
		is_little() ? '<' : '>', scalar == RNEA_F32 ? '4' : '8', sizes);
	whole = (10 + length + 1 + 63) / 64 * 64 - 10;
	if (!f)
		return 10 + whole;
	fwrite("\x93NUMPY\x01", 1, 7, f);
	putc(0, f);
	putc((int)(whole & 255), f);
	putc((int)(whole >> 8), f);
	fprintf(f, "%s%*s\n", text, (int)(whole - length - 1), "");
	return 10 + whole;
}
