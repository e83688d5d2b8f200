#ifndef TESTS_FAKE_CACHE_H
#define TESTS_FAKE_CACHE_H
/* Images that the pretended NVRTC built, in the folder FAKE_CACHE. An entry begins with all that the image depends on,
   so that none is taken for another. */

#include <stddef.h>

struct fake_cache {
	char *key; /* private: the command, and the files' contents */
	size_t length;
	char path[512];
};

/* The entry of a command over a text that includes a header; closed by fake_cache_close. */
struct fake_cache fake_cache_open(const char *command, const char *text, const char *header);
void fake_cache_close(struct fake_cache *c);

/* The image, freed by the caller; NULL: there is none. */
char *fake_cache_read(const struct fake_cache *c, size_t *size);
/* What cannot be kept is left out. */
void fake_cache_write(const struct fake_cache *c, const char *image, size_t size);

#endif
