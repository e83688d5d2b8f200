#ifndef TESTS_JUDGED_H
#define TESTS_JUDGED_H
/* What rnearun report and choose judge by, with the plain robot's reference beside it. */

#include "study/judge.h"
#include "support/model.h"

struct judged {
	struct model model; /* without the scene */
	struct analysis analysis;
	struct judge judge;
};

/* The robot of this file; a scene may be NULL. The test fails where that cannot be. */
void judged_open(struct judged *x, const char *path, enum rneagen_base base, const char *scene, enum rneagen_precision precision,
	const struct draw_options *samples);
void judged_close(struct judged *x);

/* q, qd and qdd of all samples, [sample][row]. */
struct states {
	size_t nq, nv;
	const double *q, *qd, *qdd;
};
struct states states_of(const struct drawn *x);

#endif
