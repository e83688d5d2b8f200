#include "cuda/compile/macros.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* What stands after "#define MACRO " at the beginning of a line; NULL: there is no such line. */
static const char *find_macro(const struct source *s, const char *macro)
{
	char line[64];
	int length = snprintf(line, sizeof line, "\n#define %s ", macro);
	const char *at = strstr(s->text, line);

	return at ? at + length : NULL;
}

size_t macro_number(const struct source *s, const char *macro)
{
	const char *at = find_macro(s, macro);

	return at ? strtoul(at, NULL, 10) : 0;
}

unsigned macro_value(const struct source *s, const char *macro)
{
	size_t value = macro_number(s, macro);

	return value <= 1024 ? (unsigned)value : 0;
}

unsigned macro_min_blocks(const struct source *s, unsigned block)
{
	const char *at = find_macro(s, "RNEA_MIN_BLOCKS");
	unsigned least, threads;

	if (!block)
		block = macro_value(s, "RNEA_BLOCK");
	if (!at || !block || sscanf(at, "(RNEA_BLOCK < %4u ? 0 : %4u/RNEA_BLOCK)", &least, &threads) != 2)
		return macro_value(s, "RNEA_MIN_BLOCKS");
	return block < least ? 0 : threads / block;
}
