#ifndef RNEA_FAILURE_H
#define RNEA_FAILURE_H
/* Filling struct rnea_error. */

#include "rnea.h"

#if defined __GNUC__
#define RNEA_PRINTF(f, a) __attribute__((format(printf, f, a)))
#else
#define RNEA_PRINTF(f, a)
#endif

/* Empty `e`, or `spare` where the caller gave none; returns the one to fill. */
struct rnea_error *rnea_error_start(struct rnea_error *e, struct rnea_error *spare);

/* Record a failure and return its code. The first failure is kept. Control characters in the formatted message are
   replaced by spaces, so that it stays one line. */
enum rnea_code rnea_error_set(struct rnea_error *e, enum rnea_code code, const char *fmt, ...) RNEA_PRINTF(3, 4);

/* rnea_error_set(e, RNEA_MEMORY, ...) */
enum rnea_code rnea_error_memory(struct rnea_error *e);

#endif
