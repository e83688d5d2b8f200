#ifndef RNEAGEN_BASE_SIDES_H
#define RNEAGEN_BASE_SIDES_H
/* Torques with their vjp, in soa, of a robot whose base moves freely, by two kernels, each for the limbs of one side
   (hands.h). */

#include "plan/grid/parts.h"

struct finder;
struct hand;

/* May they be? Rows in which nothing can be handed on; between which nodes what is felt of a side goes; one of the sides;
   rows for what it hands on, 0: there are too few. */
int base_sides_may(const struct parts_of *x);
void base_sides_bar(struct finder *f);
void base_sides_mark(struct finder *f, const unsigned char *own);
int base_sides_find(struct finder *f, unsigned char *own);
int base_sides_rows(struct finder *f, struct hand *m, const unsigned char *own);

#endif
