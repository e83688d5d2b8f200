/* By what a compiled text is kept in the cache. */
#include "host/host.h"
#include "host/compiler.h"
#include <stdlib.h>
#include <string.h>

static void append(char *key, size_t *used, const char *text)
{
	size_t length = strlen(text) + 1; /* with its NUL, so that two texts do not run into each other */

	if (key)
		memcpy(key + *used, text, length);
	*used += length;
}

/* Everything that the object depends on. What the options name, files to include for one, is taken not to change. */
static size_t fill_key(char *key, const struct host_request *r, const struct compiler *c)
{
	size_t used = 0;

	append(key, &used, "rnea host 1");
	append(key, &used, c->identity);
	append(key, &used, r->name);
	append(key, &used, r->source);
	for (size_t i = 0; i < r->option_count; i++)
		append(key, &used, r->options[i]);
	return used;
}

enum rnea_code host_key(
	struct host_key *key, const struct host_request *r, const struct compiler *c, struct rnea_error *e)
{
	memset(key, 0, sizeof *key);
	if (!r->cache || !r->cache->folder[0] || !c->identity[0])
		return RNEA_OK;
	key->size = fill_key(NULL, r, c);
	if (!(key->data = malloc(key->size)))
		return rnea_error_memory(e);
	fill_key(key->data, r, c);
	return RNEA_OK;
}
