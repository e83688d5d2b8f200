#include "core/words.h"
#include <stdint.h>
#include <string.h>

enum rnea_code words_damaged(struct words *w, const char *what, const char *word)
{
	return rnea_error_set(w->error, RNEA_TABLE, "info table, line %zu: %s%s%s%s", w->number, what, word ? " \"" : "",
		word ? word : "", word ? "\"" : "");
}

int words_line(struct words *w)
{
	char *end;

	if (!*w->rest)
		return 0;
	w->line = w->rest;
	end = strchr(w->rest, '\n');
	w->rest = end ? end + 1 : w->rest + strlen(w->rest);
	if (end)
		*end = '\0';
	w->number++;
	return 1;
}

const char *words_next(struct words *w)
{
	char *word = w->line;
	char *end;

	if (!word)
		return "";
	end = strchr(word, ' ');
	w->line = end ? end + 1 : NULL;
	if (end)
		*end = '\0';
	return word;
}

enum rnea_code words_end(struct words *w)
{
	return w->line ? words_damaged(w, "more than expected:", w->line) : RNEA_OK;
}

enum rnea_code words_one(struct words *w, const char **word)
{
	*word = words_next(w);
	return **word ? RNEA_OK : words_damaged(w, "a word is missing", NULL);
}

enum rnea_code words_number(struct words *w, size_t *n, size_t least, size_t most)
{
	const char *word = words_next(w);
	size_t value = 0;

	if (!*word)
		return words_damaged(w, "a number is missing", NULL);
	for (const char *s = word; *s; s++) {
		size_t digit = (size_t)(*s - '0');

		if (*s < '0' || *s > '9')
			return words_damaged(w, "not a number:", word);
		if (value > (SIZE_MAX - digit) / 10)
			return words_damaged(w, "the number is too large:", word);
		value = 10 * value + digit;
	}
	if (value < least || value > most)
		return words_damaged(w, "the number is out of range:", word);
	*n = value;
	return RNEA_OK;
}

enum rnea_code words_choice(struct words *w, int *value, const char *zero, const char *one)
{
	const char *word = words_next(w);

	*value = strcmp(word, one) == 0;
	return *value || strcmp(word, zero) == 0 ? RNEA_OK : words_damaged(w, "not a known word:", word);
}
