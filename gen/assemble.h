#ifndef RNEAGEN_ASSEMBLE_H
#define RNEAGEN_ASSEMBLE_H
/* From names to one tree: links and joints in byte order of their names, every reference resolved. */

#include "precheck.h"

/* Fills the names, indices, types and angles of `r` and sorts `o` alike: o->joints[i] is r->joints[i].
   Errors: MEMORY, URDF (a name is used twice), TREE, MIMIC (the driver is not there). */
enum rneagen_code assemble_robot(
	struct robot *r, struct outline *o, const char *file, struct arena *a, struct rneagen_error *e);

#endif
