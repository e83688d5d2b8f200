/* .npy files: bytes written by hand from the format's description; test_npy_bad.c has hostile ones. */
#define _POSIX_C_SOURCE 200809L
#include "test_npy.h"
#include "support/rng.h"
#include "support/suite.h"
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

char path[] = "npy.XXXXXX";

void put_file(const void *bytes, size_t length)
{
	FILE *f = fopen(path, "wb");

	ck_assert_ptr_nonnull(f);
	ck_assert_uint_eq(fwrite(bytes, 1, length, f), length);
	ck_assert_int_eq(fclose(f), 0);
}

size_t put_header(char *to, int version, const char *dictionary)
{
	size_t n = strlen(dictionary), wide = version == 1 ? 2 : 4;

	memcpy(to, "\x93NUMPY", 6);
	to[6] = (char)version;
	to[7] = 0;
	for (size_t i = 0; i < wide; i++)
		to[8 + i] = (char)(n >> (8 * i) & 255);
	memcpy(to + 8 + wide, dictionary, n);
	return 8 + wide + n;
}

void put_array(int version, const char *dictionary, const void *data, size_t length)
{
	char bytes[8192];
	size_t n = put_header(bytes, version, dictionary);

	if (length)
		memcpy(bytes + n, data, length);
	put_file(bytes, n + length);
}

static void assert_open(struct npy *n)
{
	struct rneagen_error e = {0};

	npy_open(n, path, &e);
	ck_assert_msg(!e.code, "%s", e.message);
}

/* 1, 2, 3 and 0.5, 0.25, -2 as IEEE 754 has them, high byte first. */
const unsigned char F8[48] = {0x3f, 0xf0, 0, 0, 0, 0, 0, 0, 0x40, 0, 0, 0, 0, 0, 0, 0, 0x40, 8, 0, 0, 0, 0, 0, 0,
	0x3f, 0xe0, 0, 0, 0, 0, 0, 0, 0x3f, 0xd0, 0, 0, 0, 0, 0, 0, 0xc0, 0, 0, 0, 0, 0, 0, 0};
static const unsigned char F4[] = {
	0x3f, 0x80, 0, 0, 0x40, 0, 0, 0, 0x40, 0x40, 0, 0, 0x3f, 0, 0, 0, 0x3e, 0x80, 0, 0, 0xc0, 0, 0, 0};
static const double VALUES[] = {1, 2, 3, 0.5, 0.25, -2};

/* Every version, type, byte order and axis order; read as either type, in slices of one and of all, in two parts. */
static void check_six(int version, int size, int big, int fortran, int once)
{
	char dictionary[128];
	unsigned char data[48];
	struct rneagen_error e = {0};
	struct npy n;
	float left[2];
	double right[4];

	snprintf(dictionary, sizeof dictionary, "{'descr': '%cf%d', 'fortran_order': %s, 'shape': (2, 3), }     \n",
		big ? '>' : '<', size, fortran ? "True" : "False");
	for (int i = 0; i < 6; i++)
		for (int b = 0; b < size; b++)
			data[(fortran ? i % 3 * 2 + i / 3 : i) * size + b] =
				(size == 8 ? F8 : F4)[i * size + (big ? b : size - 1 - b)];
	put_array(version, dictionary, data, (size_t)(6 * size));
	for (int f32 = 0; f32 < 2; f32++) {
		assert_open(&n);
		ck_assert_uint_eq(n.samples, 2);
		ck_assert_uint_eq(n.columns, 3);
		for (size_t k = 0; k < 2; k += once ? 2 : 1) {
			struct npy_part parts[] = {{1, 2, right + 2 * k}, {0, 1, left + k}};

			npy_read(&n, once ? 2 : 1, f32 ? RNEA_F32 : RNEA_F64, parts + f32, 1, &e);
			ck_assert_msg(!e.code, "%s", e.message);
		}
		npy_close(&n);
	}
	for (int k = 0; k < 2; k++) {
		ck_assert_double_eq((double)left[k], VALUES[3 * k]);
		ck_assert_double_eq(right[2 * k], VALUES[3 * k + 1]);
		ck_assert_double_eq(right[2 * k + 1], VALUES[3 * k + 2]);
	}
}

START_TEST(test_kinds)
{
	int i = _i;

	check_six(1 + i % 3, i / 3 % 2 ? 8 : 4, i / 6 % 2, i / 12 % 2, i / 24);
}
END_TEST

START_TEST(test_shapes)
{
	static const struct {
		const char *shape;
		size_t dimensions, samples, columns;
	} rows[] = {
		{"(6,)", 1, 1, 6},
		{"(2,3)", 2, 2, 3},
		{"( 1, 2 , 3 ,)", 3, 2, 3},
		{"(6, 1)", 2, 6, 1},
		{"(3L, 2L)", 2, 3, 2},
		{"(1, 1, 1, 1, 1, 6)", 6, 1, 6},
		{"(002, 3)", 2, 2, 3},
	};

	for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
		char dictionary[256];
		struct npy n;

		/* entries in any order, either quote */
		snprintf(dictionary, sizeof dictionary, "{\"shape\": %s, 'fortran_order': False, \"descr\": '<f8'}",
			rows[i].shape);
		put_array(1, dictionary, F8, sizeof F8);
		assert_open(&n);
		ck_assert_uint_eq(n.shape.dimensions, rows[i].dimensions);
		ck_assert_uint_eq(n.samples, rows[i].samples);
		ck_assert_uint_eq(n.columns, rows[i].columns);
		npy_close(&n);
	}
	put_array(2, "{'descr': '<f4', 'fortran_order': False, 'shape': (0, 5), }\n", NULL, 0);
	struct npy n;
	assert_open(&n);
	ck_assert_uint_eq(n.samples, 0);
	npy_close(&n);
}
END_TEST

