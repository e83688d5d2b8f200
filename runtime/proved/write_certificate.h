#ifndef RUNTIME_PROVED_WRITE_CERTIFICATE_H
#define RUNTIME_PROVED_WRITE_CERTIFICATE_H

#include "prove/prove.h"

/* The certificate of a proof whose record was kept (o->record), into the file `path`, within about so many seconds. Errors: as
   rneagen_generate; WRITE. */
enum rneagen_code write_certificate(const char *path, const struct proof *p, const struct analysis *a,
	const struct prove_options *o, double seconds, struct rneagen_error *e);

#endif
