#include "core/info_table.h"
#include "core/source.h"
#include "core/words.h"
#include <limits.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

/* A text in parts has the second version and one key more: who knows nothing of parts must not launch it as a whole. */
enum { VERSION = 1, VERSION_PARTS = 2, BLOCK_LIMIT = 1024, PARTS_LIMIT = 65535, STAGE_LIMIT = 48 << 10 };

/* The keys that stand once. */
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
	KEY_KERNELS,
	KEY_COUNT
};

static const char *const keys[KEY_COUNT] = {
	"name", "precision", "arithmetic", "layout", "trig", "base", "nq", "nv", "nb", "block", "operations", "parts", "stage", "kernels"};

struct parser {
	struct words w; /* of the text: what is not read yet */
	size_t version;
	int seen[KEY_COUNT];
	struct rnea_info *info;
	struct rnea_argument *arguments;
	struct rnea_joint *joints;
	struct rnea_matrix *matrices;
	int *row, *col; /* of the elements of all matrices */
	size_t element_count;
};

static enum rnea_code read_scalar(struct parser *p, enum rnea_scalar *scalar)
{
	int value;

	if (words_choice(&p->w, &value, "f32", "f64"))
		return p->w.error->code;
	*scalar = value ? RNEA_F64 : RNEA_F32;
	return RNEA_OK;
}

static enum rnea_code read_argument(struct parser *p, int is_output)
{
	struct rnea_info *info = p->info;
	struct rnea_argument *a = &p->arguments[info->input_count + info->output_count];

	if (info->input_count + info->output_count == RNEA_ARGUMENT_LIMIT)
		return words_damaged(&p->w, "more arrays than a kernel can take", NULL);
	if (info->output_count && !is_output)
		return words_damaged(&p->w, "an input after an output", NULL);
	if (words_one(&p->w, &a->name) || words_number(&p->w, &a->rows, 1, SIZE_MAX / 16) || read_scalar(p, &a->scalar) ||
		words_choice(&p->w, &a->per_batch, "sample", "batch"))
		return p->w.error->code;
	for (const struct rnea_argument *b = p->arguments; b < a; b++)
		if (strcmp(a->name, b->name) == 0)
			return words_damaged(&p->w, "a second array of the name", a->name);
	*(is_output ? &info->output_count : &info->input_count) += 1;
	return words_end(&p->w);
}

static enum rnea_code read_joint(struct parser *p)
{
	struct rnea_joint *j = &p->joints[p->info->joint_count];

	if (words_number(&p->w, &j->iq, 0, SIZE_MAX / 2) || words_number(&p->w, &j->nq, 0, SIZE_MAX / 2) ||
		words_number(&p->w, &j->iv, 0, SIZE_MAX / 2) || words_number(&p->w, &j->nv, 0, SIZE_MAX / 2) || words_one(&p->w, &j->type))
		return p->w.error->code;
	if (!p->w.line)
		return words_damaged(&p->w, "the joint has no name", NULL);
	j->name = p->w.line;
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

	if (words_one(&p->w, &name))
		return p->w.error->code;
	while (i < info->input_count + info->output_count && strcmp(p->arguments[i].name, name) != 0)
		i++;
	if (i == info->input_count + info->output_count)
		return words_damaged(&p->w, "a matrix, and no output, of the name", name);
	for (const struct rnea_matrix *other = p->matrices; other < m; other++)
		if (other->argument == i)
			return words_damaged(&p->w, "a second matrix of the name", name);
	*m = (struct rnea_matrix){.argument = i, .row = p->row + p->element_count, .col = p->col + p->element_count};
	if (words_number(&p->w, &m->rows, 1, INT_MAX) || words_number(&p->w, &m->cols, 1, INT_MAX) || words_choice(&p->w, &m->lower, "general", "lower"))
		return p->w.error->code;
	info->matrix_count++;
	return words_end(&p->w);
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

	if (words_one(&p->w, &name))
		return p->w.error->code;
	if (!m || strcmp(p->arguments[m->argument].name, name) != 0)
		return words_damaged(&p->w, "a row of no matrix that is begun:", name);
	if (stored(p, m))
		least = (size_t)p->row[p->element_count - 1] + 1;
	if (words_number(&p->w, &row, least, m->rows - 1))
		return p->w.error->code;
	for (least = 0; p->w.line; least = col + 1) {
		if (words_number(&p->w, &col, least, m->lower ? row : m->cols - 1))
			return p->w.error->code;
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
		if (words_number(&p->w, counts[i], 0, SIZE_MAX))
			return p->w.error->code;
	return RNEA_OK;
}

/* A kernel of another name is passed over. */
static enum rnea_code read_kernels(struct parser *p)
{
	const char *name;

	do {
		if (words_one(&p->w, &name))
			return p->w.error->code;
		for (int k = 0; k < RNEA_KERNEL_COUNT; k++)
			if (strcmp(name, source_kernels[k]) == 0)
				p->info->kernels |= 1u << k;
	} while (p->w.line);
	return RNEA_OK;
}

static enum rnea_code read_value(struct parser *p, enum key key)
{
	struct rnea_info *info = p->info;
	size_t count = 0;
	int choice = 0;

