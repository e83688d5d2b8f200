#ifndef RNEA_GENERATE_H
#define RNEA_GENERATE_H
/* The generator, with errors as the runtime tells them. */

#include "rnea.h"
#include "rneagen.h"

/* What the generator refused, as an error of the runtime; returns its code. */
enum rnea_code generate_refused(const struct rneagen_error *refused, struct rnea_error *e);

/* As rneagen_generate. */
enum rnea_code generate_text(const char *urdf, size_t length, const struct rneagen_options *g, struct rneagen_result *text,
	struct rnea_error *e);

#endif
