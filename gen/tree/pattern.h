#ifndef RNEAGEN_PATTERN_H
#define RNEAGEN_PATTERN_H
/* Which elements of a matrix a tree leaves: joints on different branches do not feel each other. */

#include "base/arena.h"

struct tree;

struct pattern {
	int *row; /* [nv][cols]: where an element is stored; -1: nowhere */
	int rows, cols;
};

/* nv x nv, row by row; of a symmetric matrix the lower triangle alone. `dense`: all of it. Returns 0 when memory runs out. */
int pattern_make(struct pattern *p, const struct tree *t, int symmetric, int dense, struct arena *a);

/* The same of what is solved with the mass matrix, where all joints feel each other that hang together. */
int pattern_coupled(struct pattern *p, const struct tree *t, int symmetric, int dense, struct arena *a);

/* Ten columns for each lump (lumps.h), which the joints feel that carry it. */
int pattern_lumps(struct pattern *p, const struct tree *t, int dense, struct arena *a);

#endif
