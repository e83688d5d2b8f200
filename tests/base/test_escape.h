#ifndef TESTS_TEST_ESCAPE_H
#define TESTS_TEST_ESCAPE_H
#include <check.h>

/* Names in comments and in JSON: no byte of them ends what they stand in. */
TCase *escape_case(void);

#endif
