#ifndef RNEA_WORDS_H
#define RNEA_WORDS_H
/* The info table as lines of words, one space between two. What is wrong is an error TABLE that names the line. */

#include "core/failure.h"

struct words {
	char *rest;    /* the lines not begun yet; they are cut into words in place */
	char *line;    /* of the line that was begun: what is not read yet; NULL at its end */
	size_t number; /* of that line, from 1 */
	struct rnea_error *error;
};

/* Begin the next line; 0 at the end of the text. */
int words_line(struct words *w);

/* The next word of the line; "" where there is none. */
const char *words_next(struct words *w);

/* The next word has to be there; a number from `least` to `most`; or one of two words, *value becoming its index. */
enum rnea_code words_one(struct words *w, const char **word);
enum rnea_code words_number(struct words *w, size_t *n, size_t least, size_t most);
enum rnea_code words_choice(struct words *w, int *value, const char *zero, const char *one);

/* The line has to end here. */
enum rnea_code words_end(struct words *w);

/* Say that the line is wrong: `what`, and the word, which may be NULL. */
enum rnea_code words_damaged(struct words *w, const char *what, const char *word);

#endif
