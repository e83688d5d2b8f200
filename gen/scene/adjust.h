#ifndef RNEAGEN_ADJUST_H
#define RNEAGEN_ADJUST_H
/* Constants that are changed because the scene says so: angles that are nearly right, digits that are not wanted. */

#include "scene/scene.h"

/* 0: not asked for. */
struct adjust {
	double snap; /* rad */
	int digits;
	double prune; /* terms that no output feels by this fraction: */
	int has_angles; /* ranges keep every angle within what bounded sines take, so the text has these: by request_resolve */
	int is_sampled; /* of each in drawn samples; else of all together in every state within the ranges */
};

/* What is listed as nearly right. */
#define ADJUST_NEARLY 1e-4

/* Errors: SCENE, MEMORY. */
enum rneagen_code adjust_read(struct adjust *x, const struct scene *s, struct arena *a, struct rneagen_error *e);

/* Is any constant changed, or term left out? */
int adjust_is_asked(const struct adjust *x);

/* How far an angle is from the nearest multiple of pi/2, 0 where it counts as one in any case: the largest of the three that is
   at most `tolerance`; 0 if there is none. */
double adjust_off_rpy(const struct within rpy[3], double tolerance);

/* A copy of the robot whose angles within the tolerance of a multiple of pi/2 are that multiple; a->failed is set where
   memory runs out. */
struct robot adjust_snap(const struct robot *r, double tolerance, struct arena *a);

/* Does a text depend on this line of the scene? On a range only where constants are changed, or sines chosen by it. */
int adjust_matters(const struct adjust *x, const struct scene *s, int line);

#endif
