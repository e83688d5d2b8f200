#ifndef RNEAGEN_TEMPLATE_H
#define RNEAGEN_TEMPLATE_H
/* The frames of the generated texts are real files in templates/, embedded at build time; @SLOT@ marks a place. */

#include "base/text.h"

struct slot {
	const char *name, *value;
};

/* Append the template with each @NAME@ replaced; a name that is not among the slots makes the text and its arena fail, and is
   the arena's reason. A slot alone on its line whose value is empty takes the line with it. */
void template_expand(struct text *out, const char *tmpl, const struct slot *slots, size_t count);

/* A text of its own; "" on failure. */
const char *template_text(struct arena *a, const char *tmpl, const struct slot *slots, size_t count);

/* The same up to the slot @end@, for what is too long to be made twice. Returns what follows that slot, "" on failure. */
const char *template_expand_to(struct text *out, const char *tmpl, const char *end, const struct slot *slots, size_t count);

/* The failure of an arena whose texts were expanded: a slot, or memory. */
enum rneagen_code template_error(struct rneagen_error *e, const struct arena *a);

/* The files of templates/, by name without their folder and with '.' turned into '_': made by embed.cmake. And
   the list of them, which a template without a name ends. */
struct template_file {
	const char *name, *text;
	size_t size;
};
extern const struct template_file template_files[];

#include "templates.h"

#endif
