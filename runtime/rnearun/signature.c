#include "rnearun/signature.h"
#include "base/nearest.h"
#include <string.h>

static const char *word_of(struct analysis *a, const struct argument *x)
{
	struct text word;

	text_init(&word, a->arena);
	request_put_word(&a->request, x->name, x->is_output, &word);
	return text_string(&word);
}

static struct signature_array describe(struct analysis *a, const struct argument *x)
{
	const struct freed *f = x->is_output ? NULL : request_freed(&a->request, x->name);

	return (struct signature_array){.word = word_of(a, x), .name = x->name, .rows = (size_t)x->rows, .role = x->role,
		.is_output = x->is_output, .per_batch = x->per_batch, .nominal = f && f->kind != FREED_PAYLOAD ? f->nominal : NULL,
		.has_default = f || (!x->is_output && request_push(&a->request, x->name))};
}

int signature_of(struct signature *s, struct analysis *a)
{
	*s = (struct signature){.count = (size_t)a->dag.argument_count, .is_plain = a->request.is_plain};
	for (size_t i = 0; i < s->count; i++)
		s->arrays[i] = describe(a, &a->dag.arguments[i]);
	return !a->arena->failed;
}

static int is_word(const char *word, const char *text, size_t length)
{
	return strlen(word) == length && !memcmp(word, text, length);
}

int signature_find(const struct signature *s, const char *text, size_t length, int is_output)
{
	for (size_t i = 0; i < s->count; i++)
		if (s->arrays[i].is_output == is_output &&
			(is_word(s->arrays[i].word, text, length) || is_word(s->arrays[i].name, text, length)))
			return (int)i;
	return -1;
}

const char *signature_nearest(const struct signature *s, const char *word, int is_output)
{
	const char *words[DAG_ARGUMENTS];
	size_t count = 0;

	for (size_t i = 0; i < s->count; i++)
		if (s->arrays[i].is_output == is_output)
			words[count++] = s->arrays[i].word;
	return nearest_name(word, words, count, sizeof *words);
}

int signature_fits(const struct dag *d, const struct rnea_info *info)
{
	if (info->input_count + info->output_count != (size_t)d->argument_count)
		return 0;
	for (int i = 0; i < d->argument_count; i++) {
		const struct rnea_argument *a = &info->arguments[i];

		if (strcmp(a->name, d->arguments[i].name) || a->rows != (size_t)d->arguments[i].rows ||
			a->per_batch != d->arguments[i].per_batch)
			return 0;
	}
	return 1;
}
