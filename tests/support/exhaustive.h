#ifndef TESTS_EXHAUSTIVE_H
#define TESTS_EXHAUSTIVE_H
/* tests/run --all sets RNEAGEN_ALL=1: a test that has a long form runs that. */

#include <stdlib.h>

static inline int exhaustive(void)
{
	const char *all = getenv("RNEAGEN_ALL");

	return all && *all && *all != '0';
}

#endif
