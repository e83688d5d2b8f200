/* .npy files that are none: refused with a message, whatever is wrong with them; random damage to a good one. */
#include "test_npy.h"
#include "support/rng.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static void assert_refused(const char *part)
{
	struct rneagen_error e = {0};
	struct npy n;

	ck_assert_int_eq(npy_open(&n, path, &e), RNEAGEN_READ);
	ck_assert_msg(!strncmp(e.message, path, strlen(path)), "'%s' does not name the file", e.message);
	ck_assert_msg(strstr(e.message, part) != NULL, "'%s' does not contain '%s'", e.message, part);
	ck_assert_int_eq(n.fd, -1);
}

#define ENTRY(descr, order, shape) "{'descr': " descr ", 'fortran_order': " order ", 'shape': " shape ", }"

START_TEST(test_refused)
{
	static const struct {
		const char *dictionary, *part;
	} rows[] = {
		{ENTRY("'<i8'", "False", "(2, 3)"), "type '<i8'"},
		{ENTRY("'<f2'", "False", "(2, 3)"), "type '<f2'"},
		{ENTRY("'<c16'", "False", "(2, 3)"), "type '<c16'"},
		{ENTRY("'|O'", "False", "(2, 3)"), "type '|O'"},
		{ENTRY("'f8'", "False", "(2, 3)"), "type 'f8'"},
		{ENTRY("''", "False", "(2, 3)"), "type ''"},
		{ENTRY("'|f8'", "False", "(2, 3)"), "byte order"},
		{ENTRY("[('a', '<f8')]", "False", "(2, 3)"), "structured"},
		{ENTRY("8", "False", "(2, 3)"), "'descr'"},
		{ENTRY("'<f8'", "0", "(2, 3)"), "'fortran_order'"},
		{ENTRY("'<f8'", "False", "()"), "single number"},
		{ENTRY("'<f8'", "False", "(6)"), "'shape'"},
		{ENTRY("'<f8'", "False", "(2, -3)"), "'shape'"},
		{ENTRY("'<f8'", "False", "(2 3)"), "'shape'"},
		{ENTRY("'<f8'", "False", "(2, 3"), "'shape'"},
		{ENTRY("'<f8'", "False", "[2, 3]"), "'shape'"},
		{ENTRY("'<f8'", "False", "(2, 3.0)"), "'shape'"},
		{ENTRY("'<f8'", "False", "(6, 0)"), "without elements"},
		{ENTRY("'<f8'", "False", "(18446744073709551617, 3)"), "'shape'"},
		{ENTRY("'<f8'", "False", "(18446744073709551615, 3)"), "more elements"},
		{ENTRY("'<f8'", "False", "(4294967296, 4294967296, 3)"), "more elements"},
		{ENTRY("'<f8'", "False", "(35184372088832, 32768)"), "more elements"},
		{ENTRY("'<f8'", "False", "(1000000000, 3)"), "after 2 of 1000000000 samples"},
		{ENTRY("'<f8'", "False", "(3, 1000000)"), "columns"},
		{ENTRY("'<f8'", "False", "(3, 3)"), "after 2 of 3 samples"},
		{ENTRY("'<f8'", "False", "(1, 3)"), "24 bytes after the array"},
		{ENTRY("'<f8'", "False", "(0, 3)"), "48 bytes after the array"},
		{ENTRY("'<f8'", "True", "(1, 2, 3)"), "3 axes in Fortran order"},
		{ENTRY("'<f8'", "False", "(2, 3)") "x", "follows the dictionary"},
		{"{'descr': '<f8', 'shape': (2, 3)}", "'descr', 'fortran_order' and 'shape'"},
		{"{'descr': '<f8', 'shape': (2, 3), 'shape': (2, 3), 'fortran_order': False}", "once each"},
		{ENTRY("'<f8aaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaa'", "False",
			 "(2, 3)"),
			"no string"},
		{"{'descr': '<f8', 'fortran_order': False, 'shape': (2, 3), 'more': 1}", "once each"},
		{"{'descr': '<f8' 'fortran_order': False, 'shape': (2, 3)}", "does not end"},
		{"{", "no dictionary"},
		{"{}", "once each"},
		{"", "no dictionary"},
		{"{'descr", "no dictionary"},
	};

	for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
		put_array(1 + (int)i % 3, rows[i].dictionary, F8, sizeof F8);
		assert_refused(rows[i].part);
	}
}
END_TEST

