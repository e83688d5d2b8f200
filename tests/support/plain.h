#ifndef TESTS_PLAIN_H
#define TESTS_PLAIN_H
/* The model's constants for tests that compute with plain numbers. */

#include "tree/spatial.h"

/* Exactly these. */
static inline void exact(struct within *to, const real *from, int count)
{
	for (int i = 0; i < count; i++)
		to[i] = within_exact(from[i]);
}

static inline void exact_doubles(struct within *to, const double *from, int count)
{
	for (int i = 0; i < count; i++)
		to[i] = within_exact((real)from[i]);
}

/* As texts have them. */
static inline void plain(real *to, const struct within *from, int count)
{
	for (int i = 0; i < count; i++)
		to[i] = from[i].x;
}

static inline struct rotation exact_rpy(const double rpy[3])
{
	struct within angles[3];

	exact_doubles(angles, rpy, 3);
	return rotation_rpy(angles);
}

static inline int is_identity(const struct rotation *r)
{
	for (int i = 0; i < 3; i++)
		for (int j = 0; j < 3; j++)
			if (r->m[i][j].x != (i == j))
				return 0;
	return 1;
}

/* v turned by r */
static inline void turned(const struct rotation *r, const real v[3], real out[3])
{
	struct within u[3];

	exact(u, v, 3);
	rotation_apply(r, u, u);
	plain(out, u, 3);
}

#endif
