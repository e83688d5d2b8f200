#include "plan/transposed.h"
#include "plan/grid/owners.h"
#include "plan/stage.h"

/* Samples of a block: those of two sectors of memory in f32, or as few as fill one. Shared memory of a block at most: what all
   GPUs have since compute capability 7.5. */
enum { MANY = 16, MOST_BYTES = 64 << 10 };

/* Blocks that shared memory allows, of the 227 KiB of an H100, are to fill a multiprocessor with threads. H200, a kernel alone
   that transposes 900 rows of which 494 are kept, ps a sample: f32 2080 with 256 threads, 1900 with 320, 1960 with 512; f64 by 8
   samples 3740 with 256. With all rows in shared memory: 3400 in f32. */
enum { FEWEST_THREADS = 256, MOST_THREADS = 512 };

struct rneagen_options transposed_options(const struct rneagen_options *o, int is_transposed)
{
	struct rneagen_options own = *o;

	if (is_transposed)
		own.layout = RNEAGEN_SOA;
	return own;
}

/* From one row to the next there is room for a sample more, so that threads are in different banks. Where rows are zero, they
   share one row more, and tables say of each row where it is kept and of each that is kept which it is. */
static int array_bytes(int rows, int kept, int samples, const struct rneagen_options *o)
{
	int row = (samples + 1) * stage_number_bytes(o);

	return kept < rows ? (kept + 1) * row + (rows + kept) * (int)sizeof(unsigned short) : rows * row;
}

static int bytes_of(const struct dag *d, const int *kept, int samples, const struct rneagen_options *o)
{
	int most = 0;

	for (int i = 0; i < d->argument_count; i++) {
		const struct argument *a = &d->arguments[i];
		int bytes = a->is_output ? array_bytes(a->rows, kept ? kept[i] : a->rows, samples, o) : 0;

		if (bytes > most)
			most = bytes;
	}
	return most;
}

static int threads_of(int bytes)
{
	int threads = MULTIPROCESSOR_THREADS / (MULTIPROCESSOR_BYTES / bytes) / WARP_THREADS * WARP_THREADS;

	return threads < FEWEST_THREADS ? FEWEST_THREADS : threads > MOST_THREADS ? MOST_THREADS : threads;
}

struct transposed transposed_of(const struct dag *d, const int *kept, const struct rneagen_options *o)
{
	for (int samples = MANY; samples * stage_number_bytes(o) >= SECTOR_BYTES; samples /= 2) {
		int bytes = bytes_of(d, kept, samples, o);

		if (bytes <= MOST_BYTES)
			return (struct transposed){samples, threads_of(bytes), bytes};
	}
	return (struct transposed){0, 0, 0};
}

int transposed_may_be(const struct dag *d, const struct request *k, const struct rneagen_options *o)
{
	if (o->layout != RNEAGEN_AOS || !stage_is_plain(o))
		return 0;
	if (o->parts != RNEAGEN_PARTS_AUTO || o->segments != RNEAGEN_SEGMENTS_AUTO)
		return 0;
	return owners_matrix(k) && !stage_holds_all(d, o) && transposed_of(d, NULL, o).samples > 0;
}
