#ifndef RNEAGEN_RELAY_H
#define RNEAGEN_RELAY_H
/* A relay: a launch of gradients of qdd runs three kernels, one after the other. The first finds qdd. The second, in parts,
   leaves -d tau at that qdd where the gradients belong. The third makes M^-1 of these columns in their places. So no kernel holds
   what the others make; where one kernel does all, each part of it makes M and qdd anew. */

#include "plan/grid/parts.h"

struct relay {
	struct part start, solve;
	struct part *starts;    /* start_count of them: the first kernel in parts that share nothing (apart.h); 0: it is whole */
	int start_count;
	struct function between;    /* all parts of the second kernel together */
	int samples;            /* of a block of the third kernel: a warp's, or of two warps */
	int threads;            /* for each of these samples; they share its columns */
	int blocks;             /* of them, a multiprocessor is to have room for so many */
	int room;               /* so many share the columns of small batches at most */
};

/* `x` tells of the one kernel. *relay is NULL where that serves, or a relay does not; else the parts are of its second kernel.
   Errors: as of parts_make. */
enum rneagen_code relay_or_parts(struct relay **relay, struct part **parts, int *count, const struct parts_of *x, struct arena *a,
	struct rneagen_error *e);

/* The limbs of the first kernel, where small batches have them. Returns 0 when memory runs out. */
int relay_limbs(struct relay *r, const struct rneagen_options *o, struct arena *a);

/* Bytes of shared memory of a block of the third kernel. */
int relay_bytes(const struct relay *r, const struct rneagen_options *o);

/* How many columns its third kernel solves. */
int relay_columns(const struct relay *r);

/* A line for the first kernel, one for the third. */
void relay_dump(const struct relay *r, struct text *out);

/* What its kernels take together, with parts for the second. */
struct operation_count relay_operations(const struct relay *r, const struct part *parts, int count);

#endif
