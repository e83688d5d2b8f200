#ifndef RNEAGEN_URDF_SHIM_H
#define RNEAGEN_URDF_SHIM_H
/* The door to urdfdom, which is C++. */

#include "urdf/precheck.h"

/* Parse the clean copy with urdfdom and fill the numbers of the robot's links and joints, which are found by their names.
   Nothing is printed and no exception comes out. Errors: URDF, with urdfdom's own words and the line of what they name;
   MEMORY. */
enum rneagen_code urdf_read(const struct outline *o, const struct diagnostic *p);

#endif
