/* The words that a choice may begin with. */
#include "request/resolve.h"
#include "base/nearest.h"
#include <string.h>

/* Words that a message lists. */
enum { KNOWN_MOST = 12 };

/* Is what stands after a word ".hand" where a name belongs to it, and nothing where none does? */
static int has_its_name(const struct kind_word *k, const char *after)
{
	return k->has_name ? after[0] == '.' && after[1] : !after[0];
}

/* What a message adds where no word is near: the words, if they are few. */
static const char *known_words(struct arena *a, const struct kind_word *kinds, int count)
{
	struct text t;

	text_init(&t, a);
	for (int i = 0; i < count && count <= KNOWN_MOST; i++)
		text_printf(&t, "%s%s%s", i ? ", " : "; there is ", kinds[i].word, kinds[i].has_name ? ".NAME" : "");
	return t.failed ? "" : text_string(&t);
}

int request_find_kind(const struct resolver *x, const struct scene_choice *c, const struct kind_word *kinds, int count)
{
	size_t length = strcspn(c->name, ".");
	const char *stem = arena_string(x->a, c->name, length), *meant;

	if (!stem) {
		error_memory(x->e);
		return -1;
	}
	for (int i = 0; i < count; i++)
		if (!strcmp(stem, kinds[i].word) && has_its_name(&kinds[i], c->name + length))
			return i;
	meant = nearest_name(stem, kinds, (size_t)count, sizeof *kinds);
	for (int i = 0; i < count; i++)
		if (!strcmp(stem, kinds[i].word)) {
			scene_refuse(x->s, c, x->e,
				kinds[i].has_name ? "'%s' needs a name: %s.NAME" : "'%s' takes no name: write %s", stem, stem);
			return -1;
		}
	if (meant)
		scene_refuse(x->s, c, x->e, "'%.255s' is not known; did you mean '%s'?", c->name, meant);
	else
		scene_refuse(x->s, c, x->e, "'%.255s' is not known%s", c->name, known_words(x->a, kinds, count));
	return -1;
}
