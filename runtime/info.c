#include "info.h"
#include <limits.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

/* A text in parts has the second version and one key more: who knows nothing of parts must not launch it as a whole. */
enum { VERSION = 1, VERSION_PARTS = 2, BLOCK_LIMIT = 1024, PARTS_LIMIT = 65535, STAGE_LIMIT = 48 << 10 };

/* The keys that stand exactly once. */
enum key {
	KEY_NAME,
	KEY_PRECISION,
	KEY_ARITHMETIC,
	KEY_LAYOUT,
	KEY_TRIG,
	KEY_BASE,
	KEY_NQ,
	KEY_NV,
	KEY_NB,
	KEY_BLOCK,
	KEY_OPERATIONS,
	KEY_PARTS,
	KEY_STAGE,
	KEY_COUNT
};

static const char *const keys[KEY_COUNT] = {
	"name", "precision", "arithmetic", "layout", "trig", "base", "nq", "nv", "nb", "block", "operations", "parts", "stage"};

struct parser {
	char *rest;    /* of the text: what is not read yet */
	char *line;    /* of the current line: what is not read yet; NULL at its end */
	size_t number; /* of the current line, from 1 */
	size_t version;
	int seen[KEY_COUNT];
	struct rnea_info *info;
	struct rnea_argument *arguments;
	struct rnea_joint *joints;
	struct rnea_matrix *matrices;
	int *row, *col; /* of the elements of all matrices */
	size_t element_count;
	struct rnea_error *error;
};

static enum rnea_code damaged(struct parser *p, const char *what, const char *word)
{
	return rnea_error_set(p->error, RNEA_TABLE, "info table, line %zu: %s%s%s%s", p->number, what, word ? " \"" : "",
		word ? word : "", word ? "\"" : "");
}

/* Move to the next line; 0 at the end of the text. */
static int next_line(struct parser *p)
{
	char *end;

	if (!*p->rest)
		return 0;
	p->line = p->rest;
	end = strchr(p->rest, '\n');
	p->rest = end ? end + 1 : p->rest + strlen(p->rest);
	if (end)
		*end = '\0';
	p->number++;
	return 1;
}

/* The next word of the line, words being separated by one space; "" where there is none. */
static const char *next_word(struct parser *p)
{
	char *word = p->line;
	char *end;

	if (!word)
		return "";
	end = strchr(word, ' ');
	p->line = end ? end + 1 : NULL;
	if (end)
		*end = '\0';
	return word;
}

static enum rnea_code end_line(struct parser *p)
{
	return p->line ? damaged(p, "more than expected:", p->line) : RNEA_OK;
}

static enum rnea_code read_word(struct parser *p, const char **word)
{
	*word = next_word(p);
	return **word ? RNEA_OK : damaged(p, "a word is missing", NULL);
}

static enum rnea_code read_number(struct parser *p, size_t *n, size_t least, size_t most)
{
	const char *word = next_word(p);
	size_t value = 0;

	if (!*word)
		return damaged(p, "a number is missing", NULL);
	for (const char *s = word; *s; s++) {
		size_t digit = (size_t)(*s - '0');

		if (*s < '0' || *s > '9')
			return damaged(p, "not a number:", word);
		if (value > (SIZE_MAX - digit) / 10)
			return damaged(p, "the number is too large:", word);
		value = 10 * value + digit;
	}
	if (value < least || value > most)
		return damaged(p, "the number is out of range:", word);
	*n = value;
	return RNEA_OK;
}

/* One of two words; *value becomes its index. */
static enum rnea_code read_choice(struct parser *p, int *value, const char *zero, const char *one)
{
	const char *word = next_word(p);

	*value = strcmp(word, one) == 0;
	return *value || strcmp(word, zero) == 0 ? RNEA_OK : damaged(p, "not a known word:", word);
}

static enum rnea_code read_scalar(struct parser *p, enum rnea_scalar *scalar)
{
	int value;

