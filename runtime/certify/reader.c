#include "certify/reader.h"
#include <string.h>

json_t *read_json(const struct reader *r, const char *bytes, size_t length)
{
	json_error_t fault;
	json_t *root = json_loadb(bytes, length, JSON_REJECT_DUPLICATES, &fault);

	if (!root)
		error_set(r->e, RNEAGEN_READ, "%s:%d:%d: is no JSON, so no certificate: %s", r->file, fault.line, fault.column, fault.text);
	return root;
}

enum rneagen_code read_keys(const struct reader *r, const json_t *object, const char *where, const char *const *keys)
{
	const char *key;
	json_t *value;

	if (!json_is_object(object))
		return error_set(r->e, RNEAGEN_READ, "%s: %s is no object", r->file, where);
	for (const char *const *k = keys; *k; k++)
		if (!json_object_get(object, *k))
			return error_set(r->e, RNEAGEN_READ, "%s: %s has no \"%s\"", r->file, where, *k);
	json_object_foreach((json_t *)object, key, value) {
		const char *const *k = keys;

		while (*k && strcmp(*k, key))
			k++;
		if (!*k)
			return error_set(r->e, RNEAGEN_READ, "%s: %s has \"%.80s\", which is not known", r->file, where, key);
	}
	return RNEAGEN_OK;
}

json_t *read_member(const struct reader *r, const json_t *object, const char *where, const char *key, json_type type)
{
	static const char *const KINDS[] = {"object", "array", "string", "whole number", "number", "true", "false", "null"};
	json_t *value = json_object_get(object, key);

	if (value && json_typeof(value) == type)
		return value;
	error_set(r->e, RNEAGEN_READ, "%s: \"%s\" of %s is no %s", r->file, key, where, KINDS[type]);
	return NULL;
}

const char *read_word(const struct reader *r, const json_t *object, const char *where, const char *key)
{
	const json_t *value = read_member(r, object, where, key, JSON_STRING);

	return value ? json_string_value(value) : "";
}

double read_number(const struct reader *r, const json_t *value, const char *where, double absent)
{
	if (json_is_null(value))
		return absent;
	if (json_is_number(value) && isfinite(json_number_value(value)))
		return json_number_value(value);
	error_set(r->e, RNEAGEN_READ, "%s: %s has something that is no number", r->file, where);
	return (double)NAN;
}

int read_whole(const struct reader *r, const json_t *value, const char *where, int least, int most)
{
	json_int_t x = json_is_integer(value) ? json_integer_value(value) : (json_int_t)least - 1;

	if (x >= least && x <= most)
		return (int)x;
	error_set(r->e, RNEAGEN_READ, "%s: %s has something that is no whole number from %d to %d", r->file, where, least, most);
	return least;
}
