#ifndef RNEAGEN_URDF_H
#define RNEAGEN_URDF_H
/* The door to urdfdom, which is C++. */

#include "robot.h"

/* Parse `xml` with urdfdom and fill the numbers of the links and joints of `r`, which are found by their names.
   Nothing is printed and no exception comes out. Errors: URDF, with urdfdom's own words; MEMORY. */
enum rneagen_code urdf_read(struct robot *r, const char *xml, const char *file, struct rneagen_error *e);

#endif
