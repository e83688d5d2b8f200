#define _POSIX_C_SOURCE 200809L
#include "rnearun/npy.h"
#include <errno.h>
#include <fcntl.h>
#include <inttypes.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

enum { BUFFER = 8 * NPY_COLUMNS }; /* bytes: at least one sample */

static size_t scalar_size(enum rnea_scalar s)
{
	return s == RNEA_F32 ? sizeof(float) : sizeof(double);
}

static enum rneagen_code fail_read(const struct npy *n, struct rneagen_error *e)
{
	return error_set(e, RNEAGEN_READ, "%s: cannot be read: %s", n->path, strerror(errno));
}

/* Read on until `size` bytes are there or the file ends; how many they are, or -1. From byte `place`; -1: where it stands. */
static ssize_t read_all(int fd, char *to, size_t size, off_t place)
{
	size_t have = 0;

	while (have < size) {
		ssize_t got = place < 0 ? read(fd, to + have, size - have)
			: pread(fd, to + have, size - have, place + (off_t)have);

		if (got < 0 && errno == EINTR)
			continue;
		if (got < 0)
			return -1;
		if (got == 0)
			break;
		have += (size_t)got;
	}
	return (ssize_t)have;
}

/* Exactly `size` bytes; `place` as read_all has it. */
static enum rneagen_code read_exact(
	struct npy *n, void *to, size_t size, off_t place, const char *what, struct rneagen_error *e)
{
	ssize_t got = read_all(n->fd, to, size, place);

	if (got < 0)
		return fail_read(n, e);
	if ((size_t)got < size)
		return error_set(e, RNEAGEN_READ, "%s: ends within %s; was it written to its end?", n->path, what);
	return RNEAGEN_OK;
}

/* Magic, version, and the length of the dictionary: 2 bytes in version 1, 4 since, low byte first. */
static enum rneagen_code read_preamble(struct npy *n, size_t *length, struct rneagen_error *e)
{
	unsigned char b[12] = {0};
	size_t wide;

	if (read_exact(n, b, 8, -1, "the first 8 bytes", e))
		return e->code;
	if (memcmp(b, "\x93NUMPY", 6) != 0)
		return error_set(e, RNEAGEN_READ, "%s: not a .npy file; numpy.save writes them", n->path);
	if (b[6] < 1 || b[6] > 3 || b[7] != 0)
		return error_set(
			e, RNEAGEN_READ, "%s: .npy version %d.%d; 1.0, 2.0 and 3.0 can be read", n->path, b[6], b[7]);
	wide = b[6] == 1 ? 2 : 4;
	if (read_exact(n, b + 8, wide, -1, "the header", e))
		return e->code;
	*length = (size_t)b[8] | (size_t)b[9] << 8 | (size_t)b[10] << 16 | (size_t)b[11] << 24;
	n->data = 8 + wide + *length;
	if (*length > NPY_HEADER)
		return error_set(
			e, RNEAGEN_READ, "%s: a header of %zu bytes; the limit is %d", n->path, *length, NPY_HEADER);
	return RNEAGEN_OK;
}

static enum rneagen_code read_header(struct npy *n, struct rneagen_error *e)
{
	off_t start = lseek(n->fd, 0, SEEK_CUR);
	size_t length = 0;

	if (read_preamble(n, &length, e) || read_exact(n, n->buffer, length, -1, "the header", e))
		return e->code;
	n->data += start > 0 ? (uint64_t)start : 0;
	return npy_parse(n, n->buffer, length, e);
}

/* The file against its header. */
static enum rneagen_code check_length(struct npy *n, struct rneagen_error *e)
{
	uint64_t sample = n->columns * scalar_size(n->scalar), want = n->samples * sample, have;
	struct stat st;
	char shape[64];

	if (fstat(n->fd, &st))
		return fail_read(n, e);
	n->regular = S_ISREG(st.st_mode);
	if (!n->regular)
		return RNEAGEN_OK;
	npy_shape_text(&n->shape, shape, sizeof shape);
	have = (uint64_t)st.st_size > n->data ? (uint64_t)st.st_size - n->data : 0;
	if (have < want)
		return error_set(e, RNEAGEN_READ,
			"%s: shape %s, but the file ends after %" PRIu64 " of %" PRIu64 " samples", n->path, shape,
			have / sample, n->samples);
	if (have > want)
		return error_set(e, RNEAGEN_READ,
			"%s: %" PRIu64 " bytes after the array of shape %s; save one array alone", n->path, have - want,
			shape);
	return RNEAGEN_OK;
}

enum rneagen_code npy_open(struct npy *n, const char *path, struct rneagen_error *e)
{
	int is_stdin = !strcmp(path, "-");

	*n = (struct npy){.path = is_stdin ? "<stdin>" : path};
	n->fd = is_stdin ? STDIN_FILENO : open(path, O_RDONLY | O_CLOEXEC);
	if (n->fd < 0)
		return error_set(e, RNEAGEN_READ, "%s: cannot be opened: %s", path, strerror(errno));
	n->buffer = malloc(BUFFER);
	if (!n->buffer)
		error_memory(e);
	else if (!read_header(n, e) && !check_length(n, e) && n->fortran && n->samples > 1 && !n->regular)
		error_set(e, RNEAGEN_READ, "%s: an array in Fortran order can be read from a file, not from a pipe",
			n->path);
	if (e->code)
		npy_close(n);
	return e->code;
}