	if (read_choice(p, &value, "f32", "f64"))
		return p->error->code;
	*scalar = value ? RNEA_F64 : RNEA_F32;
	return RNEA_OK;
}

static enum rnea_code read_argument(struct parser *p, int is_output)
{
	struct rnea_info *info = p->info;
	struct rnea_argument *a = &p->arguments[info->input_count + info->output_count];

	if (info->input_count + info->output_count == RNEA_ARGUMENT_LIMIT)
		return damaged(p, "more arrays than a kernel can take", NULL);
	if (info->output_count && !is_output)
		return damaged(p, "an input after an output", NULL);
	if (read_word(p, &a->name) || read_number(p, &a->rows, 1, SIZE_MAX / 16) || read_scalar(p, &a->scalar) ||
		read_choice(p, &a->per_batch, "sample", "batch"))
		return p->error->code;
	for (const struct rnea_argument *b = p->arguments; b < a; b++)
		if (strcmp(a->name, b->name) == 0)
			return damaged(p, "a second array of the name", a->name);
	*(is_output ? &info->output_count : &info->input_count) += 1;
	return end_line(p);
}

static enum rnea_code read_joint(struct parser *p)
{
	struct rnea_joint *j = &p->joints[p->info->joint_count];

	if (read_number(p, &j->iq, 0, SIZE_MAX / 2) || read_number(p, &j->nq, 0, SIZE_MAX / 2) ||
		read_number(p, &j->iv, 0, SIZE_MAX / 2) || read_number(p, &j->nv, 0, SIZE_MAX / 2) || read_word(p, &j->type))
		return p->error->code;
	if (!p->line)
		return damaged(p, "the joint has no name", NULL);
	j->name = p->line;
	p->info->joint_count++;
	return RNEA_OK;
}

/* A matrix of an output that stands above. */
static enum rnea_code read_matrix(struct parser *p)
{
	struct rnea_info *info = p->info;
	struct rnea_matrix *m = &p->matrices[info->matrix_count];
	const char *name;
	size_t i = info->input_count;

	if (read_word(p, &name))
		return p->error->code;
	while (i < info->input_count + info->output_count && strcmp(p->arguments[i].name, name) != 0)
		i++;
	if (i == info->input_count + info->output_count)
		return damaged(p, "a matrix, and no output, of the name", name);
	for (const struct rnea_matrix *other = p->matrices; other < m; other++)
		if (other->argument == i)
			return damaged(p, "a second matrix of the name", name);
	*m = (struct rnea_matrix){.argument = i, .row = p->row + p->element_count, .col = p->col + p->element_count};
	if (read_number(p, &m->rows, 1, INT_MAX) || read_number(p, &m->cols, 1, INT_MAX) || read_choice(p, &m->lower, "general", "lower"))
		return p->error->code;
	info->matrix_count++;
	return end_line(p);
}

/* How many elements of the matrix have been read. */
static size_t stored(const struct parser *p, const struct rnea_matrix *m)
{
	const struct rnea_matrix *end = p->matrices + p->info->matrix_count;

	return (size_t)((m + 1 < end ? m[1].row : p->row + p->element_count) - m->row);
}

/* One row of the matrix that was begun last: columns that ascend, after those of the rows before. */
static enum rnea_code read_row(struct parser *p)
{
	const struct rnea_matrix *m = p->info->matrix_count ? &p->matrices[p->info->matrix_count - 1] : NULL;
	const char *name;
	size_t row, col, least = 0;

	if (read_word(p, &name))
		return p->error->code;
	if (!m || strcmp(p->arguments[m->argument].name, name) != 0)
		return damaged(p, "a row of no matrix that is begun:", name);
	if (stored(p, m))
		least = (size_t)p->row[p->element_count - 1] + 1;
	if (read_number(p, &row, least, m->rows - 1))
		return p->error->code;
	for (least = 0; p->line; least = col + 1) {
		if (read_number(p, &col, least, m->lower ? row : m->cols - 1))
			return p->error->code;
		p->row[p->element_count] = (int)row;
		p->col[p->element_count++] = (int)col;
	}
	return RNEA_OK;
}

