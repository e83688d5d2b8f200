#ifndef TEST_NPY_H
#define TEST_NPY_H
/* What the parts of test_npy share. */

#include "rnearun/npy.h"
#include <check.h>

/* The file of every test. */
extern char path[11];

/* 1, 2, 3, 0.5, 0.25, -2 in double precision, high byte first. */
extern const unsigned char F8[48];

/* Write the file: these bytes. */
void put_file(const void *bytes, size_t length);

/* Magic, version, length and the dictionary; returns the bytes. */
size_t put_header(char *to, int version, const char *dictionary);

/* Write the file: this dictionary and `length` bytes of data. */
void put_array(int version, const char *dictionary, const void *data, size_t length);

/* Hostile files, and random damage to a good one. */
TCase *case_bad(void);

#endif
