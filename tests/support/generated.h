#ifndef TESTS_GENERATED_H
#define TESTS_GENERATED_H
/* A text of a robot that can be generated. */

#include "rneagen.h"
#include <check.h>
#include <string.h>

/* The test fails where it is refused. rneagen_result_free afterwards. */
static inline struct rneagen_result generated(const char *urdf, const struct rneagen_options *o)
{
	struct rneagen_result r;
	struct rneagen_error e;

	ck_assert_msg(!rneagen_generate(urdf, strlen(urdf), o, &r, &e), "%s", e.message);
	return r;
}

#endif
