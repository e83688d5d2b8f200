#ifndef RUNTIME_PROVE_WRITE_CERTIFICATE_H
#define RUNTIME_PROVE_WRITE_CERTIFICATE_H

#include "prove/prove.h"

/* Can there be one? Error: UNSUPPORTED, where the checker knows no range of an input. */
enum rneagen_code write_certificate_check(const struct analysis *a, struct rneagen_error *e);

/* The certificate of a proof whose record was kept (o->record), into the file `path`, within about so many seconds. Errors: as
   rneagen_generate; WRITE. */
enum rneagen_code write_certificate(const char *path, const struct proof *p, const struct analysis *a, const struct prove_options *o,
	double seconds, struct rneagen_error *e);

#endif
