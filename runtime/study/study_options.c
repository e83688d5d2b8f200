#include "study/study.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { BATCH_LIMIT = 1 << 30, SAMPLES_LIMIT = 10000000 };

const char *study_backend_name(enum rnea_backend backend)
{
	return backend == RNEA_BACKEND_CUDA ? "cuda" : "cpu";
}

struct study_options study_options_default(void)
{
	return (struct study_options){.backends = {{RNEA_BACKEND_HOST, RNEA_BACKEND_CUDA}, 2},
		.precisions = {{RNEAGEN_F32, RNEAGEN_MIXED, RNEAGEN_F32X2, RNEAGEN_F64}, 4},
		.trigs = {{RNEAGEN_ACCURATE, RNEAGEN_BOUNDED, RNEAGEN_FAST}, 3},
		.layouts = {{RNEAGEN_SOA, RNEAGEN_AOS}, 2},
		.sample = {.seed = 1, .count = 1000}};
}

/* One word of a list: 0; 2 and a message. */
static int read_word(const char *name, int key, const char *word, int *value)
{
	static const struct option_choice backends[] = {
		{"cpu", RNEA_BACKEND_HOST}, {"cuda", RNEA_BACKEND_CUDA}, {"all", RNEA_BACKEND_ANY}, {NULL, 0}};
	static const int keys[] = {[STUDY_PRECISION - STUDY_BACKEND] = OPTION_PRECISION,
		[STUDY_TRIG - STUDY_BACKEND] = OPTION_TRIG, [STUDY_LAYOUT - STUDY_BACKEND] = OPTION_LAYOUT};
	struct rneagen_options o = {0};
	int bad;

	if (key == STUDY_BACKEND)
		return option_choose(name, "backend", word, backends, value);
	bad = option_generate(name, &o, keys[key - STUDY_BACKEND], word);
	*value = key == STUDY_PRECISION ? (int)o.precision : key == STUDY_TRIG ? (int)o.trig : (int)o.layout;
	return bad;
}

static int has(const struct study_list *list, int value)
{
	for (int i = 0; i < list->count; i++)
		if (list->values[i] == value)
			return 1;
	return 0;
}

/* The next word of a list, cut to its size; returns what follows, NULL at the end. */
static const char *next_word(const char *list, char *word, size_t size)
{
	size_t n = strcspn(list, ",");

	memcpy(word, list, n < size ? n : size - 1);
	word[n < size ? n : size - 1] = '\0';
	return list[n] ? list + n + 1 : NULL;
}

static int take_list(struct study_list *list, const char *name, int key, const char *words)
{
	char word[32];
	int value = 0, bad;

	list->count = 0;
	do {
		words = next_word(words, word, sizeof word);
		if ((bad = read_word(name, key, word, &value)) != 0)
			return bad;
		if (!has(list, value) && list->count < STUDY_WORDS)
			list->values[list->count++] = value;
	} while (words);
	return 0;
}

static int ascending(const void *a, const void *b)
{
	const int *x = a, *y = b;

	return (*x > *y) - (*x < *y);
}

/* In the order accurate, bounded, fast: of those that are the same code the first has its name. */
static int take_trigs(struct study_options *o, const char *name, const char *words)
{
	int bad = take_list(&o->trigs, name, STUDY_TRIG, words);

	o->trig_asked = 1;
	qsort(o->trigs.values, (size_t)o->trigs.count, sizeof *o->trigs.values, ascending);
	return bad;
}

static int take_backends(struct study_options *o, const char *name, const char *words)
{
	int bad = take_list(&o->backends, name, STUDY_BACKEND, words), all = has(&o->backends, RNEA_BACKEND_ANY);

	o->backend_asked = !all;
	if (!bad && all)
		o->backends = study_options_default().backends;
	return bad;
}

static int take_batches(struct study_options *o, const char *name, const char *words)
{
	char word[32];

	o->batch_count = 0;
	do {
		unsigned long long n = 0;
		int bad;

		words = next_word(words, word, sizeof word);
		if ((bad = command_number(name, "batch", word, 1, BATCH_LIMIT, &n)) != 0)
			return bad;
		if (o->batch_count == STUDY_BATCHES)
			return option_refuse(name, "--batch takes at most %d numbers", STUDY_BATCHES);
		o->batches[o->batch_count++] = (size_t)n;
	} while (words);
	return 0;
}

int study_number(const char *name, const char *option, const char *word, double *value)
{
	char *end;

	*value = strtod(word, &end);
	if (end == word || *end || !(*value > 0) || !isfinite(*value))
		return option_refuse(name, "--%s takes a positive number, not '%s'", option, word);
	return 0;
}

int study_take(struct study_options *o, const char *name, int key, const char *word)
{
	unsigned long long n = 0;
	int bad;

	switch (key) {
	case STUDY_BACKEND:
		return take_backends(o, name, word);
	case STUDY_PRECISION:
		o->precision_asked = 1;
		return take_list(&o->precisions, name, key, word);
	case STUDY_TRIG:
		return take_trigs(o, name, word);
	case STUDY_LAYOUT:
		return take_list(&o->layouts, name, key, word);
	case STUDY_BATCH:
		return take_batches(o, name, word);
	case STUDY_SAMPLES:
		bad = command_number(name, "samples", word, 1, SAMPLES_LIMIT, &n);
		o->sample.count = (size_t)n;
		return bad;
	case STUDY_SEED:
		return command_number(name, "seed", word, 0, (1ull << 48) - 1, &o->sample.seed);
	default:
		return -1;
	}
}
