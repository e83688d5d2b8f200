#ifndef RUNTIME_PROGRESS_H
#define RUNTIME_PROGRESS_H
/* One line on standard error that tells how far a command is; only where that is a terminal. */

#include <stdint.h>

struct progress {
	const char *command, *unit;
	uint64_t total;
	double start, shown; /* private: seconds; start 0: nothing is shown */
};

/* Begin; `quiet`: nothing is shown, terminal or not. */
void progress_start(struct progress *p, const char *command, const char *unit, uint64_t total, int quiet);

/* Show that `done` of the total are done, at most ten times a second. */
void progress_show(struct progress *p, uint64_t done);

/* Clear the line. */
void progress_end(struct progress *p);

/* What is shown, without the ends of the line: "43 %, 4.3e+08 of 1e+09 samples, 1.2e+07/s, 0:47 left". */
void progress_text(const struct progress *p, uint64_t done, double seconds, char *text, unsigned size);

#endif
