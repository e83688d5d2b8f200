#ifndef TESTS_EXHAUSTIVE_H
#define TESTS_EXHAUSTIVE_H
/* tests/run --all sets RNEAGEN_ALL=1: a test that has a long form runs that. */

#include <stdlib.h>
#include <string.h>

static inline int exhaustive(void)
{
	const char *all = getenv("RNEAGEN_ALL");

	return all && *all && *all != '0';
}

/* Has a robot of ours joints that hardly another one has? A short form that leaves robots out keeps these. */
static inline int has_rare_joints(const char *name)
{
	return strstr(name, "mimic") || strstr(name, "floating_joint") || strstr(name, "planar_joint");
}

/* Under the sanitizers, which slow a test ten times and see in few states what they see in many. */
static inline int sanitized(void)
{
#if defined __SANITIZE_ADDRESS__ || defined __SANITIZE_THREAD__
	return 1;
#elif defined __has_feature
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer)
	return 1;
#endif
#endif
	return 0;
}

#endif
