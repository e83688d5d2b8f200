#ifndef RNEAGEN_ASSEMBLE_H
#define RNEAGEN_ASSEMBLE_H
/* From names to one tree: links and joints in byte order of their names, every reference resolved. */

#include "urdf/precheck.h"

/* Fills the names, indices, types and angles of the robot and sorts `o` alike: o->joints[i] is robot->joints[i].
   Errors: MEMORY, URDF (a name is used twice), TREE, MIMIC (the driver is not there). */
enum rneagen_code assemble_robot(struct outline *o, const struct diagnostic *p);

#endif
