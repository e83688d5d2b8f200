#ifndef RNEAGEN_PARTS_H
#define RNEAGEN_PARTS_H
/* Matrices of long chains in parts of the grid: each part makes the elements of some bodies, holds less at once than one
   thread would that makes them all, and is shorter. */

#include "plan/grid/share.h"
#include "plan/plan.h"
#include "plan/stretch.h"
#include "rneagen.h"
#include <limits.h>

/* How the work is divided into parts, and kernels that run one after the other. */
enum division {
	DIVIDED_NOT,
	DIVIDED_BY_COLUMNS, /* elements of matrices, by the bodies that own them (parts.c) */
	DIVIDED_BY_LIMBS,   /* that share nothing (apart.h) */
	DIVIDED_BY_HANDS,   /* what is beyond a cut first (hands/hands.h) */
	DIVIDED_BY_SIDES,   /* of a base that moves freely (hands/base_sides.h) */
	DIVIDED_BASE_FIRST, /* base_first.h */
	DIVIDED_IN_ROUNDS   /* found/found.h */
};

/* With the outputs of some bodies: see owners.h. */
struct part {
	enum division division; /* the same in all parts */
	int first, last; /* bodies */
	int alive;       /* values at once: plan_alive */
	int is_before;   /* it is of a kernel before the main one */
	int level;       /* of which of these */
	const char *what; /* it makes; of a part that shares nothing with others, and of the base's (base_first.h) */
	int joints;      /* motion is made again, in stretches of so many joints (again.h); 0: it is kept */
	struct algorithm algorithm;
	struct function function;
};

/* What is divided. */
struct parts_of {
	const struct function *whole;
	const struct dag *raw; /* the whole as the algorithm made it */
	const struct tree *tree;
	const struct request *request;
	const struct rneagen_options *options;
	int has_kernels;
	int is_unpruned; /* `raw` is what the algorithm makes of the request, and nothing was dropped */
	int is_relayed;  /* it is a kernel of a relay: one part at least */
	int is_transposed; /* outputs are transposed at the end (plan/transposed.h); the options say soa */
};

static inline enum division parts_division(const struct part *parts, int count)
{
	return count ? parts[0].division : DIVIDED_NOT;
}

void parts_divide(struct part *parts, int count, enum division division);

/* Are they those of apart.h, limbs that share nothing or hands? Then each has a slice of its own, and the whole serves small
   batches. */
static inline int parts_are_apart(const struct part *parts, int count)
{
	return count && parts[0].function.stretches != NULL;
}

/* Which of the kernels that run one after the other a part is of: those before the main one by their levels, the main one
   last. */
static inline int part_kernel(const struct part *p)
{
	return p->is_before ? p->level : INT_MAX;
}

/* The array in whose rows parts leave what they hand on to others (hands.h): the last one. */
static inline int parts_handed(const struct dag *d)
{
	return d->argument_count - 1;
}

/* Is each of its elements a joint's, row after row, once, or for q, qd and qdd? (apart.c) */
int parts_is_by_row(const struct argument *a, int nv);

/* The most values at once of one of them. */
int parts_alive(const struct part *parts, int count);

/* In the order of the bodies, as the options ask for; *count is 0 where the text stays whole, as one without kernels
   does. One part: its motion is made again, or it is a relay's. Errors: USAGE, MEMORY. */
enum rneagen_code parts_make(struct part **parts, int *count, const struct parts_of *x, struct arena *a, struct rneagen_error *e);

/* A function of its own with the name and the comment, whose DAG is made; or of a DAG, or of the share of some owners. Returns 0
   when memory runs out. */
int part_plan(struct part *p, const char *name, const char *doc, const struct parts_of *x, struct arena *a);
int part_build(
	struct part *p, const struct dag *raw, const char *name, const char *doc, const struct parts_of *x, struct arena *a);
int part_build_share(struct part *p, struct share *share, int first, int end, const char *name, const char *doc,
	const struct parts_of *x, struct arena *a);

/* Put the lines of one that shares nothing with others into an order in which fewer values wait (plan_order). Returns 0 when
   memory runs out. */
int part_order(struct part *p, enum plan_ordered what, const struct parts_of *x, struct arena *a);

/* What a part takes. */
struct operation_count part_operations(const struct part *p);

/* What all parts take together, or the whole where there are none. */
struct operation_count parts_operations(const struct part *parts, int count, const struct plan *whole);

/* A line for each part, or for the whole where there are none. */
void parts_dump(const struct part *parts, int count, const struct function *whole, const struct tree *t, struct text *out);

#endif
