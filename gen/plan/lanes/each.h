#ifndef RNEAGEN_EACH_H
#define RNEAGEN_EACH_H
/* Limbs that are alike (tree/alike.h), one after the other: a kernel holds the lines of one of them, in a loop, and a constant
   that is not the same in all is read from a table. Nodes of such a loop are wide, as those of lanes are, and the loop makes one
   lane in each turn. What the other lines take of a limb leaves the loop as a number of its own, an OP_LANE0 to OP_LANE3. */

#include "plan/grid/parts.h"

/* Make p->function.each, the part once more with such loops, and p->joints where motion is made again in it; NULL where no
   limbs are alike, where their rows do not stand evenly, or where a loop takes what it has left. Returns 0 when memory runs
   out. */
int each_make(struct part *p, const struct parts_of *x, struct arena *a);

/* Put the lines of each loop of a function together. *serves is 0 where a loop takes what it has left itself. Returns 0 when
   memory runs out. */
int each_gather(int *serves, struct function *p, struct arena *spare, struct arena *a);

/* Operations of a function with loops, each of a loop as often as it is made. */
struct operation_count each_operations(const struct function *p);

/* The loop of a line, from 1; 0: it is in none. */
int each_of_line(const struct function *p, const struct line *l);

#endif