enum rneagen_code npy_again(struct npy *n, const struct npy *from, struct rneagen_error *e)
{
	*n = *from;
	n->fd = fcntl(from->fd, F_DUPFD_CLOEXEC, STDERR_FILENO + 1);
	n->buffer = malloc(BUFFER);
	if (n->fd < 0)
		fail_read(n, e);
	else if (!n->buffer)
		error_memory(e);
	if (e->code)
		npy_close(n);
	return e->code;
}

void npy_seek(struct npy *n, uint64_t sample)
{
	n->at = sample;
}

void npy_close(struct npy *n)
{
	if (n->fd > STDIN_FILENO)
		close(n->fd);
	n->fd = -1;
	free(n->buffer);
	n->buffer = NULL;
}

/* The other byte order, in place. */
static void swap_bytes(char *bytes, size_t count, size_t size)
{
	for (char *b = bytes; b < bytes + count * size; b += size) {
		for (size_t i = 0; i < size / 2; i++) {
			char c = b[i];

			b[i] = b[size - 1 - i];
			b[size - 1 - i] = c;
		}
	}
}

/* Elements from `from` on, one after another, to `to`, `stride` elements apart. */
static void convert(
	void *to, enum rnea_scalar to_scalar, size_t stride, const char *from, enum rnea_scalar scalar, size_t count)
{
	float *f = to;
	double *d = to;

	if (scalar == to_scalar && stride == 1) {
		memcpy(to, from, count * scalar_size(scalar));
		return;
	}
	for (size_t i = 0; i < count; i++) {
		double x;
		float y;

		if (scalar == RNEA_F32) {
			memcpy(&y, from + i * sizeof y, sizeof y);
			x = (double)y;
		} else {
			memcpy(&x, from + i * sizeof x, sizeof x);
		}
		if (to_scalar == RNEA_F32)
			f[i * stride] = (float)x;
		else
			d[i * stride] = x;
	}
}

static char *element(void *array, enum rnea_scalar scalar, size_t index)
{
	return (char *)array + index * scalar_size(scalar);
}

/* Whole samples through the buffer. */
static enum rneagen_code read_rows(struct npy *n, size_t count, enum rnea_scalar scalar, const struct npy_part *parts,
	size_t part_count, struct rneagen_error *e)
{
	size_t size = scalar_size(n->scalar), row = n->columns * size, most = BUFFER / row;

	for (size_t done = 0, now; done < count; done += now) {
		off_t place = n->regular ? (off_t)(n->data + (n->at + done) * row) : -1;

		now = count - done < most ? count - done : most;
		if (read_exact(n, n->buffer, now * row, place, "the array", e))
			return e->code;
		if (n->swapped)
			swap_bytes(n->buffer, now * n->columns, size);
		for (const struct npy_part *p = parts; p < parts + part_count; p++)
			for (size_t k = 0; k < now; k++)
				convert(element(p->to, scalar, (done + k) * p->columns), scalar, 1,
					n->buffer + k * row + p->first * size, n->scalar, p->columns);
	}
	return RNEAGEN_OK;
}

/* `count` samples of one column: contiguous in the file, p->columns elements apart in the array. */
static enum rneagen_code read_column(struct npy *n, size_t count, enum rnea_scalar scalar, const struct npy_part *p,
	size_t column, struct rneagen_error *e)
{
	size_t size = scalar_size(n->scalar), most = BUFFER / size;
	uint64_t place = n->data + ((uint64_t)(p->first + column) * n->samples + n->at) * size;

	for (size_t done = 0, now; done < count; done += now) {
		now = count - done < most ? count - done : most;
		if (read_exact(n, n->buffer, now * size, (off_t)(place + done * size), "the array", e))
			return e->code;
		if (n->swapped)
			swap_bytes(n->buffer, now, size);
		convert(element(p->to, scalar, done * p->columns + column), scalar, p->columns, n->buffer, n->scalar,
			now);
	}
	return RNEAGEN_OK;
}

/* Nothing may follow the array in a pipe. */
static enum rneagen_code expect_end(struct npy *n, struct rneagen_error *e)
{
	ssize_t got = n->regular ? 0 : read_all(n->fd, n->buffer, 1, -1);

	if (got < 0)
		return fail_read(n, e);
	if (got)
		return error_set(e, RNEAGEN_READ, "%s: bytes after the array; save one array alone", n->path);
	return RNEAGEN_OK;
}

enum rneagen_code npy_read(struct npy *n, size_t count, enum rnea_scalar scalar, const struct npy_part *parts,
	size_t part_count, struct rneagen_error *e)
{
	if (!n->fortran || n->samples < 2) {
		if (read_rows(n, count, scalar, parts, part_count, e))
			return e->code;
	} else {
		for (const struct npy_part *p = parts; p < parts + part_count; p++)
			for (size_t c = 0; c < p->columns; c++)
				if (read_column(n, count, scalar, p, c, e))
					return e->code;
	}
	n->at += count;
	return n->at == n->samples ? expect_end(n, e) : RNEAGEN_OK;
}
