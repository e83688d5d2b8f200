#ifndef RUNTIME_RANGE_PARTS_CUT_H
#define RUNTIME_RANGE_PARTS_CUT_H
/* A limb apart from what carries it: how the body moves at which it is cut off is a rate and drives of its own, w and dw, a, each
   number with its range. So the limb's torques depend on its own rows of q alone, and grids serve. What is lost is that the body
   cannot move in all ways at once. The loads of the limbs cut off are then drives for what carries them, each number with its
   range. */

#include "range/grid.h"
#include "range/parts/loads.h"

struct cut {
	int body;               /* index into the tree */
	struct relaxed relaxed; /* its outputs are some of those that it was cut from */
	struct box box;
	uint32_t *leaves;       /* of a limb: nodes of the DAG that it was cut from, rows of its last two inputs: rates, and drives */
	int leaf_count;
	int *outputs;           /* of them, the numbers that they had; of loads, that of all outputs and their own on top */
	struct loads loads;
	int load_count;         /* [limb][total] */
	struct field *fields;
	int field_count;
};

/* Limbs of outputs that depend on `from` rows of q or more, of `dims` rows themselves at most, into *cuts, which live in `a`;
   ranges of what moves them are found in about `seconds`. Returns how many; -1 when memory runs out. */
int cut_make(struct cut **cuts, const struct relaxed *r, const struct field *fields, int field_count, int from, int dims,
	const struct effort *x, double seconds, struct arena *a);

/* Would it cut elsewhere with limbs of so many rows? -1 when memory runs out. */
int cut_differs(const struct relaxed *r, const struct field *fields, int field_count, int from, int dims, int others,
	struct arena *a);

/* Are torques cut off, or loads alone? */
int cut_has_torques(const struct cut *cuts, int count);

/* What carries the limbs, of fields with `from` rows of q or more, into *rest; ranges[cut][load]. Returns 1; 0: it is not made,
   there is nothing to be cut; -1 when memory runs out. */
int cut_rest(struct cut *rest, const struct relaxed *r, const struct field *fields, int field_count, int from,
	const struct cut *cuts, int cut_count, struct interval *const *ranges, struct arena *a);

#endif
