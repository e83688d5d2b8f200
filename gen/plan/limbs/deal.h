#ifndef RNEAGEN_DEAL_H
#define RNEAGEN_DEAL_H
/* Lines of a plan dealt out to warps, phase by phase: what limbs.c tries. */

#include "plan/limbs/limbs.h"
#include "plan/readings.h"

/* A phase takes for each warp at most so many operations; which, is tried from a share of the whole up to the whole. */
enum { MOST_WARPS = 16, MOST_PHASES = 8, TOO_MUCH = 1 << 30 };

/* What to try: the operations that a warp may take in each phase; how many of a line's, with all that it takes, another warp may
   make in the same phase too; whether sines come first, in a phase of their own. */
struct deal {
	int warps, has_sines;
	unsigned most[MOST_PHASES], repeated;
};

/* Values that go from warp to warp. */
struct crossing {
	int *slot;             /* by node; -1: it does not cross */
	unsigned char *last;   /* by node: the last phase that fetches it */
	unsigned char *seen;   /* by node, of a warp */
};

/* What deals know of a line, side by side, since walks over lines take most of their time. */
struct dealt_line {
	uint32_t weight; /* operations */
	uint32_t own;    /* a bit for each warp that has its values */
	int made;        /* 1 + the phase that makes it first; 0: none yet */
	uint32_t seen;   /* the last walk that has been there */
};

/* What the first phases of a deal have done. */
struct dealt {
	struct dealt_line *line;
	unsigned char *did;
	unsigned longest, sum;
	int phases;
};

struct dealer {
	const struct plan *p;
	struct readings readings;
	const struct limbs_limits *limits;
	struct arena *a;
	uint32_t lines;
	struct dealt_line *line;
	uint32_t *before, *begin;  /* by line, from its begin to the next one's: the lines that make what it reads, each once */
	unsigned char *did;        /* by warp and line: 1 + the phase in which the warp makes it; 0: it does not */
	uint32_t *cone, *first_cone; /* by line: operations that it takes from what is there; in the first phase */
	uint32_t *order;           /* lines of a phase, those that take most first */
	uint32_t now;              /* the walk */
	uint32_t *stack, *walked, walked_count;
	struct crossing crossing;
	uint32_t *last_read, *ends; /* of a warp, by node: which of its lines reads it last; by line: how many it is the last to read */
	unsigned load[MOST_WARPS], repeated;
	int warps, phase;  /* the phase that is dealt out; of a deal that was run, how many it has */
	struct dealt kept; /* where a deal begins */
	/* what a deal comes to */
	unsigned longest, sum; /* operations of the longest warp, and of all */
};

/* Arrays of a dealer whose p, limits, a and lines are set. Returns 0 when memory runs out. */
int deal_begin(struct dealer *x);

/* Deal out. Returns the cost: the operations of the longest warp, and a share of those of all; TOO_MUCH where the phases do not
   suffice or `enough` is reached. */
unsigned deal_run(struct dealer *x, const struct deal *deal, unsigned enough);

/* Deals begin with the first phases of this one from here on, and differ from it after these alone; 0: with none. Returns 0
   where nothing is left after them. */
int deal_keep(struct dealer *x, const struct deal *deal, int phases);

/* 1 + the phase in which a warp makes a line; 0: it does not. */
static inline unsigned char deal_did(const struct dealer *x, int warp, uint32_t line)
{
	return x->did[(size_t)warp * x->lines + line];
}

/* Operations of the sines that a warp has where they are shared out; of a line, where a sine with its cosine is 24, and what is
   read or stored one. */
unsigned deal_sines_most(const struct dealer *x, int warps);
unsigned deal_weight(const struct readings *r, size_t line);

/* Of the deal which was run last: slots that it takes; values that a warp has at once; its lines, a plan for each warp. */
int deal_slots(struct dealer *x);
int deal_alive(struct dealer *x);
void deal_plans(struct dealer *x, struct limbs *s);

#endif
