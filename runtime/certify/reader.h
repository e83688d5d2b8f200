#ifndef RUNTIME_CERTIFY_READER_H
#define RUNTIME_CERTIFY_READER_H
/* JSON as a certificate has it, read by jansson. What is not as it should be is told once, by where it stands. */

#include "base/error.h"
#include "steps/outward.h"
#include <jansson.h>

struct reader {
	const char *file;
	struct rneagen_error *e;
};

/* The whole of a file's bytes; NULL: *e says why. The caller gives it to json_decref. */
json_t *read_json(const struct reader *r, const char *bytes, size_t length);

/* An object that has these keys and no others; `keys` ends with NULL. Error: READ. */
enum rneagen_code read_keys(const struct reader *r, const json_t *object, const char *where, const char *const *keys);

/* A member of a kind; NULL: *e says why. */
json_t *read_member(const struct reader *r, const json_t *object, const char *where, const char *key, json_type type);

/* A string, "" and an error where it is none. */
const char *read_word(const struct reader *r, const json_t *object, const char *where, const char *key);

/* A finite number, or `absent` where it is null; NaN and an error where it is neither. */
double read_number(const struct reader *r, const json_t *value, const char *where, double absent);

/* A whole number from `least` to `most`. */
int read_whole(const struct reader *r, const json_t *value, const char *where, int least, int most);

#endif
