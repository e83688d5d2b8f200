#ifndef RNEAGEN_PATTERN_H
#define RNEAGEN_PATTERN_H
/* Which elements of a matrix a tree leaves: joints on different branches do not feel each other. */

#include "base/arena.h"

struct tree;

struct pattern {
	int *row; /* [lines][cols]: where an element is stored; -1: nowhere */
	int lines, cols;
	int rows; /* that are stored */
};

/* nv x nv, row by row; of a symmetric matrix the lower triangle alone. `dense`: all of it. Returns 0 when memory runs out. */
int pattern_make(struct pattern *p, const struct tree *t, int symmetric, int dense, struct arena *a);

/* The first element of a line that is stored. */
int pattern_row_begins(const struct pattern *p, int line);

/* The same of what is solved with the mass matrix, where all joints feel each other that hang together. */
int pattern_coupled(struct pattern *p, const struct tree *t, int symmetric, int dense, struct arena *a);

/* Ten columns for each lump (lumps.h), which the joints feel that carry it. */
int pattern_lumps(struct pattern *p, const struct tree *t, int dense, struct arena *a);

/* 6 x nv: the columns of the joints that move a body, a follower's its driver's. */
int pattern_chain(struct pattern *p, const struct tree *t, int body, int dense, struct arena *a);

/* The momentum of all that moves, by joints: 6 x nv, without angular momentum by slides of the one body that carries all. */
int pattern_momentum(struct pattern *p, const struct tree *t, int dense, struct arena *a);

/* All elements of a matrix, or its lower triangle. */
int pattern_whole(struct pattern *p, int lines, int cols, int is_lower, struct arena *a);

#endif
