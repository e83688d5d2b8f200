#ifndef RNEAGEN_PATH_H
#define RNEAGEN_PATH_H
/* A body with those that it hangs on and those that hang on it: what its constants cost shows there, whatever the size of
   the tree. */

#include "tree/tree.h"

/* The path from the ground to a body, its children at the end; of a long path what is near the body, on a base that floats. Rows
   are those of the tree. Returns 0 when memory runs out. */
int path_make(struct tree *path, const struct tree *t, int body, struct arena *a);

#endif
