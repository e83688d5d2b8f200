#include "core/info_parser.h"
#include "core/info_old.h"
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

static const char *const keys[KEY_COUNT] = {"name", "precision", "arithmetic", "layout", "trig", "base", "nq", "nv",
	"nb", "block", "kernels", "operations", "parts", "stage", "segments", "limbs", "relay", "start_limbs", "start_parts",
	"whole_limbs", "hands", "part_kernels", "tiles", "threads", "transpose"};

static enum rnea_code read_joint(struct parser *p)
{
	struct rnea_joint *j = &p->joints[p->info->joint_count];

	if (words_number(&p->w, &j->iq, 0, SIZE_MAX / 2) || words_number(&p->w, &j->nq, 0, SIZE_MAX / 2) ||
		words_number(&p->w, &j->iv, 0, SIZE_MAX / 2) || words_number(&p->w, &j->nv, 0, SIZE_MAX / 2) ||
		words_one(&p->w, &j->type))
		return p->w.error->code;
	if (!p->w.line)
		return words_damaged(&p->w, "the joint has no name", NULL);
	j->name = p->w.line;
	p->info->joint_count++;
	return RNEA_OK;
}

static enum rnea_code read_operations(struct parser *p)
{
	struct rnea_operations *o = &p->f->operations;
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
		p->kernels |= info_old_bit(name);
	} while (p->w.line);
	return RNEA_OK;
}

static enum rnea_code read_value(struct parser *p, enum key key)
{
	struct rnea_info *info = p->info;
	int choice = 0;

	switch (key) {
	case KEY_NAME:
		return words_one(&p->w, &info->name);
	case KEY_PRECISION:
		return info_scalar(p, &info->precision);
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
		return info_count(p, &info->block, 1, BLOCK_LIMIT);
	case KEY_PARTS:
		return info_count(p, &p->f->parts, 2, PARTS_LIMIT);
	case KEY_OPERATIONS:
		return read_operations(p);
	case KEY_STAGE:
		return words_number(&p->w, &p->f->stage_bytes, 1, STAGE_LIMIT);
	case KEY_KERNELS:
		return read_kernels(p);
	case KEY_SEGMENTS:
		words_number(&p->w, &p->f->across_bytes, 1, SIZE_MAX / 2048);
		return info_count(p, &p->f->most_samples, 1, SAMPLES_LIMIT);
	case KEY_LIMBS:
		return info_limbs(p, &p->f->limbs, 0);
	case KEY_START_LIMBS:
		return info_limbs(p, &p->f->start_limbs, 1);
	case KEY_START_PARTS:
		return info_count(p, &p->f->start_parts, 2, PARTS_LIMIT);
	case KEY_WHOLE_LIMBS:
		return info_limbs(p, &p->f->limbs, 1);
	case KEY_HANDS:
		return info_hands(p);
	case KEY_PART_KERNELS:
		return info_part_kernels(p);
	case KEY_TILES:
		return info_tiles(p);
	case KEY_THREADS:
		return info_threads(p);
	case KEY_RELAY:
		return info_relay(p);
	case KEY_TRANSPOSE:
		return info_transpose(p);
	case KEY_COUNT:
		break;
	}
	return RNEA_OK;
}

/* A table of version 1 has no parts. The others stand only where a text has what they tell of. */
static int is_optional(const struct parser *p, enum key key)
{
	return key == KEY_ARITHMETIC || key == KEY_STAGE || key == KEY_SEGMENTS || key == KEY_LIMBS || key == KEY_RELAY ||
	       key == KEY_START_LIMBS || key == KEY_START_PARTS || key == KEY_WHOLE_LIMBS || key == KEY_HANDS || key == KEY_KERNELS ||
	       key == KEY_PART_KERNELS || key == KEY_TILES || key == KEY_THREADS || key == KEY_TRANSPOSE ||
	       (key == KEY_PARTS && p->version != VERSION_PARTS);
}

/* Whether a key that has to be there is. */
static enum rnea_code check_keys(const struct parser *p, enum key first, enum key end)
{
	for (enum key i = first; i < end; i++)
		if (!p->seen[i] && !is_optional(p, i))
			return rnea_error_set(p->w.error, RNEA_TABLE, "info table: the key \"%s\" is missing", keys[i]);
	return RNEA_OK;
}

