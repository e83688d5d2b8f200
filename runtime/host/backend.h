#ifndef RNEA_HOST_BACKEND_H
#define RNEA_HOST_BACKEND_H
/* The record of the host. */

#include "core/backend.h"

extern const struct backend backend_host;

#endif
