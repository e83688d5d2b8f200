#ifndef RUNTIME_CERTIFY_CHECK_H
#define RUNTIME_CERTIFY_CHECK_H
/* Is a certificate true? It is checked from the URDF on, by no code that found it, and without any search. */

#include "base/text.h"
#include "cli/files.h"

struct check_input {
	const char *file;                /* of the certificate, for messages */
	struct file_content certificate;
	const char *urdf;                /* NULL: the file that the certificate names */
	unsigned threads;                /* 0: one for each processor */
};

/* What was verified, into `report`. Errors: READ, where it is no certificate, is of another version, robot or text, or a bound in
   it does not follow from its steps; as rneagen_generate; MEMORY. */
enum rneagen_code certificate_check(const struct check_input *in, struct text *report, struct rneagen_error *e);

#endif
