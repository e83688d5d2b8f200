#ifndef RNEAGEN_SAVING_H
#define RNEAGEN_SAVING_H
/* What each choice of a scene saves, or costs: the text with the scene beside the one without, and beside those where a
   single choice is left out. */

#include "plan/plan.h"
#include "rneagen.h"

/* What a sample costs. */
struct saving {
	int line;          /* of the scene that is left out, an index; SAVING_FULL: all; SAVING_SCENE: none */
	int is_known;      /* 0: what is left is no scene */
	long flops;        /* an FMA for two */
	int alive;         /* values alive at once: about the registers */
	int bytes;         /* of its rows in memory */
};

enum { SAVING_FULL = -2, SAVING_SCENE = -1 };

/* Memory of an H100 moves 3 TB/s; on another device the floor is another. */
#define SAVING_BANDWIDTH 3e12

/* Fills t->savings where there is a scene, which `now` is the plan of. A range that inputs are drawn from chooses nothing.
   Errors: MEMORY. */
enum rneagen_code saving_measure(struct tree *t, const struct plan *now, const struct robot *r, const struct rneagen_options *o,
	struct arena *a, struct rneagen_error *e);

/* Lines of --info, and a member of --info=json. */
void saving_put_table(const struct tree *t, struct text *out);
void saving_put_json(const struct tree *t, struct text *out);

#endif
