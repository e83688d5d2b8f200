#ifndef RNEAGEN_TRANSPOSED_H
#define RNEAGEN_TRANSPOSED_H
/* In layout aos, outputs that kernels write as in soa: of some samples at a time, the block's, as [row][sample], where these
   samples' [sample][row] belongs. A last kernel transposes each block, in its place. So threads write whole sectors, and
   matrices have the parts, the kernels and the relays of soa. */

#include "plan/plan.h"

/* Of the last kernel: the samples of a block, 16 or fewer, whose outputs have room in shared memory; 0: none have. */
struct transposed {
	int samples, threads, bytes;
};

/* `kept`, by argument: how many rows of an output the kernels before have written. The other rows are zero, and only the last
   kernel writes them. NULL: all were written. */
struct transposed transposed_of(const struct dag *d, const int *kept, const struct rneagen_options *o);

/* May this be done with the matrices of a function, if it is in parts or a relay's? Not where all arrays have room as slices. */
int transposed_may_be(const struct dag *d, const struct request *k, const struct rneagen_options *o);

/* What the kernels are planned and written by: these options, in layout soa where outputs are transposed. */
struct rneagen_options transposed_options(const struct rneagen_options *o, int is_transposed);

#endif