	switch (key) {
	case KEY_NAME:
		return words_one(&p->w, &info->name);
	case KEY_PRECISION:
		return read_scalar(p, &info->precision);
	case KEY_ARITHMETIC:
		return words_one(&p->w, &info->arithmetic);
	case KEY_LAYOUT:
		words_choice(&p->w, &choice, "soa", "aos");
		info->layout = choice ? RNEA_AOS : RNEA_SOA;
		return p->w.error->code;
	case KEY_TRIG:
		return words_one(&p->w, &info->trig);
	case KEY_BASE:
		return words_one(&p->w, &info->base);
	case KEY_NQ:
		return words_number(&p->w, &info->nq, 1, SIZE_MAX / 16);
	case KEY_NV:
		return words_number(&p->w, &info->nv, 1, SIZE_MAX / 16);
	case KEY_NB:
		return words_number(&p->w, &info->nb, 1, SIZE_MAX / 128);
	case KEY_BLOCK:
	case KEY_PARTS:
		words_number(&p->w, &count, key == KEY_BLOCK ? 1 : 2, key == KEY_BLOCK ? BLOCK_LIMIT : PARTS_LIMIT);
		*(key == KEY_BLOCK ? &info->block : &info->parts) = (unsigned)count;
		return p->w.error->code;
	case KEY_OPERATIONS:
		return read_operations(p);
	case KEY_STAGE:
		return words_number(&p->w, &info->stage_bytes, 1, STAGE_LIMIT);
	case KEY_KERNELS:
		return read_kernels(p);
	case KEY_COUNT:
		break;
	}
	return RNEA_OK;
}

static enum rnea_code read_line(struct parser *p)
{
	const char *word = words_next(&p->w);

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
			return words_damaged(&p->w, "a second line of the key", word);
		return read_value(p, (enum key)i) ? p->w.error->code : words_end(&p->w);
	}
	return RNEA_OK;
}

static enum rnea_code read_version(struct parser *p)
{
	if (!words_line(&p->w) || strcmp(words_next(&p->w), "rneagen-info") != 0)
		return rnea_error_set(p->w.error, RNEA_TABLE, "info table: it does not start with \"rneagen-info %d\" or \"... %d\"",
			VERSION, VERSION_PARTS);
	if (words_number(&p->w, &p->version, 0, SIZE_MAX) || words_end(&p->w))
		return p->w.error->code;
	if (p->version != VERSION && p->version != VERSION_PARTS)
		return rnea_error_set(p->w.error, RNEA_TABLE,
			"info table: it has version %zu, and this library reads versions %d and %d", p->version, VERSION, VERSION_PARTS);
	return RNEA_OK;
}

/* A table of version 1 has no parts, and `arithmetic` and `kernels` may be left out. */
static int is_optional(const struct parser *p, enum key key)
{
	return key == KEY_ARITHMETIC || key == KEY_STAGE || key == KEY_KERNELS || (key == KEY_PARTS && p->version == VERSION);
}

/* What no single line can show. */
static enum rnea_code check(struct parser *p)
{
	const struct rnea_info *info = p->info;

	for (int i = 0; i < KEY_COUNT; i++)
		if (!p->seen[i] && !is_optional(p, (enum key)i))
			return rnea_error_set(p->w.error, RNEA_TABLE, "info table: the key \"%s\" is missing", keys[i]);
	if (!info->output_count) /* no inputs: a scene may give them all */
		return rnea_error_set(p->w.error, RNEA_TABLE, "info table: it lists no outputs");
	for (size_t i = 0; i < info->joint_count; i++) {
		const struct rnea_joint *j = &info->joints[i];

		if (j->iq + j->nq > info->nq || j->iv + j->nv > info->nv)
			return rnea_error_set(p->w.error, RNEA_TABLE, "info table: joint \"%s\" lies outside of q or qd", j->name);
	}
	for (size_t i = 0; i < info->matrix_count; i++) {
		const struct rnea_argument *a = &info->arguments[info->matrices[i].argument];

		if (stored(p, &info->matrices[i]) != a->rows)
			return rnea_error_set(p->w.error, RNEA_TABLE, "info table: matrix \"%s\" has %zu elements, and its array %zu rows",
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
		return rnea_error_memory(p->w.error);
	p->info->memory = memory;
	p->arguments = (struct rnea_argument *)(void *)memory;
	p->matrices = (struct rnea_matrix *)(void *)(p->arguments + RNEA_ARGUMENT_LIMIT);
	p->joints = (struct rnea_joint *)(void *)(p->matrices + RNEA_ARGUMENT_LIMIT);
	p->row = (int *)(void *)(p->joints + lines);
	p->col = p->row + words;
	p->w.rest = memory + head;
	memcpy(p->w.rest, text, length);
	p->info->arguments = p->arguments;
	p->info->joints = p->joints;
	p->info->matrices = p->matrices;
	return RNEA_OK;
}

enum rnea_code rnea_info_parse(const char *text, size_t length, struct rnea_info *info, struct rnea_error *e)
{
	struct parser p = {.info = info, .w.error = e};

	memset(info, 0, sizeof *info);
	info->parts = 1;
	if (take_memory(&p, text, length))
		return e->code;
	if (strlen(p.w.rest) + 1 < length)
		rnea_error_set(e, RNEA_TABLE, "info table: it holds a NUL");
	else
		read_version(&p);
	while (!e->code && words_line(&p.w))
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
