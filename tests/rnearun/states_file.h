#ifndef TESTS_STATES_FILE_H
#define TESTS_STATES_FILE_H
/* .npy files for tests of commands; nothing is shared with runtime/npy. This machine is little-endian. */

#include <stddef.h>

/* The numbers of a file as rnea_reference writes it: a header of 128 bytes, then float64; `f32`: float32. malloc'ed. */
double *file_numbers(const char *path, int f32, size_t *count);

/* Write [samples][columns] numbers as float64 or float32. */
void file_put_array(const char *path, const double *x, size_t samples, size_t columns, int f32);

/* Of q, qd and qdd one array: [samples][nq + 2 nv]; malloc'ed. */
double *states_join(const double *const parts[3], size_t samples, size_t nq, size_t nv);

/* A file of zeros, [samples][columns] float64, that takes no room on the disk. */
void file_put_sparse(const char *path, size_t samples, size_t columns);

#endif
