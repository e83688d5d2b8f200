#include "plan/turned.h"
#include "plan/stage.h"

/* Shared memory of a block at most. */
enum { MOST_BYTES = 226 << 10 };

struct rneagen_options turned_options(const struct rneagen_options *o, int is_turned)
{
	struct rneagen_options own = *o;

	if (is_turned)
		own.layout = RNEAGEN_SOA;
	return own;
}

int turned_bytes(const struct dag *d, const struct rneagen_options *o)
{
	int rows = 0;

	for (int i = 0; i < d->argument_count; i++)
		if (d->arguments[i].is_output && d->arguments[i].rows > rows)
			rows = d->arguments[i].rows;
	return rows * (TURNED_PITCH * stage_number_bytes(o) + 1); /* and which rows are zero */
}

int turned_may_be(const struct dag *d, const struct rneagen_options *o)
{
	if (o->layout != RNEAGEN_AOS || (o->precision != RNEAGEN_F32 && o->precision != RNEAGEN_F64))
		return 0;
	if (o->parts != RNEAGEN_PARTS_AUTO || o->segments != RNEAGEN_SEGMENTS_AUTO)
		return 0;
	return !stage_holds_all(d, o) && turned_bytes(d, o) <= MOST_BYTES;
}
