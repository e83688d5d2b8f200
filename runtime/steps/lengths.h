#ifndef RUNTIME_STEPS_LENGTHS_H
#define RUNTIME_STEPS_LENGTHS_H
/* Spans of all forms over a box, and norms of sets of a few of them. What is used of a set, each checked on the forms when it is
   made: - a turn and its mate, (c x + s y, c y - s x), may be replaced by (x, y); a turn without one too;
   - of a set of sums, the norm is at most that of one term of each, and that of the others, together;
   - a member stands at a right angle to the others;
   - a norm is at most the root of the squares. */

#include "steps/form.h"

enum { SET_MEMBERS = 4 };

struct length_set {
	uint32_t members[SET_MEMBERS], last; /* forms, ascending; a form may be there twice */
	int count;
	uint32_t one, other;   /* 1 + sets: it is at most their sum; 0: none */
	uint32_t beside, apart; /* 1 + the set without the form `apart`; 0: none */
};

struct lengths {
	const struct forms *forms;
	struct length_set *sets;
	uint32_t count, limit, *table, table_size;
	uint32_t *order, *first; /* sets by `last` */
	struct span *value;      /* by form */
	double *norm;            /* by set */
};

/* With sets for all turns. Returns 0 when memory runs out. */
int lengths_make(struct lengths *x, const struct forms *f, struct arena *a);

/* 1 + the set of two forms, made before lengths_close; 0: there is no room. */
uint32_t lengths_pair(struct lengths *x, uint32_t a, uint32_t b);

/* When all sets are there. Returns 0 when memory runs out. */
int lengths_close(struct lengths *x, struct arena *a);

/* Fill value and norm; rows[argument] are those of an input. */
void lengths_evaluate(struct lengths *x, struct span *const *rows);

#endif
