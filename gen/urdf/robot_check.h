#ifndef RNEAGEN_ROBOT_CHECK_H
#define RNEAGEN_ROBOT_CHECK_H
/* Whether the numbers of a robot make sense: what cannot be used is an error, what is odd a warning. */

#include "urdf/precheck.h"

/* `o` lends the line numbers. Errors: MEMORY, NUMBER (negative mass, zero axis), MIMIC. A mimic on a fixed joint is
   dropped with a warning. */
enum rneagen_code robot_check(const struct outline *o, const struct diagnostic *p);

#endif
