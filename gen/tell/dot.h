#ifndef RNEAGEN_DOT_H
#define RNEAGEN_DOT_H
/* What --dot prints: the tree that is computed, in the language of Graphviz. A node is a body (its link, its mass and
   that of all that is fixed to it), an edge the joint that carries it (type, rows in q, axis in the joint's frame); the
   base has a double outline, and a dashed edge goes from a mimic joint's body to its driver's. */

#include "base/text.h"
#include "tree/tree.h"

void dot_graph(const struct tree *t, struct text *out);

#endif
