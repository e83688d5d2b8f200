/* What a request has of a kind, and says of a row. */
#include "request/request.h"
#include <string.h>

const struct request_range *request_range_of(const struct request *k, const char *argument, int row)
{
	const struct request_range *narrowest = NULL;

	for (int i = 0; i < k->range_count; i++) {
		const struct request_range *r = &k->ranges[i];

		if (!strcmp(r->argument, argument) && row >= r->first && row < r->first + r->count &&
			(!narrowest || r->level > narrowest->level))
			narrowest = r;
	}
	return narrowest;
}

const struct freed *request_freed(const struct request *k, const char *argument)
{
	for (int i = 0; i < k->freed_count; i++)
		if (!strcmp(k->freed[i].argument, argument))
			return &k->freed[i];
	return NULL;
}

const struct push *request_push(const struct request *k, const char *argument)
{
	for (int i = 0; i < k->push_count; i++)
		if (!strcmp(k->pushes[i].argument, argument))
			return &k->pushes[i];
	return NULL;
}

const char *request_input_word(const struct request *k, const char *argument)
{
	const struct freed *f = request_freed(k, argument);
	const struct push *push = request_push(k, argument);

	return f ? f->word : push ? push->word : argument;
}

static const char *output_word(const struct request *k, const char *name)
{
	for (int i = 0; i < k->stored_count; i++)
		if (!strcmp(k->wants[i].argument, name))
			return k->wants[i].word;
	return name;
}

void request_put_word(const struct request *k, const char *name, int is_output, struct text *out)
{
	for (int i = 0; i < k->by_count && !is_output; i++)
		if (!strcmp(k->by[i].direction, name)) {
			text_printf(out, "jvp_v.%s", k->by[i].word);
			return;
		}
	text_put(out, is_output ? output_word(k, name) : request_input_word(k, name));
}

int request_has_all(const struct row *rows, int count)
{
	for (int i = 0; i < count; i++)
		if (!rows[i].is_given)
			return 0;
	return count > 0;
}

int request_wants(const struct request *k, enum want_kind kind)
{
	for (int i = 0; i < k->want_count; i++)
		if (k->wants[i].kind == kind)
			return 1;
	return 0;
}

int request_wants_any(const struct request *k, unsigned traits)
{
	for (int i = 0; i < k->want_count; i++)
		if (want_is(k->wants[i].kind, traits))
			return 1;
	return 0;
}

int request_wants_derivative(const struct request *k)
{
	for (int i = 0; i < k->want_count; i++)
		if (want_is(k->wants[i].kind, IS_DERIVATIVE))
			return 1;
	return 0;
}

struct request request_of_accelerations(const struct request *k, struct want *qdd)
{
	struct request alone = *k;

	for (int i = 0; i < k->want_count; i++)
		if (k->wants[i].kind == WANT_QDD)
			*qdd = k->wants[i];
	alone.wants = qdd;
	alone.want_count = alone.stored_count = 1;
	return alone;
}
