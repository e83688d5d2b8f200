#include "plan/turned.h"
#include "plan/grid/owners.h"
#include "plan/stage.h"

/* Samples of a block: those of two sectors of memory in f32, or as few as fill one. Shared memory of a block at most: what all GPUs
   have since compute capability 7.5. */
enum { MANY = 16, SECTOR_BYTES = 32, MOST_BYTES = 64 << 10 };

struct rneagen_options turned_options(const struct rneagen_options *o, int is_turned)
{
	struct rneagen_options own = *o;

	if (is_turned)
		own.layout = RNEAGEN_SOA;
	return own;
}

static int longest(const struct dag *d)
{
	int rows = 0;

	for (int i = 0; i < d->argument_count; i++)
		if (d->arguments[i].is_output && d->arguments[i].rows > rows)
			rows = d->arguments[i].rows;
	return rows;
}

/* From one row to the next there is room for a sample more, so that threads are in different banks; and it is said of each row
   whether it is zero. */
static int bytes_of(const struct dag *d, int samples, const struct rneagen_options *o)
{
	return longest(d) * ((samples + 1) * stage_number_bytes(o) + 1);
}

int turned_samples(const struct dag *d, const struct rneagen_options *o)
{
	for (int samples = MANY; samples * stage_number_bytes(o) >= SECTOR_BYTES; samples /= 2)
		if (bytes_of(d, samples, o) <= MOST_BYTES)
			return samples;
	return 0;
}

int turned_bytes(const struct dag *d, const struct rneagen_options *o)
{
	return bytes_of(d, turned_samples(d, o), o);
}

int turned_may_be(const struct dag *d, const struct request *k, const struct rneagen_options *o)
{
	if (o->layout != RNEAGEN_AOS || (o->precision != RNEAGEN_F32 && o->precision != RNEAGEN_F64))
		return 0;
	if (o->parts != RNEAGEN_PARTS_AUTO || o->segments != RNEAGEN_SEGMENTS_AUTO)
		return 0;
	return owners_matrix(k) && !stage_holds_all(d, o) && turned_samples(d, o) > 0;
}
