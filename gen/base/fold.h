#ifndef RNEAGEN_FOLD_H
#define RNEAGEN_FOLD_H
/* Lines of generated texts stay within the margin, and blank ones apart. */

#include "base/text.h"

enum { FOLD_MARGIN = 120 }; /* columns; a tab ends at each eighth */

/* What was appended from `from` on, lines of C: one that is too long goes on in the next, after a comma, before an operator,
   at a blank of a comment, or as another string. A name alone may be longer than the margin. */
void fold(struct text *out, size_t from);

/* Of blank lines that follow each other, as where a piece ends in one and its frame has another, the first stays. */
void fold_blank(struct text *out);

#endif
