#ifndef RNEA_HANDLE_H
#define RNEA_HANDLE_H
/* struct rnea_robot, for the files that make up the public interface. */

#include "cache/cache.h"
#include "core/backend.h"
#include "core/info_table.h"

struct rnea_robot {
	const struct backend *backend; /* NULL: it is not open */
	void *state;                   /* the backend's */
	struct rnea_info info;
	struct rnea_build build;
	struct cache_why unkept;
	char note[sizeof((struct rnea_error *)0)->message]; /* what build points to */
};

#endif
