#ifndef RNEAGEN_STRETCH_H
#define RNEAGEN_STRETCH_H
/* Which rows of its arrays a part of a kernel reads and writes: of each array one stretch, or two where many rows between them
   are none of the part's. */

#include "dag/dag.h"
#include "rneagen.h"

struct stretch {
	int first, rows;
};

enum { STRETCHES = 2 };

/* Arrays of q, qd and qdd, and as many times the rows of all joints in a vjp that stands where these were. */
enum { PERIODS = 3 };

struct stretches {
	int period;   /* rows of a vjp after which it goes on in the place of the next array; 0: no array does */
	int divided;  /* which argument that is */
	int shift;    /* rows further on that its row of a joint stands: q may have more rows than there are velocities */
	int place_of[DAG_ARGUMENTS]; /* whose place an array takes; the vjp's first period that of the first array */
	int second; /* with a gap: rows from this one on are of second stretches */
	int gap;    /* rows between both; in shared memory there are none. 0: all is in the first ones */
	int has_inputs_alone; /* what is written goes to the arrays themselves */
	unsigned periods; /* those of the vjp that are written, by bits */
	int takes_found;  /* qdd and mu, which are read from rows of the vjp, stand in the places of its weights and of its third period
			     (grid/found/found.h) */
	struct stretch found; /* rows of both */
	struct stretch own[DAG_ARGUMENTS][STRETCHES];   /* of each array, or of each period; what nothing is read of has one row,
	                                                  where there are inputs alone none */
	struct stretch place[DAG_ARGUMENTS][STRETCHES]; /* the same where it stands in shared memory: tau in the place of qdd */
};

/* Of the DAG of a part. What it reads of outputs, which an earlier kernel left there, is not among them. With the rows of all
   joints: what a vjp has for q, qd and qdd may stand where these were, and the torque where its weight was (places.h). */
void stretches_make(struct stretches *s, const struct dag *d, int nv);

/* The same of a part that reads what a kernel before has found. */
void stretches_make_found(struct stretches *s, const struct dag *d, int nv);

/* The same of a part that has all rows of each array. */
void stretches_make_whole(struct stretches *s, const struct dag *d, int nv);

/* The rows of inputs alone: of a part of matrices, or one whose outputs do not leave as tiles. */
void stretches_make_inputs(struct stretches *s, const struct dag *d);

/* Does the part write every row of its stretches of outputs? */
int stretches_are_written(const struct stretches *s, const struct dag *d);

/* Rows that the place of an array has. */
int stretches_rows(const struct stretches *s, int argument);

/* What is found, qdd and mu: whose place each takes, and the row of the vjp that it begins with. */
enum { FOUND_QDD, FOUND_MU, FOUND_COUNT };
int stretches_found_place(const struct dag *d, int found);
int stretches_found_row(const struct stretches *s, int found);

/* Words of shared memory that they take for a sample. */
int stretches_words(const struct stretches *s, const struct dag *d, const struct rneagen_options *o);

/* So that it holds this row. */
void stretch_widen(struct stretch *s, int row);

#endif
