#ifndef RNEAGEN_STRETCH_H
#define RNEAGEN_STRETCH_H
/* Which rows of its arrays a part of a kernel reads and writes: of each array one stretch, or two where many rows between them are
   none of the part's. */

#include "dag/dag.h"
#include "rneagen.h"

struct stretch {
	int first, rows;
};

enum { STRETCHES = 2 };

struct stretches {
	int second; /* with a gap: rows from this one on are of second stretches */
	int gap;    /* rows between both; in shared memory there are none. 0: all is in the first ones */
	struct stretch own[DAG_ARGUMENTS][STRETCHES];   /* of each array; what nothing is read of has one row */
	struct stretch place[DAG_ARGUMENTS][STRETCHES]; /* the same where it stands in shared memory: tau in the place of qdd */
};

/* Of the DAG of a part. What it reads of outputs, which an earlier kernel left there, is not among them. */
void stretches_make(struct stretches *s, const struct dag *d);

/* Does the part write every row of its stretches of outputs? */
int stretches_are_written(const struct stretches *s, const struct dag *d);

/* Rows that the place of an array has. */
int stretches_rows(const struct stretches *s, int argument);

/* Words of shared memory that they take for a sample. */
int stretches_words(const struct stretches *s, const struct dag *d, const struct rneagen_options *o);

/* So that it holds this row. */
void stretch_widen(struct stretch *s, int row);

#endif
