#ifndef TESTS_PAIRS_H
#define TESTS_PAIRS_H
/* Sets of options so few that each two values of any two options still meet in one of them. */

#include <stdint.h>

enum { PAIRS_FACTORS = 6, PAIRS_ROWS = 128 };

/* Levels of up to PAIRS_FACTORS options; a row holds a level of each. */
struct pairs {
	int factors, levels[PAIRS_FACTORS];
	int count, rows[PAIRS_ROWS][PAIRS_FACTORS];
};

/* The rows for the levels, drawn by the seed; every pair of levels of two options is in at least one, or the test fails. */
void pairs_draw(struct pairs *p, uint64_t seed);

#endif
