#define _POSIX_C_SOURCE 200809L
#include "states_file.h"
#include <check.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { HEADER = 128 };

double *file_numbers(const char *path, int f32, size_t *count)
{
	FILE *f = fopen(path, "rb");
	size_t size = f32 ? sizeof(float) : sizeof(double), length;
	double *x;
	char *bytes;

	ck_assert_msg(f != NULL, "%s: cannot be opened", path);
	fseek(f, 0, SEEK_END);
	length = (size_t)ftell(f);
	ck_assert_uint_ge(length, HEADER);
	*count = (length - HEADER) / size;
	x = malloc(*count * sizeof *x + 1);
	bytes = malloc(length);
	rewind(f);
	ck_assert_uint_eq(fread(bytes, 1, length, f), length);
	fclose(f);
	for (size_t i = 0; i < *count; i++) {
		float y;

		memcpy(f32 ? (void *)&y : &x[i], bytes + HEADER + i * size, size);
		if (f32)
			x[i] = (double)y;
	}
	free(bytes);
	return x;
}

static FILE *open_array(const char *path, size_t samples, size_t columns, int f32)
{
	FILE *f = fopen(path, "wb");
	char header[HEADER];
	int n;

	ck_assert_ptr_nonnull(f);
	memset(header, ' ', sizeof header);
	memcpy(header, "\x93NUMPY\x01\x00\x76\x00", 10);
	n = snprintf(header + 10, sizeof header - 10,
		"{'descr': '<f%d', 'fortran_order': False, 'shape': (%zu, %zu), }", f32 ? 4 : 8, samples, columns);
	header[10 + n] = ' ';
	header[HEADER - 1] = '\n';
	fwrite(header, 1, HEADER, f);
	return f;
}

void file_put_array(const char *path, const double *x, size_t samples, size_t columns, int f32)
{
	FILE *f = open_array(path, samples, columns, f32);

	for (size_t i = 0; i < samples * columns; i++) {
		float y = (float)x[i];

		fwrite(f32 ? (const void *)&y : &x[i], f32 ? sizeof y : sizeof *x, 1, f);
	}
	ck_assert_int_eq(fclose(f), 0);
}

double *states_join(const double *const parts[3], size_t samples, size_t nq, size_t nv)
{
	double *x = malloc(samples * (nq + 2 * nv) * sizeof *x), *at = x;

	for (size_t k = 0; k < samples; k++) {
		for (size_t i = 0; i < 3; i++) {
			size_t rows = i ? nv : nq;

			memcpy(at, parts[i] + k * rows, rows * sizeof *at);
			at += rows;
		}
	}
	return x;
}

void file_put_sparse(const char *path, size_t samples, size_t columns)
{
	FILE *f = open_array(path, samples, columns, 0);

	ck_assert_int_eq(fclose(f), 0);
	ck_assert_int_eq(truncate(path, (off_t)(HEADER + samples * columns * sizeof(double))), 0);
}
