#ifndef RNEAGEN_DIAGNOSTIC_H
#define RNEAGEN_DIAGNOSTIC_H
/* What all that reads a robot is given to say what is wrong: all messages begin with FILE:LINE:. */

#include "urdf/robot.h"

struct diagnostic {
	const char *file;
	struct robot *robot; /* takes the warnings */
	struct arena *arena;
	struct rneagen_error *error;
};

/* Line 0: none is known. */
enum rneagen_code diagnostic_error(const struct diagnostic *p, enum rneagen_code code, long line, const char *fmt, ...)
	RNEAGEN_PRINTF(4, 5);
void diagnostic_warning(const struct diagnostic *p, long line, const char *fmt, ...) RNEAGEN_PRINTF(3, 4);

#endif
