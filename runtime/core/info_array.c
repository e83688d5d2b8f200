/* The lines of the info table about arrays. */
#include "core/info_parser.h"
#include <limits.h>
#include <stdint.h>
#include <string.h>

enum rnea_code info_scalar(struct parser *p, enum rnea_scalar *scalar)
{
	int value;

	if (words_choice(&p->w, &value, "f32", "f64"))
		return p->w.error->code;
	*scalar = value ? RNEA_F64 : RNEA_F32;
	return RNEA_OK;
}

static enum rnea_role find_role(const char *word)
{
	static const char *const roles[] = {
#define ROLE_WORD(role, text) text,
		RNEA_ROLES(ROLE_WORD)
#undef ROLE_WORD
	};

	for (int i = 0; i < RNEA_ROLE_COUNT; i++)
		if (strcmp(word, roles[i]) == 0)
			return (enum rnea_role)i;
	return RNEA_ROLE_UNKNOWN;
}

/* The role and, to the end of the line, what it speaks of; before version 3 the line ends here. */
static enum rnea_code read_role(struct parser *p, struct rnea_argument *a)
{
	const char *word;

	a->of = "";
	if (p->version < VERSION_FUNCTIONS)
		return words_end(&p->w);
	if (words_one(&p->w, &word))
		return p->w.error->code;
	a->role = find_role(word);
	if (p->w.line)
		a->of = p->w.line;
	return RNEA_OK;
}

enum rnea_code info_argument(struct parser *p, int is_output)
{
	struct rnea_function *f = p->f;
	struct rnea_argument *a = &p->arguments[p->argument_count];

	if (!f)
		return words_damaged(&p->w, "an array before the first function", NULL);
	if (f->input_count + f->output_count == RNEA_ARGUMENT_LIMIT)
		return words_damaged(&p->w, "more arrays than a kernel can take", NULL);
	if (f->output_count && !is_output)
		return words_damaged(&p->w, "an input after an output", NULL);
	if (words_one(&p->w, &a->name) || words_number(&p->w, &a->rows, 1, SIZE_MAX / 16) || info_scalar(p, &a->scalar) ||
		words_choice(&p->w, &a->per_batch, "sample", "batch") || read_role(p, a))
		return p->w.error->code;
	for (const struct rnea_argument *b = f->arguments; b < a; b++)
		if (strcmp(a->name, b->name) == 0)
			return words_damaged(&p->w, "a second array of the name", a->name);
	*(is_output ? &f->output_count : &f->input_count) += 1;
	p->argument_count++;
	return RNEA_OK;
}

/* A matrix of an output that stands above. */
enum rnea_code info_matrix(struct parser *p)
{
	struct rnea_function *f = p->f;
	struct rnea_matrix *m = &p->matrices[p->matrix_count];
	size_t i = f ? f->input_count : 0, end = f ? i + f->output_count : 0;
	const char *name;

	if (words_one(&p->w, &name))
		return p->w.error->code;
	while (i < end && strcmp(f->arguments[i].name, name) != 0)
		i++;
	if (i == end)
		return words_damaged(&p->w, "a matrix, and no output, of the name", name);
	for (const struct rnea_matrix *other = f->matrices; other < m; other++)
		if (other->argument == i)
			return words_damaged(&p->w, "a second matrix of the name", name);
	*m = (struct rnea_matrix){.argument = i, .row = p->row + p->element_count, .col = p->col + p->element_count};
	if (words_number(&p->w, &m->rows, 1, INT_MAX) || words_number(&p->w, &m->cols, 1, INT_MAX) ||
		words_choice(&p->w, &m->lower, "general", "lower"))
		return p->w.error->code;
	p->matrix_count++;
	f->matrix_count++;
	return words_end(&p->w);
}

size_t info_stored(const struct parser *p, const struct rnea_matrix *m)
{
	const struct rnea_matrix *end = p->matrices + p->matrix_count;

	return (size_t)((m + 1 < end ? m[1].row : p->row + p->element_count) - m->row);
}

/* One row of the matrix that was begun last: columns that ascend, after those of the rows before. */
enum rnea_code info_row(struct parser *p)
{
	const struct rnea_matrix *m = p->f && p->f->matrix_count ? &p->matrices[p->matrix_count - 1] : NULL;
	const char *name;
	size_t row, col, least = 0;

	if (words_one(&p->w, &name))
		return p->w.error->code;
	if (!m || strcmp(p->f->arguments[m->argument].name, name) != 0)
		return words_damaged(&p->w, "a row of no matrix that is begun:", name);
	if (info_stored(p, m))
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

enum rnea_code info_count(struct parser *p, unsigned *value, size_t least, size_t most)
{
	size_t count = 0;

	words_number(&p->w, &count, least, most);
	*value = (unsigned)count;
	return p->w.error->code;
}

enum rnea_code info_tiles(struct parser *p)
{
	struct rnea_function *f = p->f;

	if (!f->output_count)
		return words_damaged(&p->w, "tiles come after the arrays", NULL);
	while (!info_count(p, &f->tiles[f->tile_count].argument, 0, f->input_count + f->output_count - 1) &&
		!info_count(p, &f->tiles[f->tile_count].rows, 1, TILE_ROWS_LIMIT) && ++f->tile_count < RNEA_TILE_LIMIT && p->w.line)
		;
	return p->w.error->code;
}
