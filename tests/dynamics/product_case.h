#ifndef TESTS_PRODUCT_CASE_H
#define TESTS_PRODUCT_CASE_H
/* A drawn scene with a set of outputs, and the numbers that go into it. */

#include "support/rng.h"
#include "support/scene_model.h"

enum { MOST_OTHERS = 8, VALUES = 4096 };

struct drawn_case {
	struct rng rng;
	const char *what, *urdf;
	struct rneagen_options options;
	char scene[1024], of[512]; /* what is free or pushes; the set, by commas */
	int is_forward, by_all;
	struct scene_model values, products;
	struct given {
		char name[80];
		real at[ROWS], along[ROWS];
		int rows;
	} given[4 + MOST_OTHERS]; /* q, qd, qdd or tau, then others, by the names of arguments */
	int given_count;
	real v[3 * ROWS], weights[VALUES];
};

/* Append to a text. */
void say(char *to, size_t room, const char *fmt, ...);

/* What is free or pushes, and how things are made: x->scene; and the outputs: x->of. */
void draw_others(struct drawn_case *x, const struct tree *t);
void draw_set(struct drawn_case *x, const struct tree *t);

/* A state, a direction and weights, for x->products. */
void draw_numbers(struct drawn_case *x);

#endif
