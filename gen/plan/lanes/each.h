#ifndef RNEAGEN_EACH_H
#define RNEAGEN_EACH_H
/* Limbs that are alike (tree/alike.h), one after the other: a kernel holds the lines of one of them, in a loop, and a constant
   that is not the same in all is read from a table. Nodes of such a loop are wide, as those of lanes are, and the loop makes
   one lane in each turn. What the other lines take of a limb leaves the loop as a number of its own, an OP_LANE0 to OP_LANE3. A
   kernel of a long text has no turns: each limb of a sample has a thread, and the first one goes on with what the others leave.
   */

#include "plan/grid/parts.h"

/* Make p->function.each, the part once more with such loops, and p->joints where motion is made again in it; NULL where no
   limbs are alike, where their rows do not stand evenly, or where a loop takes what it has left. Returns 0 when memory runs
   out. */
int each_make(struct part *p, const struct parts_of *x, struct arena *a);

/* Put the lines of each loop of a function together. *serves is 0 where a loop takes what it has left itself; *is_apart: none
   takes what another one has left. Returns 0 when memory runs out. */
int each_gather(int *serves, int *is_apart, struct function *p, struct arena *spare, struct arena *a);

/* Whether each limb is to have threads of its own (each_threads.c): the samples that a block then has at most, as many as leave
   room in its own 48 KiB for what limbs leave to the trunk; 0: limbs are turns of a loop. */
int each_most_block(const struct function *p, const struct parts_of *x);

/* The limb, from 0, of which a line is what leaves the loop; -1: it is none such. */
int each_left_by(const struct plan *p, size_t line);

/* Operations of a function with loops, each of a loop as often as it is made. */
struct operation_count each_operations(const struct function *p);

/* The loop of a line, from 1; 0: it is in none. */
int each_of_line(const struct function *p, const struct line *l);

#endif
