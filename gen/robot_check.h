#ifndef RNEAGEN_ROBOT_CHECK_H
#define RNEAGEN_ROBOT_CHECK_H
/* Whether the numbers of a robot make sense: what cannot be used is an error, what is odd a warning. */

#include "precheck.h"

/* Errors: MEMORY, NUMBER (negative mass, zero axis), MIMIC. A mimic on a fixed joint is dropped with a warning. */
enum rneagen_code robot_check(
	struct robot *r, const struct outline *o, const char *file, struct arena *a, struct rneagen_error *e);

#endif
