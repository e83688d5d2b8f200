/* Digits that are not wanted. */
#include "tree/tree.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

/* The locale, whatever it is, is the same on the way out and on the way back. What is rounded is what is meant. */
static void round_each(struct within *x, int count, int digits)
{
	char text[64];
	real rounded;

	for (int i = 0; i < count; i++) {
		snprintf(text, sizeof text, "%.*Le", digits - 1, x[i].x);
		rounded = strtold(text, NULL);
		x[i] = rounded == roundl(rounded) ? within_exact(rounded) : within_decimal(rounded, rounded);
	}
}

void tree_round(struct tree *t, int digits)
{
	for (int i = 0; i < t->body_count; i++) {
		struct body *k = &t->bodies[i];

		round_each(&k->X.R.m[0][0], 9, digits);
		round_each(k->X.p, 3, digits);
		round_each(&k->inertia.mass, 1, digits);
		round_each(k->inertia.h, 3, digits);
		round_each(k->inertia.I, 6, digits);
	}
}
