#ifndef RNEAGEN_INFO_H
#define RNEAGEN_INFO_H
/* What --info says of a robot and of what was generated for it. */

#include "emit/emit.h"
#include "urdf/robot.h"

/* A table that a person reads. */
void info_table(const struct emission *e, struct text *out);

/* One JSON object: name, nq, nv, joints, mimic, warnings, operations. */
void info_json(const struct emission *e, struct text *out);

#endif
