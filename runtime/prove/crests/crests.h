#ifndef RUNTIME_PROVE_CRESTS_H
#define RUNTIME_PROVE_CRESTS_H
/* The largest magnitudes over the whole box of a few values and derivatives that points (peaks.h) leave rough: as
   closely as the range of an output is found, by knots, how much they bend, and a cover. Derivatives that are linear in
   rates are those of a field whose drives are the rates. What depends on too many rows of q is cut (frontier.h). */

#include "peaks/peaks.h"
#include "range/grid.h"
#include "relax/relax.h"

struct crest {
	const struct peak *peak; /* of a kind that is known; in the arena of struct peaks, or its list */
	uint32_t node;		 /* one of its */
	double cost;		 /* seconds, about */
	double most;		 /* no magnitude is larger */
	double before;		 /* what was known when it was chosen */
};

struct crests {
	const struct relaxed *relaxed; /* of which p->text is the DAG */
	const struct peaks *p;	       /* what is known of its nodes */
	const struct effort *effort;
};

/* Is it a polynomial of angles, drives and rates, and was it seen somewhere? */
int crests_are_known(const struct peak *k);

/* Are there knots enough for such a one, and not too many? k->rates and k->drives are known. */
int crests_fit(const struct peaks *p, const struct peak *k);

/* sample.c: raises p->list[].found to what a few states have. Returns 0 when memory runs out. */
int crests_sample(struct peaks *p);

/* Lowers list[].most, with about `cost` seconds each. Returns 0 when memory runs out. */
int crests_find(const struct crests *c, struct crest *list, size_t count);

/* ---- which ---- */

struct crests_choice {
	const struct peaks *p;
	struct norms_values *values;	/* of which `most` caps what is chosen */
	double (*error)(void *context); /* with the caps that there are */
	void *context;
	double seconds; /* for all that are chosen */
	double quick;	/* one may take so long before more rows of q are cut */
	double slower;	/* what is cut gets so many times the time that it needs at least */
	double close;	/* what is cut is thought to come so near to what was found: 2 is twice that */
};

/* choose.c: those that lower the error most for their time, into list[], which has room for twice as many as there are
   peaks. Returns how many. */
size_t crests_choose(const struct crests_choice *c, struct crest *list);

/* Knots that it takes at first, and when all waves that cancel are gone; numbers at each. */
double crests_knots(const struct peaks *p, const struct peak *k, int is_lowered);
double crests_numbers(const struct peak *k);

/* As many of one field as there is room for. */
double crests_together(const struct peaks *p, const struct peak *k);

#endif
