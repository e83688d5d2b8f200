/* The numbers of a choice. */
#define _POSIX_C_SOURCE 200809L
#include "base/c_locale.h"
#include "base/number.h"
#include "scene/scene.h"
#include <string.h>

static int read_number(const char **s, struct within *value)
{
	char word[128];
	size_t length = strcspn(*s, ",");

	if (length >= sizeof word)
		return 0;
	memcpy(word, *s, length);
	word[length] = '\0';
	*s += length;
	return number_read(word, value, 1) == NUMBER_FINE;
}

enum rneagen_code scene_numbers(
	const struct scene *s, const struct scene_choice *c, struct within *values, int count, struct rneagen_error *e)
{
	const char *at = c->value ? c->value : "";
	struct c_locale l;
	int good = 1;

	if (!c_locale_enter(&l))
		return error_memory(e);
	for (int i = 0; i < count && good; i++) {
		good = read_number(&at, &values[i]) && *at == (i + 1 < count ? ',' : '\0');
		at += *at == ',';
	}
	c_locale_leave(&l);
	if (good)
		return RNEAGEN_OK;
	return count == 1 ? scene_refuse(s, c, e, "takes a finite number, not '%.255s'", c->value ? c->value : "")
			  : scene_refuse(s, c, e, "takes %d finite numbers with commas between, not '%.255s'", count,
				    c->value ? c->value : "");
}