/* The bytes that NumPy writes for the same array. */
START_TEST(test_header)
{
	struct npy_shape shape = {2, {1000, 7}};
	char bytes[512], dictionary[] = "{'descr': '<f8', 'fortran_order': False, 'shape': (1000, 7), }", text[64];
	FILE *f = fmemopen(bytes, sizeof bytes, "wb");
	const unsigned char start[] = {0x93, 'N', 'U', 'M', 'P', 'Y', 1, 0, 0x76, 0};

	npy_put_header(f, RNEA_F64, &shape);
	ck_assert_int_eq((int)ftell(f), 128);
	fclose(f);
	ck_assert_mem_eq(bytes, start, sizeof start);
	ck_assert_mem_eq(bytes + 10, dictionary, sizeof dictionary - 1);
	for (size_t i = 10 + sizeof dictionary - 1; i < 127; i++)
		ck_assert_int_eq(bytes[i], ' ');
	ck_assert_int_eq(bytes[127], '\n');
	shape.dimensions = 1;
	npy_shape_text(&shape, text, sizeof text);
	ck_assert_str_eq(text, "(1000,)");
	npy_shape_text(&shape, text, 4);
	ck_assert_uint_lt(strlen(text), 4);
}
END_TEST

/* What is written can be read again, whatever the shape. */
START_TEST(test_again)
{
	struct rng r = rng_seed(1);

	for (int i = 0; i < 200; i++) {
		struct npy_shape shape = {(size_t)(1 + rng_below(&r, NPY_DIMENSIONS)), {0}};
		FILE *f = fopen(path, "wb");
		struct npy n;

		for (size_t k = 0; k < shape.dimensions; k++)
			shape.size[k] = (size_t)(rng_chance(&r, 0.1) ? 1 + rng_below(&r, 2) : 1);
		shape.size[0] = 0; /* no data to write */
		shape.size[shape.dimensions - 1] += shape.dimensions == 1;
		npy_put_header(f, i % 2 ? RNEA_F32 : RNEA_F64, &shape);
		for (size_t k = 0; shape.dimensions == 1 && k < (size_t)(i % 2 ? 4 : 8); k++)
			putc(0, f);
		ck_assert_int_eq(fclose(f), 0);
		assert_open(&n);
		ck_assert_int_eq(n.scalar, i % 2 ? RNEA_F32 : RNEA_F64);
		ck_assert_uint_eq(n.shape.dimensions, shape.dimensions);
		ck_assert_mem_eq(n.shape.size, shape.size, shape.dimensions * sizeof *shape.size);
		npy_close(&n);
	}
}
END_TEST

/* A file longer than the buffer, in both orders: element (k, c) is 1000 k + c. */
START_TEST(test_long)
{
	enum { ROWS = 9001, COLUMNS = 17 };
	struct rneagen_error e = {0};
	double *part = malloc(ROWS * 3 * sizeof *part);
	struct npy n;

	for (int fortran = 0; fortran < 2; fortran++) {
		char bytes[256];
		size_t length;
		FILE *f = fopen(path, "wb");

		snprintf(bytes + 128, 128, "{'descr': '<f8', 'fortran_order': %s, 'shape': (%d, %d)}",
			fortran ? "True" : "False", ROWS, COLUMNS);
		length = put_header(bytes, 1, bytes + 128);
		fwrite(bytes, 1, length, f);
		for (size_t i = 0; i < ROWS * COLUMNS; i++) {
			double x = fortran ? 1000.0 * (double)(i % ROWS) + (double)(i / ROWS)
					   : 1000.0 * (double)(i / COLUMNS) + (double)(i % COLUMNS);

			fwrite(&x, sizeof x, 1, f);
		}
		fclose(f);
		assert_open(&n);
		for (size_t at = 0, now; at < ROWS; at += now) {
			struct npy_part p = {11, 3, part + 3 * at};

			now = ROWS - at < 4096 ? ROWS - at : 4096;
			ck_assert_int_eq(npy_read(&n, now, RNEA_F64, &p, 1, &e), RNEAGEN_OK);
		}
		npy_close(&n);
		for (size_t k = 0; k < ROWS; k++)
			for (size_t c = 0; c < 3; c++)
				ck_assert_double_eq(part[3 * k + c], 1000.0 * (double)k + (double)(11 + c));
		memset(part, 0, ROWS * 3 * sizeof *part);
	}
	free(part);
}
END_TEST

int main(void)
{
	Suite *s = suite_create("npy");
	TCase *c = tcase_create("npy");
	int failed, fd = mkstemp(path);

	if (fd < 0)
		return 1;
	close(fd);
	tcase_set_timeout(c, 120);
	tcase_add_loop_test(c, test_kinds, 0, 48);
	tcase_add_test(c, test_shapes);
	tcase_add_test(c, test_header);
	tcase_add_test(c, test_again);
	tcase_add_test(c, test_long);
	suite_add_tcase(s, c);
	suite_add_tcase(s, case_bad());
	failed = suite_run(s);
	unlink(path);
	return failed != 0;
}
