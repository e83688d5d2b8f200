#ifndef RNEAGEN_HANDS_H
#define RNEAGEN_HANDS_H
/* Torques of a robot with hands, in soa also with their vjp, by several kernels, one after the other. The first has a part for
   each hand: what lies beyond a body that carries several others, such as the fingers beyond a palm. It makes the motion of the
   arm anew, writes the torques of the hand, and leaves what the hand hands on, the six numbers of a force and twelve more for a
   vjp, in rows of the last array that belong to the arm. The last reads these numbers before it writes the rows. So no thread
   holds an arm and a hand at once. Where an arm is as long as a snake, its end is a hand in its turn, in one more kernel between
   both, and so on. */

#include "plan/grid/hands/cut.h"
#include "plan/grid/parts.h"

/* How many kernels there may be for hands. */
enum { HAND_LEVELS = 8 };

struct hand {
	int body;           /* that carries it */
	int first, last;    /* bodies of it, but for those of hands before */
	int level;          /* the kernel of which it is a part */
	struct cut cut;     /* nodes of what its kernel is made from: what it hands on */
	int rows[CUT_MOST]; /* of the last array: where that stands meanwhile */
};

/* What the hands of one kernel leave undone. */
struct hand_level {
	struct dag first; /* what hands before have left, and stores of what is handed on */
	int *owner;       /* by output of it: the hand that writes it; -1: none does */
	struct dag rest;  /* without the hands' torques; what is handed on is read from tau */
};

struct hands {
	struct hand *list; /* level by level */
	int count;         /* 0: there are none, or several kernels do not serve */
	struct hand_level *levels;
	int level_count;   /* HAND_LEVELS at most */
	int is_base;       /* they are limbs of a base that moves freely */
	int is_full;       /* the whole holds so much that parts spill less though they stage nothing */
};

/* Returns 0 when memory runs out. */
int hands_find(struct hands *h, const struct parts_of *x, struct arena *a);

/* One side of a base as the hand of a DAG that makes the base's acceleration alone (grid/base_first.h). Returns 0 when memory
   runs out. */
int hands_find_felt(struct hands *h, const struct dag *base, const struct parts_of *x, struct arena *a);

#endif
