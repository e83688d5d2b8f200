#ifndef RUNTIME_CHOICE_H
#define RUNTIME_CHOICE_H
/* Which variant is taken: the fastest that is close enough. */

#include "study/study.h"

enum verdict { VERDICT_CLOSE, VERDICT_NO_BOUND, VERDICT_OVER_BOUND, VERDICT_NO_ERROR, VERDICT_OVER_ERROR, VERDICT_NO_PROOF,
	VERDICT_OVER_PROOF };

struct candidate {
	struct study_row row;
	enum verdict verdict;
	double slowest;           /* ns: of the medians of several times */
	struct rnea_robot *robot; /* NULL: nothing was measured, or it is not close enough */
};

/* Times that are less apart are the same, whatever their spread. */
#define CHOICE_ALIKE 1.02

/* By row->bound_max; by row->proved; by row->errors. NAN: none is known. */
enum verdict choice_by_bound(const struct study_row *row, double limit);
enum verdict choice_by_proof(const struct study_row *row, double limit);
enum verdict choice_by_error(const struct study_row *row, double limit);

/* Of those that are close enough, by row.least; NULL: none is. */
const struct candidate *choice_fastest(const struct candidate *c, int count);

/* Does it differ from the fastest in its trigonometry alone, and is its least time within the spread of that one's? So is the
   fastest itself. */
int choice_is_tied(const struct candidate *c, const struct candidate *fastest);

/* Of those that are tied the first trigonometry: accurate, bounded, fast. NULL: none is close enough. */
const struct candidate *choice_best(const struct candidate *c, int count);

#endif
