#ifndef RUNTIME_CERTIFY_CHECK_ROW_H
#define RUNTIME_CERTIFY_CHECK_ROW_H
/* The rows of a certificate, each checked for itself. */

#include "certify/certificate.h"
#include "certify/reader.h"

/* All outputs of c->a, each once, in any order; what was verified goes into `report`. r->e has the first row that is not true. */
enum rneagen_code check_rows(
	const struct certificate *c, const struct reader *r, const json_t *rows, unsigned threads, struct text *report);

#endif
