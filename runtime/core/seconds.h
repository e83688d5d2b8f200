#ifndef RNEA_SECONDS_H
#define RNEA_SECONDS_H
/* The time that passes. Needs _POSIX_C_SOURCE before the first header. */

#include <time.h>

/* Seconds since some moment, whatever the clock on the wall does. */
static inline double seconds_now(void)
{
	struct timespec t;

	clock_gettime(CLOCK_MONOTONIC, &t);
	return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

#endif