/* What no single line of a function can show. */
static enum rnea_code finish_function(const struct parser *p)
{
	const struct rnea_function *f = p->f;

	if (!f)
		return rnea_error_set(p->w.error, RNEA_TABLE, "info table: it lists no functions");
	if (check_keys(p, KEY_OPERATIONS, KEY_COUNT))
		return p->w.error->code;
	if (!f->output_count) /* no inputs: a scene may give them all */
		return rnea_error_set(p->w.error, RNEA_TABLE, "info table: it lists no outputs of %s", f->name);
	for (size_t i = 0; i < f->matrix_count; i++) {
		const struct rnea_argument *a = &f->arguments[f->matrices[i].argument];

		if (info_stored(p, &f->matrices[i]) != a->rows)
			return rnea_error_set(p->w.error, RNEA_TABLE,
				"info table: matrix \"%s\" has %zu elements, and its array %zu rows", a->name,
				info_stored(p, &f->matrices[i]), a->rows);
	}
	return RNEA_OK;
}

static void begin_function(struct parser *p, const char *name)
{
	p->f = &p->functions[p->info->function_count++];
	*p->f = (struct rnea_function){.name = name,
		.parts = 1,
		.start_parts = 1,
		.most_samples = 1,
		.sample_threads = 1,
		.arguments = p->arguments + p->argument_count,
		.matrices = p->matrices + p->matrix_count};
	for (int i = KEY_OPERATIONS; i < KEY_COUNT; i++)
		p->seen[i] = 0;
}

static enum rnea_code read_function(struct parser *p)
{
	const char *name;

	if (words_one(&p->w, &name) || words_end(&p->w) || (p->f && finish_function(p)))
		return p->w.error->code;
	if (rnea_info_function(p->info, name) != p->info->function_count)
		return words_damaged(&p->w, "a second function of the name", name);
	begin_function(p, name);
	return RNEA_OK;
}

static enum rnea_code read_key(struct parser *p, enum key key)
{
	if (key >= KEY_OPERATIONS && !p->f)
		return words_damaged(&p->w, "before the first function: the key", keys[key]);
	if (p->seen[key]++)
		return words_damaged(&p->w, "a second line of the key", keys[key]);
	return read_value(p, key) ? p->w.error->code : words_end(&p->w);
}

static enum rnea_code read_line(struct parser *p)
{
	const char *word = words_next(&p->w);

	if (strcmp(word, "input") == 0 || strcmp(word, "output") == 0)
		return info_argument(p, *word == 'o');
	if (strcmp(word, "joint") == 0)
		return read_joint(p);
	if (strcmp(word, "matrix") == 0)
		return info_matrix(p);
	if (strcmp(word, "row") == 0)
		return info_row(p);
	if (strcmp(word, "function") == 0 && p->version >= VERSION_FUNCTIONS)
		return read_function(p);
	for (int i = 0; i < KEY_COUNT; i++)
		if (strcmp(word, keys[i]) == 0)
			return read_key(p, (enum key)i);
	return RNEA_OK;
}

static enum rnea_code read_version(struct parser *p)
{
	if (!words_line(&p->w) || strcmp(words_next(&p->w), "rneagen-info") != 0)
		return rnea_error_set(p->w.error, RNEA_TABLE,
			"info table: it does not start with \"rneagen-info\" and a version");
	if (words_number(&p->w, &p->version, 0, SIZE_MAX) || words_end(&p->w))
		return p->w.error->code;
	if (p->version < VERSION || p->version > VERSION_LAST)
		return rnea_error_set(p->w.error, RNEA_TABLE,
			"info table: it has version %zu, and this library reads versions %d to %d", p->version, VERSION,
			VERSION_LAST);
	if (p->version < VERSION_FUNCTIONS)
		begin_function(p, "rnea");
	p->info->version = (unsigned)p->version;
	return RNEA_OK;
}

static enum rnea_code check(struct parser *p)
{
	const struct rnea_info *info = p->info;

