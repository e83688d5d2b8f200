#ifndef RNEAGEN_HANDS_H
#define RNEAGEN_HANDS_H
/* Torques of a robot with hands by two kernels, one after the other. The first has a part for each hand: what lies beyond a body that
   carries several others, such as the fingers beyond a palm. It makes the motion of the arm anew, writes the torques of the hand, and
   leaves what the hand hands on, the six numbers of a force, in rows of tau that belong to the arm. The second reads these numbers
   before it writes the rows. So no thread holds an arm and a hand at once. */

#include "plan/grid/cut.h"
#include "plan/grid/parts.h"

struct hand {
	int body, last;     /* that carries it; the last one of the hand */
	struct cut cut;     /* nodes of the whole: what it hands on */
	int rows[CUT_MOST]; /* of tau: where that stands meanwhile */
};

struct hands {
	struct hand *list;
	int count;          /* 0: there are none, or two kernels do not serve */
	struct dag first;   /* the whole, and stores of what is handed on */
	int *owner;         /* by output of it: the hand that writes it; -1: none does */
	struct dag second;  /* without the hands' torques; what is handed on is read from tau */
};

/* Returns 0 when memory runs out. */
int hands_find(struct hands *h, const struct parts_of *x, struct arena *a);

/* Does the plan of a part of the second kernel read what a hand left before it writes there? */
int hands_are_read_first(const struct plan *p, const struct hands *h);

#endif
