#ifndef RNEAGEN_STRETCH_H
#define RNEAGEN_STRETCH_H
/* Which rows of its arrays a part of a kernel reads and writes: of each array one stretch. */

#include "dag/dag.h"
#include "rneagen.h"

struct stretch {
	int first, rows;
};

struct stretches {
	struct stretch own[DAG_ARGUMENTS];   /* of each array; what nothing is read of has one row */
	struct stretch place[DAG_ARGUMENTS]; /* the same where it stands in shared memory: tau in the place of qdd */
};

/* So that it holds this row. */
void stretch_widen(struct stretch *s, int row);

/* Of the DAG of a part. */
void stretches_make(struct stretches *s, const struct dag *d);

/* Words of shared memory that they take for a sample. */
int stretches_words(const struct stretches *s, const struct dag *d, const struct rneagen_options *o);

#endif
