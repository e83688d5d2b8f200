#ifndef RNEAGEN_TANGENT_H
#define RNEAGEN_TANGENT_H
/* The tangent space of q, in which positions vary. A floating joint's is that of a twist in the body's frame, linear then
   angular, as with Pinocchio: its position moves by Q v, its quaternion as q (x) (w/2, 0). Of other joints it is q's own. */

#include "mechanics/joint.h"

/* All rows of q, t->nq of them, for t->nv rows `v`. */
void tangent_all(struct dag *d, const struct tree *t, struct joint_inputs in, const struct ref *v, struct ref *rates);

/* The transposed map: from derivatives by q's rows, t->nq of them, that by row `row` of the tangent. */
struct ref tangent_transposed(struct dag *d, const struct tree *t, struct joint_inputs in, const struct ref *by_q, int row);

#endif
