#ifndef RNEA_COMPILER_H
#define RNEA_COMPILER_H
/* The machine's C compiler: which it is, and a text made into a shared object by it. */

#include "core/child.h"
#include "core/failure.h"
#include <stddef.h>

struct compiler {
	char path[1024];     /* as it was found; it is run under this name */
	char identity[8192]; /* of the program and of the processor it compiles for, as part of a key; "": not known */
};

struct compiler_request {
	const char *source;	    /* NUL-terminated */
	const char *file;	    /* what messages call it */
	const char *const *options; /* further options, option_count of them */
	size_t option_count;
	char *log; /* as in struct rnea_options */
	size_t log_size;
	struct child_stop stop;
};

/* PATH, along which compilers are looked for, and look for their assembler and linker; where it is not set, what the
   system has in its place, copied to `standard`: a compiler would look nowhere. */
enum { COMPILER_PATH_SIZE = 256 };
const char *compiler_path(char standard[COMPILER_PATH_SIZE]);

/* Choose RNEA_CC, a path or a name to be found along PATH, or else the first of cc, gcc and clang there. Nothing is
   run. Errors: NO_COMPILER. */
enum rnea_code compiler_find(struct compiler *c, struct rnea_error *e);

/* Compile to a shared object for this processor: *object is malloc, *size bytes. On failure it is NULL. Errors:
   COMPILER, COMPILE, MEMORY. */
enum rnea_code compiler_run(
	const struct compiler *c, const struct compiler_request *r, char **object, size_t *size, struct rnea_error *e);

/* "gcc (Debian 12.2.0-14) 12.2.0 (/usr/bin/gcc)", or the path alone where the compiler does not say. */
void compiler_describe(const struct compiler *c, char *text, size_t size);

#endif