static enum rnea_code read_operations(struct parser *p)
{
	struct rnea_operations *o = &p->info->operations;
	size_t *const counts[] = {&o->mul, &o->add, &o->sub, &o->neg, &o->fma, &o->sincos};

	for (size_t i = 0; i < sizeof counts / sizeof *counts; i++)
		if (read_number(p, counts[i], 0, SIZE_MAX))
			return p->error->code;
	return RNEA_OK;
}

static enum rnea_code read_value(struct parser *p, enum key key)
{
	struct rnea_info *info = p->info;
	size_t count = 0;
	int choice = 0;

	switch (key) {
	case KEY_NAME:
		return read_word(p, &info->name);
	case KEY_PRECISION:
		return read_scalar(p, &info->precision);
	case KEY_ARITHMETIC:
		return read_word(p, &info->arithmetic);
	case KEY_LAYOUT:
		read_choice(p, &choice, "soa", "aos");
		info->layout = choice ? RNEA_AOS : RNEA_SOA;
		return p->error->code;
	case KEY_TRIG:
		return read_word(p, &info->trig);
	case KEY_BASE:
		return read_word(p, &info->base);
	case KEY_NQ:
		return read_number(p, &info->nq, 1, SIZE_MAX / 16);
	case KEY_NV:
		return read_number(p, &info->nv, 1, SIZE_MAX / 16);
	case KEY_NB:
		return read_number(p, &info->nb, 1, SIZE_MAX / 128);
	case KEY_BLOCK:
	case KEY_PARTS:
		read_number(p, &count, key == KEY_BLOCK ? 1 : 2, key == KEY_BLOCK ? BLOCK_LIMIT : PARTS_LIMIT);
		*(key == KEY_BLOCK ? &info->block : &info->parts) = (unsigned)count;
		return p->error->code;
	case KEY_OPERATIONS:
		return read_operations(p);
	case KEY_STAGE:
		return read_number(p, &info->stage_bytes, 1, STAGE_LIMIT);
	case KEY_COUNT:
		break;
	}
	return RNEA_OK;
}

static enum rnea_code read_line(struct parser *p)
{
	const char *word = next_word(p);

	if (strcmp(word, "input") == 0 || strcmp(word, "output") == 0)
		return read_argument(p, *word == 'o');
	if (strcmp(word, "joint") == 0)
		return read_joint(p);
	if (strcmp(word, "matrix") == 0)
		return read_matrix(p);
	if (strcmp(word, "row") == 0)
		return read_row(p);
	for (int i = 0; i < KEY_COUNT; i++) {
		if (strcmp(word, keys[i]) != 0)
			continue;
		if (p->seen[i]++)
			return damaged(p, "a second line of the key", word);
		return read_value(p, (enum key)i) ? p->error->code : end_line(p);
	}
	return RNEA_OK;
}

static enum rnea_code read_version(struct parser *p)
{
	if (!next_line(p) || strcmp(next_word(p), "rneagen-info") != 0)
		return rnea_error_set(p->error, RNEA_TABLE, "info table: it does not start with \"rneagen-info %d\" or \"... %d\"",
			VERSION, VERSION_PARTS);
	if (read_number(p, &p->version, 0, SIZE_MAX) || end_line(p))
		return p->error->code;
	if (p->version != VERSION && p->version != VERSION_PARTS)
		return rnea_error_set(p->error, RNEA_TABLE,
			"info table: it has version %zu, and this library reads versions %d and %d", p->version, VERSION, VERSION_PARTS);
	return RNEA_OK;
}

/* What no single line can show. */
static enum rnea_code check(struct parser *p)
{
	const struct rnea_info *info = p->info;

