#ifndef RNEAGEN_WITHIN_H
#define RNEAGEN_WITHIN_H
/* The model's constants, each of them twice: as it follows from the doubles nearest to the file's decimals, which is what
   texts are made of, and from the decimals themselves, with how far that may be from exact arithmetic. Texts are made of
   doubles since these leave room in extended precision: most sums of them are exact, in any order, so that what is equal is
   found to be equal, and folds. */

typedef long double real;

/* x from doubles; near from decimals, at most e from the exact number. In a text of lanes numbers that differ from
   limb to limb know theirs, and no rule looks at their values: limb 1 and up; 0: of none, -1: made of several limbs' own. What
   they are made of gives them a kind, the same in each limb. */
struct within {
	real x, near, e;
	int limb;
	unsigned kind;
};

/* A kind's bit for its negation. */
#define WITHIN_NEGATED 0x80000000u

struct within within_exact(real x);
/* Of a decimal: x the nearest double, near the nearest number in extended precision. */
struct within within_decimal(real x, real near);
/* Of any decimal that is read as this double; a whole number is meant as it is. */
struct within within_double(double x);

/* What near is rounded by is found out and not estimated: what is exact stays so. */
struct within within_neg(struct within a);
struct within within_add(struct within a, struct within b);
struct within within_sub(struct within a, struct within b);
struct within within_mul(struct within a, struct within b);
/* No bound is known of a quotient whose divisor is within its error of zero. */
struct within within_div(struct within a, struct within b);
struct within within_sqrt(struct within a);
struct within within_sin(struct within a);
struct within within_cos(struct within a);

/* Sine and cosine; exact where the angle lies within 5e-15 rad of a multiple of pi/2 (iiwa14 writes 1.570796326794897
   for pi/2). Nothing else is snapped. */
void angle_sincos(struct within angle, struct within *s, struct within *c);

/* May both be the same number? */
int within_meets(struct within a, struct within b);

/* |x - exact| is at most this. */
double within_error(struct within a);

#endif
