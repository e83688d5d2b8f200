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