	for (int i = 0; i < KEY_COUNT; i++)
		if (!p->seen[i] && i != KEY_ARITHMETIC && i != KEY_STAGE && (i != KEY_PARTS || p->version == VERSION_PARTS))
			return rnea_error_set(p->error, RNEA_TABLE, "info table: the key \"%s\" is missing", keys[i]);
	if (!info->output_count) /* no inputs: a scene may give them all */
		return rnea_error_set(p->error, RNEA_TABLE, "info table: it lists no outputs");
	for (size_t i = 0; i < info->joint_count; i++) {
		const struct rnea_joint *j = &info->joints[i];

		if (j->iq + j->nq > info->nq || j->iv + j->nv > info->nv)
			return rnea_error_set(p->error, RNEA_TABLE, "info table: joint \"%s\" lies outside of q or qd", j->name);
	}
	for (size_t i = 0; i < info->matrix_count; i++) {
		const struct rnea_argument *a = &info->arguments[info->matrices[i].argument];

		if (stored(p, &info->matrices[i]) != a->rows)
			return rnea_error_set(p->error, RNEA_TABLE, "info table: matrix \"%s\" has %zu elements, and its array %zu rows",
				a->name, stored(p, &info->matrices[i]), a->rows);
	}
	return RNEA_OK;
}

/* One block: room for the most arguments and matrices, for a joint in every line and an element in every word, and the
   text, which is cut into words in place. */
static enum rnea_code take_memory(struct parser *p, const char *text, size_t length)
{
	size_t lines = 1, words = length / 2 + 1, head;
	char *memory;

	for (size_t i = 0; i < length; i++)
		lines += text[i] == '\n';
	head = RNEA_ARGUMENT_LIMIT * (sizeof *p->arguments + sizeof *p->matrices) + lines * sizeof *p->joints +
		2 * words * sizeof *p->row;
	if (!(memory = calloc(1, head + length + 1)))
		return rnea_error_memory(p->error);
	p->info->memory = memory;
	p->arguments = (struct rnea_argument *)(void *)memory;
	p->matrices = (struct rnea_matrix *)(void *)(p->arguments + RNEA_ARGUMENT_LIMIT);
	p->joints = (struct rnea_joint *)(void *)(p->matrices + RNEA_ARGUMENT_LIMIT);
	p->row = (int *)(void *)(p->joints + lines);
	p->col = p->row + words;
	p->rest = memory + head;
	memcpy(p->rest, text, length);
	p->info->arguments = p->arguments;
	p->info->joints = p->joints;
	p->info->matrices = p->matrices;
	return RNEA_OK;
}

enum rnea_code rnea_info_parse(const char *text, size_t length, struct rnea_info *info, struct rnea_error *e)
{
	struct parser p = {.info = info, .error = e};

	memset(info, 0, sizeof *info);
	info->parts = 1;
	if (take_memory(&p, text, length))
		return e->code;
	if (strlen(p.rest) + 1 < length)
		rnea_error_set(e, RNEA_TABLE, "info table: it holds a NUL");
	else
		read_version(&p);
	while (!e->code && next_line(&p))
		read_line(&p);
	if (e->code || check(&p))
		rnea_info_free(info);
	else if (!info->arithmetic)
		info->arithmetic = info->precision == RNEA_F64 ? "f64" : "f32";
	return e->code;
}

enum rnea_code rnea_info_read(const char *text, size_t length, const char *name, struct rnea_info *info, struct rnea_error *e)
{
	if (rnea_info_parse(text, length, info, e) || strcmp(info->name, name) == 0)
		return e->code;
	rnea_error_set(e, RNEA_TABLE, "info table: %s_info calls the robot \"%s\"", name, info->name);
	rnea_info_free(info);
	return e->code;
}

void rnea_info_free(struct rnea_info *info)
{
	free(info->memory);
	memset(info, 0, sizeof *info);
}
