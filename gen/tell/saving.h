#ifndef RNEAGEN_SAVING_H
#define RNEAGEN_SAVING_H
/* What each choice of a scene saves, or costs: the text with the scene beside the one without, and beside those where a
   single choice is left out. */

#include "passes/analysis.h"
#include "plan/plan.h"

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

struct savings {
	struct saving *of; /* the full model, the scene, and what is left of it without each of its lines */
	int count;         /* 0: there is no scene */
};

/* Of a scene that `now` is the plan of, in memory of a->arena. A range that inputs are drawn from chooses nothing.
   Errors: MEMORY. */
enum rneagen_code saving_measure(struct savings *x, const struct analysis *a, const struct plan *now);

/* Lines of --info, and a member of --info=json. */
void saving_put_table(const struct savings *x, const struct scene *s, struct text *out);
void saving_put_json(const struct savings *x, const struct scene *s, struct text *out);

#endif