	if (check_keys(p, KEY_NAME, KEY_OPERATIONS) || finish_function(p))
		return p->w.error->code;
	for (size_t i = 0; i < info->joint_count; i++) {
		const struct rnea_joint *j = &info->joints[i];

		if (j->iq + j->nq > info->nq || j->iv + j->nv > info->nv)
			return rnea_error_set(p->w.error, RNEA_TABLE, "info table: joint \"%s\" lies outside of q or qd",
				j->name);
	}
	return RNEA_OK;
}

/* One block: room for a function, an array, a matrix and a joint in every line and an element in every word, for what old
   tables leave out, and the text, which is cut into words in place. */
static enum rnea_code take_memory(struct parser *p, const char *text, size_t length)
{
	size_t lines = 1, words = length / 2 + 1, head;
	char *memory;

	for (size_t i = 0; i < length; i++)
		lines += text[i] == '\n';
	head = (lines + INFO_OLD_FUNCTIONS) * sizeof *p->functions + (lines + INFO_OLD_ARRAYS) * sizeof *p->arguments +
		lines * (sizeof *p->matrices + sizeof *p->joints) + 2 * words * sizeof *p->row;
	if (!(memory = calloc(1, head + length + 1)))
		return rnea_error_memory(p->w.error);
	p->info->memory = memory;
	p->functions = (struct rnea_function *)(void *)memory;
	p->arguments = (struct rnea_argument *)(void *)(p->functions + lines + INFO_OLD_FUNCTIONS);
	p->matrices = (struct rnea_matrix *)(void *)(p->arguments + lines + INFO_OLD_ARRAYS);
	p->joints = (struct rnea_joint *)(void *)(p->matrices + lines);
	p->row = (int *)(void *)(p->joints + lines);
	p->col = p->row + words;
	p->w.rest = memory + head;
	memcpy(p->w.rest, text, length);
	p->info->functions = p->functions;
	p->info->joints = p->joints;
	return RNEA_OK;
}

/* What the info tells of the first function, and what the table left out. */
static void complete(struct parser *p)
{
	struct rnea_function *first = p->functions;
	struct rnea_info *info = p->info;

	for (struct rnea_function *f = first; f < first + info->function_count; f++)
		if (!f->limbs.parts)
			f->limbs.parts = f->parts;

	info->arguments = first->arguments;
	info->input_count = first->input_count;
	info->output_count = first->output_count;
	info->operations = first->operations;
	info->matrices = first->matrices;
	info->matrix_count = first->matrix_count;
	info->parts = first->parts;
	info->stage_bytes = first->stage_bytes;
	if (!info->arithmetic)
		info->arithmetic = info->precision == RNEA_F64 ? "f64" : "f32";
	if (p->version < VERSION_FUNCTIONS)
		info_old_complete(info, p->functions, p->arguments, p->kernels);
}

enum rnea_code rnea_info_parse(const char *text, size_t length, struct rnea_info *info, struct rnea_error *e)
{
	struct parser p = {.info = info, .w.error = e};

	memset(info, 0, sizeof *info);
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
	else
		complete(&p);
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

size_t rnea_info_function(const struct rnea_info *info, const char *name)
{
	size_t i = 0;

	while (i < info->function_count && strcmp(info->functions[i].name, name) != 0)
		i++;
	return i;
}

int rnea_info_lacks(struct rnea_info *info, size_t i)
{
	struct rnea_function *f = info->memory; /* which begins with them */

	if (i == 0 || !info->is_guessed)
		return 0;
	memmove(&f[i], &f[i + 1], (info->function_count - i - 1) * sizeof *f);
	info->function_count--;
	return 1;
}

void rnea_info_without_limbs(struct rnea_info *info)
{
	struct rnea_function *f = info->memory; /* which begins with them */

	f->limbs = f->start_limbs = (struct rnea_limbs){0};
}

void rnea_info_without_part_kernels(struct rnea_info *info)
{
	struct rnea_function *f = info->memory; /* which begins with them */

	f->part_kernels = 0;
	f->part_count = f->part_block = f->tile_count = 0;
}
