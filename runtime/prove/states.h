#ifndef RUNTIME_PROVE_STATES_H
#define RUNTIME_PROVE_STATES_H
/* States of a box, as a text takes them: rows of one input after those of another. */

#include "range/seek.h"

struct states {
	const struct analysis *a;
	const struct box *b;
	size_t at[DAG_ARGUMENTS], size; /* where an input's rows begin; of all inputs */
};

void states_of(struct states *s, const struct analysis *a, const struct box *b);

/* Into in[argument], NULL for outputs. */
void states_point(const struct states *s, double *state, double **in);

/* Quaternions of length 1, all else within its range. */
void states_settle(const struct states *s, double *const *in);

/* Anywhere in q, at corners of all else. */
void states_draw(const struct states *s, double *const *in, unsigned short seed[3]);

/* A step along one row that stays in the box: an angle or length by `step` of its range, anything else to its other end. */
void states_move(const struct states *s, double *const *in, int argument, int row, double step);

/* Does a row have more than one value? */
int states_is_free(const struct states *s, int argument, int row);

/* What a search over the relaxed box has found, as near as a state of the text's comes: positions, rates, accelerations and freed
   constants; other rows stay as they are. */
void states_take(const struct states *s, const struct relaxed *r, const struct field *f, const struct sought *found,
	double *const *in);

/* What a search works in: a state, the one before it, and room for a text's outputs. */
struct states_room {
	double *state, *before, *out, *in[DAG_ARGUMENTS], *outs[DAG_ARGUMENTS]; /* in, outs: by argument */
	size_t size;
};

/* Returns 0 when memory runs out; states_room_free in either case. */
int states_room_make(struct states_room *r, const struct states *s);
void states_room_free(struct states_room *r);

/* What is climbed: what a state of the room is worth. */
struct states_climb {
	double (*value)(void *context, struct states_room *r);
	void (*fit)(void *context, struct states_room *r); /* puts a state right that a step has made; NULL: nothing */
	void *context;
	double step; /* of the first round, of a range */
	int rounds;
	double deadline; /* as seconds_now has it */
};

/* Uphill from the state in the room, by one row after the other. Returns the value. */
double states_climb(const struct states *s, struct states_room *r, const struct states_climb *c);

/* Uphill from states that were `found`, by two for each output as fields have them: the smallest and the largest value
   that the text has at states that are found, into values, and these states. Returns 0 when memory runs out. */
int states_seek(const struct states *s, double (*values)[2], double *(*best)[2], const struct effort *x, double seconds);

#endif
