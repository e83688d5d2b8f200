#ifndef RNEAGEN_IDENTIFIER_H
#define RNEAGEN_IDENTIFIER_H
/* Names that C and CUDA accept. */

#include "base/arena.h"

/* Is `s` an identifier, and no keyword of C, C++ or CUDA, and not reserved (no two underscores in front)? */
int identifier_is(const char *s);

/* The name with every byte that cannot stand in an identifier turned into '_', and "robot_" in front where that is not
   enough; "robot" for an empty one. NULL when memory runs out. */
const char *identifier_from(const char *s, struct arena *a);

#endif
