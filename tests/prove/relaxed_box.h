#ifndef TESTS_RELAXED_BOX_H
#define TESTS_RELAXED_BOX_H
/* A robot_box whose expressions are relaxed and split into fields, and what the relaxed inputs are in its states. */

#include "prove/robot_box.h"
#include "relax/relax.h"

struct relaxed_box {
	struct robot_box x;
	struct relaxed relaxed;
	struct box box;            /* of the relaxed inputs */
	double *in[DAG_ARGUMENTS]; /* these in a state */
	struct field *fields;
	int count;                 /* of fields */
};

enum { RELAXED_BOX_CASES = 15 };

/* As robot_box_open, which see for the name; one of the robots that each test takes in turn. robot_box_close(&s->x) closes it. */
void relaxed_box_open(struct relaxed_box *s, const char *name, const char *scene);
void relaxed_box_case(struct relaxed_box *s, int number);

/* What the relaxed inputs are in the state that was drawn: the text's, and values of its nodes. They are in their ranges, those
   of balls too, or the test fails. */
void relaxed_box_see(struct relaxed_box *s);

/* Draws a state, and gives the values of all nodes of the relaxed DAG there. */
void relaxed_box_values(struct relaxed_box *s, struct rng *r, double *v);

#endif
