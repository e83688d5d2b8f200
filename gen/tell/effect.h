#ifndef RNEAGEN_EFFECT_H
#define RNEAGEN_EFFECT_H
/* What changed constants save and what they change, against the same scene without that change: operations by count,
   torques by sampling. */

#include "draw/draw.h"
#include "passes/analysis.h"

struct effect {
	enum scene_key key;
	double argument; /* the option's */
	int is_asked;    /* 0: what the option would do */
	long saved;      /* flops of rnea; negative: it costs so many more */
	double change;   /* largest change of an output, as N m or N, */
	int is_proved;   /* of drop-below: */
	struct proven most; /* what no state within the ranges exceeds */
	double share;    /* and of |tau| over the largest |tau|, in the samples of DRAW_EFFECTS; NAN where one overflows */
};

struct effects {
	struct effect of[4];
	int count;
};

/* Of each of snap-angle, round-constants and drop-below that the analysis was made with; of snap-angle ADJUST_NEARLY where it was
   not and there is an angle for it. Errors: MEMORY. */
enum rneagen_code effect_measure(struct effects *x, const struct analysis *a);

/* What all that the analysis was made with of these three change together: the largest ||y - z|| / ||z|| of an output array, y
   with and z without, over drawn inputs, those of a batch drawn for each sample, too; NAN where there is none of the three,
   or nothing but 0 to compare with. Errors: MEMORY. */
enum rneagen_code effect_total(double *change, const struct analysis *a, const struct draw_options *drawing,
	struct rneagen_error *e);

/* Lines of --info, a member of --info=json, and lines of a text's head (what is asked for alone), with the ranges of the
   inputs of its DAG. */
void effect_put_table(const struct effects *x, const struct analysis *a, struct text *out);
void effect_put_json(const struct effects *x, const struct analysis *a, struct text *out);
void effect_put_comment(const struct effects *x, const struct analysis *a, struct text *out);

#endif
