#ifndef RNEAGEN_BASE_LIMBS_H
#define RNEAGEN_BASE_LIMBS_H
/* Torques with their vjp, in soa, of a robot whose base moves freely, by two kernels, each for one half of the limbs (hands.h). */

#include "plan/grid/parts.h"

struct finder;
struct hand;

/* May they be? Rows in which nothing can be handed on; one of the halves; rows for what it hands on, 0: there are too few. */
int base_limbs_may(const struct parts_of *x);
void base_limbs_bar(struct finder *f);
int base_limbs_find(struct finder *f, unsigned char *own);
int base_limbs_rows(struct finder *f, struct hand *m, const unsigned char *own);

/* Are these parts of such kernels? */
int base_limbs_are(const struct part *parts, int count, const struct tree *t);

#endif
