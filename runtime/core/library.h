#ifndef RNEA_LIBRARY_H
#define RNEA_LIBRARY_H
/* A shared library that is looked for in several places; every place is remembered for the message. */

#include <stddef.h>

struct library {
	int only_find;	  /* set before the first try: the library is found, and not loaded (library_identity) */
	void *handle;	  /* NULL until one of the tries succeeds, and where it is only to be found */
	char path[512];	  /* the name under which it was found; "" until then */
	char tried[1536]; /* the names that did not serve, "; " between them */
};

/* Each try does nothing once the library is found, and returns 1 when it is found afterwards. */

/* dlopen(name): a path, or a soname for the dynamic linker to look up. Where the library is only to be found, a path is
   found if there is such a file; a soname has to be loaded all the same, for only the linker knows where it looks. */
int library_try(struct library *l, const char *name);

/* Take the library only if the process has already loaded it under `soname`. A miss is not remembered. */
int library_try_loaded(struct library *l, const char *soname);

/* Every file that matches a shell pattern, the one that sorts last, and so the newest version, first. */
int library_try_pattern(struct library *l, const char *pattern);

/* "path size mtime inode" of the file that was found, without symbolic links: another text where it is another file.
   Returns 0 where the file cannot be seen any more or the text does not fit; it is "" then. */
int library_identity(const struct library *l, char *text, size_t size);

/* Store the address of `symbol` in the function pointer at `slot`; returns 0, and stores NULL, if there is none. */
int library_symbol(const struct library *l, const char *symbol, void *slot);

/* Give the handle back. The library itself stays in the process: unloading a CUDA library is not safe. */
void library_close(struct library *l);

#endif