START_TEST(test_not_npy)
{
	char bytes[128] = "\x93NUMPY\x02";
	struct rneagen_error e = {0};
	struct npy n;

	put_file("", 0);
	assert_refused("ends within");
	put_file("PK\x03\x04 a zip file", 15);
	assert_refused("not a .npy file");
	bytes[6] = 4;
	put_file(bytes, sizeof bytes);
	assert_refused("version 4.0");
	bytes[6] = 1;
	bytes[7] = 9;
	put_file(bytes, sizeof bytes);
	assert_refused("version 1.9");
	memcpy(bytes + 6, "\x02\x00\xff\xff\xff\xff", 6);
	put_file(bytes, sizeof bytes);
	assert_refused("header of 4294967295 bytes");
	memcpy(bytes + 6, "\x02\x00\xff\x00\x00\x00", 6);
	put_file(bytes, sizeof bytes);
	assert_refused("ends within the header");
	ck_assert_int_eq(npy_open(&n, "no/such.npy", &e), RNEAGEN_READ);
	ck_assert_str_eq(e.message, "no/such.npy: cannot be opened: No such file or directory");
	e.code = RNEAGEN_OK;
	ck_assert_int_eq(npy_open(&n, ".", &e), RNEAGEN_READ);
	ck_assert_str_eq(e.message, ".: cannot be read: Is a directory");
}
END_TEST

/* Read whatever can be read of a file, and see that what can is of its size. */
static int read_damaged(size_t length)
{
	struct rneagen_error e = {0};
	struct npy n;
	int good = !npy_open(&n, path, &e);

	if (good) {
		size_t size = n.scalar == RNEA_F32 ? 4 : 8, count = (size_t)n.samples;
		double *to = malloc(count * n.columns * sizeof *to + 1);
		struct npy_part p = {0, n.columns, to};

		ck_assert_uint_eq(n.data + count * n.columns * size, length);
		ck_assert_int_eq(npy_read(&n, count, RNEA_F64, &p, 1, &e), RNEAGEN_OK);
		free(to);
		npy_close(&n);
	} else {
		ck_assert(*e.message && !strchr(e.message, '\n'));
	}
	return good;
}

START_TEST(test_damage)
{
	char good[256], bytes[256];
	const char *seed = getenv("TEST_SEED");
	uint64_t number = seed ? strtoull(seed, NULL, 0) : 20261121;
	struct rng r = rng_seed(number);
	size_t length = put_header(good, 1, ENTRY("'<f8'", "False", "(2, 3)") "  \n");
	int read = 0;

	printf("test_npy: seed %llu\n", (unsigned long long)number);
	memcpy(good + length, F8, sizeof F8);
	length += sizeof F8;
	for (int i = 0; i < 4000; i++) {
		static const char pieces[] = "0123456789(),'\"{}<>fL TrueFalse\n";
		size_t n = length;

		memcpy(bytes, good, length);
		for (int k = rng_below(&r, 4); k >= 0; k--) {
			size_t at = (size_t)rng_below(&r, (int)n);

			if (rng_chance(&r, 0.7))
				bytes[at] = pieces[rng_below(&r, (int)sizeof pieces - 1)];
			else if (rng_chance(&r, 0.7))
				bytes[at] = (char)rng_below(&r, 256);
			else
				n = at + 1;
		}
		put_file(bytes, n);
		read += read_damaged(n);
	}
	ck_assert_int_gt(read, 20);
	ck_assert_int_lt(read, 3000);
}
END_TEST

TCase *case_bad(void)
{
	TCase *c = tcase_create("bad");

	tcase_set_timeout(c, 120);
	tcase_add_test(c, test_refused);
	tcase_add_test(c, test_not_npy);
	tcase_add_test(c, test_damage);
	return c;
}
