#ifndef RNEA_OBJECT_H
#define RNEA_OBJECT_H
/* A shared object in memory, loaded into this process. */

#include "core/failure.h"
#include <stddef.h>

/* Load `size` bytes; *handle is for dlsym, and for dlclose in the end. Each call loads one more, whatever is loaded
   already. `name` is what debuggers call it. Errors: COMPILER (it does not load), MEMORY. */
enum rnea_code object_load(const char *data, size_t size, const char *name, void **handle, struct rnea_error *e);

#endif
