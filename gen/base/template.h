#ifndef RNEAGEN_TEMPLATE_H
#define RNEAGEN_TEMPLATE_H
/* The frames of the generated texts are real files in templates/, embedded at build time; @SLOT@ marks a place. */

#include "base/text.h"

struct slot {
	const char *name, *value;
};

/* Append the template with each @NAME@ replaced; a name that is not among the slots makes the text fail. A slot alone
   on its line whose value is empty takes the line with it. */
void template_expand(struct text *out, const char *tmpl, const struct slot *slots, size_t count);

/* The same up to the slot @end@, for what is too long to be made twice. Returns what follows that slot, "" on failure. */
const char *template_expand_to(struct text *out, const char *tmpl, const char *end, const struct slot *slots, size_t count);

/* The files of templates/, by name without their folder and with '.' turned into '_': made by embed.cmake. */
#include "templates.h"

#endif
