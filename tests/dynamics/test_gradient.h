#ifndef TESTS_TEST_GRADIENT_H
#define TESTS_TEST_GRADIENT_H
#include <check.h>

/* Derivatives that cannot be had are refused by name. */
TCase *gradient_refused(void);

#endif
