#ifndef RNEAGEN_INERTIA_PUT_H
#define RNEAGEN_INERTIA_PUT_H
/* The inertial parameters that a regressor is by, as the URDF has them. */

#include "passes/analysis.h"

/* A member of the object of --info=json; nothing where no regressor is wanted. */
void inertia_put_json(const struct analysis *a, struct text *out);

#endif
