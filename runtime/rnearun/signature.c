#include "rnearun/signature.h"
#include "base/nearest.h"
#include <string.h>

static const struct freed *find_freed(const struct request *k, const char *name)
{
	for (int i = 0; i < k->freed_count; i++)
		if (!strcmp(k->freed[i].argument, name))
			return &k->freed[i];
	return NULL;
}

/* The scene's choices of links that forces act on, in order, are the request's pushes. */
static const char *push_word(struct analysis *a, const char *name)
{
	const struct scene_choice *c = NULL;
	struct text word;

	text_init(&word, a->arena);
	for (int i = 0; i < a->request.push_count && (c = scene_next(&a->scene, SCENE_FEXT, c)) != NULL; i++)
		if (!strcmp(a->request.pushes[i].argument, name))
			text_printf(&word, "fext.%s", c->name);
	return word.length ? text_string(&word) : NULL;
}

/* "jvp_v.payload.hand" */
static const char *direction_word(struct analysis *a, const char *name)
{
	struct text word;

	text_init(&word, a->arena);
	for (int i = 0; i < a->request.by_count; i++)
		if (!strcmp(a->request.by[i].direction, name))
			text_printf(&word, "jvp_v.%s", a->request.by[i].word);
	return word.length ? text_string(&word) : name;
}

static const char *want_word(const struct request *k, const char *name)
{
	for (int i = 0; i < k->stored_count; i++)
		if (!strcmp(k->wants[i].argument, name))
			return k->wants[i].word;
	return name;
}

static struct signature_array describe(struct analysis *a, const struct argument *x)
{
	struct signature_array s = {.word = x->name, .name = x->name, .rows = (size_t)x->rows, .role = x->role,
		.is_output = x->is_output, .per_batch = x->per_batch};
	const struct request *k = &a->request;
	const struct freed *f = x->is_output ? NULL : find_freed(k, x->name);
	const char *push = x->is_output || f ? NULL : push_word(a, x->name);

	s.word = x->is_output ? want_word(k, x->name) : direction_word(a, x->name);
	s.has_default = f || push;
	if (f) {
		s.word = f->word;
		s.nominal = f->kind == FREED_PAYLOAD ? NULL : f->nominal;
	} else if (push) {
		s.word = push;
	}
	return s;
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
