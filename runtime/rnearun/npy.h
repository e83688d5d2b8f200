#ifndef RUNTIME_NPY_H
#define RUNTIME_NPY_H
/* NumPy's .npy files, read and written a slice at a time, so that memory does not grow with the file.
   Format: NEP 1; numpy/lib/format.py. Versions 1.0, 2.0 and 3.0; float32 and float64 of either byte order. */

#include "rnea.h"
#include "rneagen.h"
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

enum {
	NPY_DIMENSIONS = 64,   /* the most axes, as in NumPy 2 */
	NPY_COLUMNS = 32768,   /* the most elements of the last axis */
	NPY_HEADER = 65536,    /* the longest header in bytes */
};

/* The last axis holds the columns of one sample; all axes before it together count the samples. */
struct npy_shape {
	size_t dimensions, size[NPY_DIMENSIONS];
};

struct npy {
	const char *path; /* what messages call it; the caller's */
	enum rnea_scalar scalar;
	struct npy_shape shape;
	uint64_t samples;
	size_t columns;
	int fortran;      /* 1: columns are contiguous; the file is then read at several places */
	int swapped;      /* 1: of the other byte order than this machine's */
	int fd;           /* private, as the rest; -1: closed */
	int regular;       /* 1: samples can be read in any order */
	uint64_t data, at; /* where elements begin in the file; the next sample */
	char *buffer;
};

/* Open the file at `path`, "-" for standard input, and read its header. A regular file must be exactly as long as its
   header says. On failure *n is closed. Errors: READ, MEMORY. */
enum rneagen_code npy_open(struct npy *n, const char *path, struct rneagen_error *e);

/* The open file once more, to be read by another thread; *n is to be closed as well. On failure it is. Errors: READ, MEMORY. */
enum rneagen_code npy_again(struct npy *n, const struct npy *from, struct rneagen_error *e);

/* Of a regular file: which sample is next. */
void npy_seek(struct npy *n, uint64_t sample);

/* A run of columns of every sample and where it goes: `to`[sample][columns]. */
struct npy_part {
	size_t first, columns;
	void *to;
};

/* Read the next `count` samples, at most as many as are left, as elements of `scalar`. After the last one of a pipe its
   end is looked for. Errors: READ. */
enum rneagen_code npy_read(struct npy *n, size_t count, enum rnea_scalar scalar, const struct npy_part *parts,
	size_t part_count, struct rneagen_error *e);

/* Safe on one that is closed. */
void npy_close(struct npy *n);

/* A header of version 1.0 for an array in C order and this machine's byte order; errors stay with the stream. Returns its
   bytes; NULL: they are counted alone. */
size_t npy_put_header(FILE *f, enum rnea_scalar scalar, const struct npy_shape *shape);

/* "(1000, 7)", as NumPy writes it. */
void npy_shape_text(const struct npy_shape *shape, char *text, size_t size);

/* Read a header's dictionary, `length` bytes at `text`, into `n`: scalar, swapped, fortran, shape, samples, columns. A
   shape is refused if its bytes cannot be counted in 63 bits. Error: READ. For tests; npy_open calls it. */
enum rneagen_code npy_parse(struct npy *n, const char *text, size_t length, struct rneagen_error *e);

#endif
