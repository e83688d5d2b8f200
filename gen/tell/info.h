#ifndef RNEAGEN_INFO_H
#define RNEAGEN_INFO_H
/* What --info says of a robot and of what was generated for it. */

#include "emit/emit.h"
#include "tell/effect.h"
#include "tell/saving.h"

/* All that there is to tell. */
struct info {
	const struct analysis *analysis;
	const struct emission *emission;
	struct effects effects;
	struct savings savings;
};

/* A table that a person reads. */
void info_table(const struct info *x, struct text *out);

/* One JSON object: name, nq, nv, joints, mimic, warnings, operations. */
void info_json(const struct info *x, struct text *out);

#endif
