#ifndef RUNTIME_PEAKS_PEAKS_H
#define RUNTIME_PEAKS_PEAKS_H
/* The largest magnitudes of values, and lengths of pairs of them, over a whole box: from points of q, where they are
   known for all drives and rates at once, and what they can be between the points. */

#include "norms/adjoint.h"
#include "norms/norms.h"

enum { PEAKS_DIMS = 64 };

/* One value, or two. */
struct peak {
	uint32_t nodes[2]; /* of the adjoint's DAG */
	uint32_t pair;	   /* of two: as norms_pair has it; else 0 */
	double weight;	   /* how much it matters; 0: it is left out */
	double most;	   /* no length is larger */
	/* of peaks_find: */
	int kind;
	double found;		/* the largest at points of the last grid; 0: there was none */
	double whole;		/* `most` for all angles, not those of the box alone */
	uint64_t dims;		/* bit k: it depends on dims[k] */
	double *tilts, *bends;	/* by dims, for all angles: no first, no second derivative by q is longer */
	double *near;		/* the same of second ones in the box alone */
	unsigned char *degrees; /* by dims: of a polynomial of sine and cosine, or of a length */
	/* of who asks about it without some rows of q (../prove/crests/frontier.h): */
	uint64_t cut;	   /* these, none of dims */
	int rates, drives; /* what it reads beside q */
	int steps;	   /* operations that it takes */
};

struct peaks {
	const struct dag *text; /* of which `x` is the adjoint */
	size_t output;
	const struct adjoint *x;
	const struct norms *norms;
	const struct norms_values *values;  /* over the whole box */
	const struct interval *const *rows; /* the box, by argument */
	int position;			    /* the argument q */
	const int *dims;		    /* its rows that have room */
	int dim_count;
	double deadline; /* as seconds_now has it; after it what has been found counts */
	struct peak *list;
	size_t count;
	struct arena *arena;
	/* of peaks_find: */
	struct interval *whole_rows[DAG_ARGUMENTS]; /* the box, but for angles, which are all */
	struct norms_values whole;		    /* over these */
	unsigned char *is_angle;		    /* by dims: q is read by its sine and cosine alone */
	double *noise; /* by node of the adjoint: what is computed at a point of these rows is no further off */
	uint64_t *reads; /* by node of the adjoint: bit k, it depends on dims[k]; NULL: there was no time for it */
};

/* Lowers `most` of all in p->list that have a weight, where that gains, and where there is time for it. Returns 0 when
 * memory runs out. */
int peaks_find(struct peaks *p);

/* ---- its parts ---- */

/* How values depend on drives and rates: not; linearly on rates, whose ranges have 0 in the middle; or as fields do. */
enum { PEAK_UNKNOWN, PEAK_PLAIN, PEAK_LINEAR, PEAK_FULL };

static inline int peak_is_asked(const struct peak *k)
{
	return k->kind != PEAK_UNKNOWN && k->weight > 0;
}

/* More than every degree that is used. */
enum { PEAK_NO_DEGREE = 100 };

/* peaks_marks.c: what is known of all nodes, into the list. Returns 0 when memory runs out. */
int peaks_mark(struct peaks *p);

/* peaks_bends.c: into list[].tilts, bends and near, until the deadline; INFINITY is what is not known. Returns 0 when
 * memory runs out. */
int peaks_bends(struct peaks *p, double deadline);

/* Of one kind, which depend on the same rows of q. */
struct peaks_group {
	int kind;
	uint64_t dims;
	unsigned char *degrees; /* by dims, the largest of its members */
	size_t *members, count; /* of list */
	double weight;
};

/* peaks_grid.c: at points of one group, into list[].whole and list[].most. Returns 0 when memory runs out. */
int peaks_grid(struct peaks *p, const struct peaks_group *g, double deadline);

#endif
