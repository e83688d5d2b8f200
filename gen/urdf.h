#ifndef RNEAGEN_URDF_H
#define RNEAGEN_URDF_H
/* The door to urdfdom, which is C++. */

#include "report.h"

/* Parse `xml` with urdfdom and fill the numbers of the robot's links and joints, which are found by their names.
   Nothing is printed and no exception comes out. Errors: URDF, with urdfdom's own words; MEMORY. */
enum rneagen_code urdf_read(const char *xml, const struct report *p);

#endif
