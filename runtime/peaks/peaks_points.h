#ifndef RUNTIME_PEAKS_POINTS_H
#define RUNTIME_PEAKS_POINTS_H
/* The members of a group at points of q, for all drives and rates at once. */

#include "peaks/peaks.h"

struct peaks_points;

/* A place of a row of q: a length or angle, its sine, its cosine. */
typedef double peaks_place[3];

/* NULL when memory runs out; *is_large: one point has too many lanes. peaks_points_free in either case. */
struct peaks_points *peaks_points_new(const struct peaks *p, const struct peaks_group *g, int *is_large);
void peaks_points_free(struct peaks_points *t);

/* The largest lengths at all points of a grid, by member, into found[]: counts[k] places of the group's row number k.
   Returns 0 when the deadline was met before. */
int peaks_points_take(
	struct peaks_points *t, const int *counts, peaks_place *const *places, double *found, double deadline);

/* No length in found[] is further off, by member. */
double peaks_points_off(const struct peaks_points *t, size_t member);

#endif
